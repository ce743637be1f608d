//! `findings`: what every campaign's base model lacks, one row a parameter of an effect.

use crate::report::answers::{finite, verdict};
use crate::report::input::ReportInput;
use crate::report::table::{Audience, Cell, Column, Rounding, Table};
use crate::stages::diagnose::findings::{
    CampaignFindings, EffectFinding, ParameterFinding, Unexplained,
};

/// What stands in the place of an effect where none of the library explains the dependence on a column.
const UNEXPLAINED: &str = "unexplained";

/// All campaigns.
pub fn table(input: &ReportInput) -> Table {
    let mut table = Table::new(
        "findings",
        "What the base model lacks, campaign by campaign",
        columns(),
    )
    .note(
        "Held-out errors are without and with this effect, the other effects kept and the strength of the held-out specimen taken off. \
         \\v{unexplained}: a dependence on a column that no effect of the library explains.",
    );
    for found in input.findings() {
        table.rule();
        for effect in &found.effects {
            for parameter in &effect.parameters {
                table.push(row(found, Some(effect), Some(parameter), None));
            }
        }
        for unexplained in &found.unexplained {
            table.push(row(found, None, None, Some(unexplained)));
        }
        if found.effects.is_empty() && found.unexplained.is_empty() {
            table.push(row(found, None, None, None));
        }
    }
    table
}

fn columns() -> Vec<Column> {
    let machines = |column: Column| column.seen_by(Audience::Machines);
    vec![
        Column::text("campaign", "Campaign"),
        Column::number("diameter_mm", "⌀", "mm"),
        machines(Column::text("verdict", "Verdict")),
        Column::text("effect", "Effect"),
        machines(Column::text("class", "Class")),
        machines(Column::text("scope", "Scope")),
        Column::text("acts_on", "Acts on"),
        Column::text("parameter", "Parameter"),
        Column::number("value", "Value", ""),
        Column::interval("ci", "95%", ""),
        Column::text("unit", "Unit"),
        Column::number("p_adjusted", "\\v{p}", ""),
        machines(Column::number("selected_in_folds", "Chosen in folds", "")),
        machines(Column::number("helps_in_folds", "Helps", "")),
        Column::number("rmse_heldout_before", "Without", "N"),
        Column::number("rmse_heldout_after", "With", "N"),
    ]
}

fn row(
    found: &CampaignFindings,
    effect: Option<&EffectFinding>,
    parameter: Option<&ParameterFinding>,
    unexplained: Option<&Unexplained>,
) -> Vec<Cell> {
    let text = |x: Option<&str>| x.map_or(Cell::Empty, Cell::text);
    let number = |x: Option<f64>, rounding| finite(x.unwrap_or(f64::NAN), rounding);
    let [value, interval] = parameter.map_or([Cell::Empty, Cell::Empty], size);
    let effect_or = |e: fn(&EffectFinding) -> f64, u: fn(&Unexplained) -> Option<f64>| {
        effect.map(e).or_else(|| unexplained.and_then(u))
    };
    let name = unexplained.map(|_| UNEXPLAINED);
    vec![
        Cell::text(&found.campaign),
        Cell::Integer(i64::from(found.diameter_mm)),
        Cell::text(verdict(found.verdict)),
        text(effect.map(|e| e.id.as_str()).or(name)),
        effect.map_or(Cell::Empty, |e| Cell::text(e.class.join(" "))),
        text(effect.map(|e| e.scope.as_str())),
        text(
            effect
                .map(|e| e.acts_on.as_str())
                .or(unexplained.map(|u| u.column.as_str())),
        ),
        text(parameter.map(|p| p.name.as_str())),
        value,
        interval,
        text(parameter.map(|p| p.unit.as_str())),
        number(
            effect_or(|e| e.p_adjusted, |u| Some(u.p_adjusted)),
            Rounding::Digits(2),
        ),
        number(effect.map(|e| e.selected_in_folds), Rounding::Percent(0)),
        number(effect.map(|e| e.helps_in_folds), Rounding::Percent(0)),
        number(
            effect_or(|e| e.rmse_heldout_before, |u| u.rmse_heldout_before),
            Rounding::Decimals(2),
        ),
        number(
            effect_or(|e| e.rmse_heldout_after, |u| u.rmse_heldout_after),
            Rounding::Decimals(2),
        ),
    ]
}

/// A value with its interval; without, where there is none.
fn size(p: &ParameterFinding) -> [Cell; 2] {
    if p.ci_low.is_finite() && p.ci_high.is_finite() && p.value.is_finite() {
        Cell::with_interval(p.value, p.ci_low, p.ci_high)
    } else {
        [finite(p.value, Rounding::Digits(3)), Cell::Empty]
    }
}
