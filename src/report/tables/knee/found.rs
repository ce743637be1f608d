//! `knee_found`: the effects that the loop found, with their sizes.

use super::named;
use crate::input::ReportInput;
use crate::number::Rounding;
use crate::table::{Audience, Cell, Column, Table};
use crate::wording::name::{effect_with_form, verdict, verdict_id};
use crate::wording::number::{cells, finite, unit};
use pipeline_findings::{EffectFinding, Parameter};
use pipeline_torque::CampaignTorque;
use pipeline_torque::diagnose::JointDiagnosis;

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
            Column::number("p_familywise", "\\v{p}", ""),
            machines(Column::number("log_likelihood_gain", "Gain", "")),
            machines(Column::number("found_in_folds", "In folds", "%")),
            Column::number("rms_nm", "RMS", "N.m"),
            machines(Column::text("class", "Alias set")),
        ],
    )
    .note(
        "\\v{p}: probability of a candidate as strong as this anywhere. RMS: of what it does to the torques.",
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
    let number =
        |rounding: Rounding, of: fn(&EffectFinding) -> f64| finite(effect.map(of), rounding);
    let gain = effect.and_then(|e| e.log_likelihood_gain);
    let folds = effect.and_then(|e| e.found_in_folds);
    let parameter = effect.and_then(|e| e.parameters.first());
    let words = |of: fn(&Parameter) -> &str| parameter.map_or(Cell::Empty, |p| Cell::text(of(p)));
    let mut row = vec![
        Cell::text(&found.campaign),
        Cell::text(found.part.as_deref().unwrap_or_default()),
        Cell::Integer(i64::from(found.diameter_mm)),
        Cell::text(verdict_id(found.verdict)),
        text(|e| e.id.clone()),
        text(|e| e.form.clone()),
        effect.map_or(Cell::text(verdict(found.verdict)), |e| {
            Cell::text(effect_with_form(&e.id, &e.form))
        }),
    ];
    row.extend(parameter.map_or([Cell::Empty, Cell::Empty], |p| {
        cells(p.value, p.ci_low, p.ci_high)
    }));
    row.extend([
        words(|p| &p.unit),
        words(|p| unit(&p.unit)),
        number(Rounding::Digits(2), stiffness),
        number(Rounding::Digits(2), |e| e.p_familywise),
        finite(gain, Rounding::Decimals(1)),
        finite(folds.map(|share| 100.0 * share), Rounding::Decimals(0)),
        number(Rounding::Decimals(2), |e| e.rms),
        text(|e| e.class.join(" ")),
    ]);
    row
}

/// Of a compliance in um/N its stiffness in N/m; of others none.
fn stiffness(effect: &EffectFinding) -> f64 {
    match effect.parameters.first() {
        Some(p) if p.unit == "um/N" => 1e6 / p.value,
        _ => f64::NAN,
    }
}
