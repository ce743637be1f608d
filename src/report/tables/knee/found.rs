//! `knee_found`: the effects that the loop found, with their sizes.

use super::named;
use crate::report::answers::{self, verdict, verdict_words};
use crate::report::input::ReportInput;
use crate::report::number::Rounding;
use crate::report::table::{Audience, Cell, Column, Table};
use crate::stages::diagnose::findings::{EffectFinding, ParameterFinding};
use crate::stages::torque::CampaignTorque;
use crate::stages::torque::diagnose::JointDiagnosis;

/// All campaigns.
pub fn table(input: &ReportInput) -> Table {
    build(input.torque())
}

/// One campaign.
pub fn of_campaign(campaign: &CampaignTorque) -> Table {
    named(build([campaign]), campaign)
}

fn build<'a>(campaigns: impl IntoIterator<Item = &'a CampaignTorque>) -> Table {
    let machines = |c: Column| c.seen_by(Audience::Machines);
    let mut table = Table::new(
        "knee_found",
        "What the loop found of every joint",
        vec![
            machines(Column::text("campaign", "Campaign")),
            Column::text("joint", "Joint"),
            Column::number("diameter_mm", "⌀", "mm"),
            machines(Column::text("verdict", "Verdict")),
            machines(Column::text("effect", "Effect")),
            machines(Column::text("form", "Form")),
            Column::text("found", "Found").seen_by(Audience::People),
            Column::number("size", "Size", ""),
            Column::interval("interval", "95% interval", ""),
            machines(Column::text("unit", "Unit")),
            Column::text("unit_words", "Unit").seen_by(Audience::People),
            Column::number("stiffness_n_m", "1/\\v{C}", "N/m"),
            Column::number("p_adjusted", "\\v{p}", ""),
            Column::number("chosen_again", "Again", "%"),
            Column::number("rmse_held_out_without_nm", "Without", "N.m"),
            Column::number("rmse_held_out_with_nm", "With", "N.m"),
            machines(Column::text("class", "Class")),
        ],
    )
    .span("Held out, set kept", "rmse_held_out_without_nm", "rmse_held_out_with_nm")
    .note(
        "Held out, set kept: RMSE on what took no part (actuators, or tests or stretches of the angle where there is one), sizes fitted without it, without the effect and with it; \
         everywhere else the search itself is made without what is held out. \
         Again: searches without one test (or stretch) that choose the effect or one that leaves its trace.",
    );
    for campaign in campaigns {
        for joint in &campaign.diagnoses {
            table.rule();
            let effects = &joint.findings.effects;
            if effects.is_empty() {
                table.push(row(joint, None));
            }
            for effect in effects {
                table.push(row(joint, Some(effect)));
            }
        }
    }
    table
}

fn row(joint: &JointDiagnosis, effect: Option<&EffectFinding>) -> Vec<Cell> {
    let found = &joint.findings;
    let text = |of: fn(&EffectFinding) -> String| effect.map_or(Cell::Empty, |e| Cell::text(of(e)));
    let number = |rounding: Rounding, of: fn(&EffectFinding) -> f64| {
        let value = effect.map(of).filter(|x| x.is_finite());
        Cell::number(value, rounding)
    };
    let mut row = vec![
        Cell::text(&found.campaign),
        Cell::text(found.part.as_deref().unwrap_or_default()),
        Cell::Integer(i64::from(found.diameter_mm)),
        Cell::text(verdict(found.verdict)),
        text(|e| e.id.clone()),
        text(|e| e.form.clone()),
        effect.map_or(Cell::text(verdict_words(found.verdict)), |e| {
            Cell::text(&e.title)
        }),
    ];
    let parameter = effect.and_then(|e| e.parameters.first());
    row.extend(parameter.map_or([Cell::Empty, Cell::Empty], size));
    row.extend([
        text(|e| e.parameters[0].unit.clone()),
        text(|e| answers::unit_words(&e.parameters[0].unit)),
        number(Rounding::Digits(2), stiffness),
        number(Rounding::Digits(2), |e| e.p_adjusted),
        number(Rounding::Decimals(0), |e| 100.0 * e.selected_in_resamples),
        number(Rounding::Decimals(2), |e| e.rmse_heldout_before),
        number(Rounding::Decimals(2), |e| e.rmse_heldout_after),
        text(|e| e.class.join(" ")),
    ]);
    row
}

fn size(p: &ParameterFinding) -> [Cell; 2] {
    Cell::with_interval(p.value, p.ci_low, p.ci_high)
}

/// Of a compliance in um/N its stiffness in N/m; of others none.
fn stiffness(effect: &EffectFinding) -> f64 {
    match effect.parameters.first() {
        Some(p) if p.unit == "um/N" => 1e6 / p.value,
        _ => f64::NAN,
    }
}
