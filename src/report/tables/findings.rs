//! `findings`: what every campaign's model lacks, one row a parameter of an effect, a column without a name, or a campaign without either.

use super::described::{self, Of, interval, number, of_all, optional, text};
use crate::input::ReportInput;
use crate::table::{Cell, Rounding, Table};
use crate::wording::number::{cells, finite};
use pipeline_findings::{ActsOn, CampaignFindings, EffectFinding, Parameter, Unexplained};

/// What stands in the place of an effect where none of the library explains the dependence on a column.
const UNEXPLAINED: &str = "unexplained";

/// What a row says.
enum Found<'a> {
    Effect(&'a EffectFinding, &'a Parameter),
    Unexplained(&'a Unexplained),
    Nothing,
}
use Found::{Effect, Nothing};

type Row<'a> = Of<'a, Found<'a>>;

/// All campaigns.
pub fn table(input: &ReportInput) -> Table {
    let columns = vec![
        described::verdict(),
        text("effect", "Effect", |r: &Row| match r.one {
            Effect(e, _) => Cell::text(&e.id),
            Found::Unexplained(_) => Cell::text(UNEXPLAINED),
            Nothing => Cell::Empty,
        }),
        text("class", "Alias set", |r| {
            effect(r, |e| Cell::text(e.class.join(" ")))
        })
        .for_machines(),
        text("form", "Form", |r| effect(r, |e| Cell::text(&e.form))).for_machines(),
        text("acts_on", "Acts on", |r| {
            effect(r, |e| Cell::text(acts_on(e.acts_on)))
        })
        .for_machines(),
        text("column", "Column", |r: &Row| match r.one {
            Effect(e, _) => optional(e.column.as_deref()),
            Found::Unexplained(u) => Cell::text(&u.column),
            Nothing => Cell::Empty,
        }),
        text("from", "From", |r| {
            effect(r, |e| optional(e.from.as_deref()))
        })
        .for_machines(),
        text("parameter", "Parameter", |r| {
            parameter(r, |p| Cell::text(&p.name))
        }),
        number("value", "Value", "", |r| {
            parameter(r, |p| size(p)[0].clone())
        }),
        interval("ci", "95%", |r| parameter(r, |p| size(p)[1].clone())),
        text("unit", "Unit", |r| parameter(r, |p| Cell::text(&p.unit))),
        number("p_familywise", "\\v{p}", "", |r| {
            both(
                r,
                |e| Some(e.p_familywise),
                |u| Some(u.p_familywise),
                Rounding::Digits(2),
            )
        }),
        number("log_likelihood_gain", "Gain", "", |r| {
            both(
                r,
                |e| e.log_likelihood_gain,
                |u| u.log_likelihood_gain,
                Rounding::Decimals(1),
            )
        }),
        number("p_form", "\\v{p} (form)", "", |r| {
            effect(r, |e| {
                let form = e.free_form.as_ref();
                form.map_or(Cell::Empty, |f| finite(f.p, Rounding::Digits(2)))
            })
        }),
        number("found_in_folds", "In folds", "", |r| {
            effect(r, |e| {
                let share = e.found_in_folds;
                share.map_or(Cell::Empty, |x| finite(x, Rounding::Percent(0)))
            })
        }),
        described::flag("negligible", "Negligible", |r| {
            effect(r, |e| Cell::Flag(e.negligible))
        })
        .for_machines(),
        number("rms", "RMS", "", |r| {
            effect(r, |e| finite(e.rms, Rounding::Digits(3)))
        }),
        number("share_of_variance", "Share", "", |r: &Row| match r.one {
            Found::Unexplained(u) => finite(u.share_of_variance, Rounding::Decimals(3)),
            _ => Cell::Empty,
        })
        .for_machines(),
    ];
    of_all(input, ("findings", "What the model of every campaign lacks"), columns, rows).note(
        "\\v{p}: probability of a candidate as strong as this anywhere. \\v{Gain}: in marginal log-likelihood, variances estimated again. \\v{p} (form): probability of as large a \
         change of the size with the effect's own argument, where one size is enough. \\v{In folds}: share of the \
         held-out searches that find it too. \\v{RMS}: of what it does to the readings, in the unit of the errors. \\v{unexplained}: a dependence on a column for which the library has no effect.",
    )
}

fn rows(found: &CampaignFindings) -> Vec<Found<'_>> {
    let effects = found
        .effects
        .iter()
        .flat_map(|e| e.parameters.iter().map(move |p| Effect(e, p)));
    let all: Vec<Found> = effects
        .chain(found.unexplained.iter().map(Found::Unexplained))
        .collect();
    if all.is_empty() { vec![Nothing] } else { all }
}

fn acts_on(acts_on: ActsOn) -> &'static str {
    match acts_on {
        ActsOn::All => "all",
        ActsOn::Levels => "levels",
        ActsOn::From => "from",
    }
}

fn effect(row: &Row, cell: fn(&EffectFinding) -> Cell) -> Cell {
    match row.one {
        Effect(e, _) => cell(e),
        _ => Cell::Empty,
    }
}

fn parameter(row: &Row, cell: fn(&Parameter) -> Cell) -> Cell {
    match row.one {
        Effect(_, p) => cell(p),
        _ => Cell::Empty,
    }
}

fn both(
    row: &Row,
    e: fn(&EffectFinding) -> Option<f64>,
    u: fn(&Unexplained) -> Option<f64>,
    rounding: Rounding,
) -> Cell {
    match row.one {
        Effect(effect, _) => finite(e(effect), rounding),
        Found::Unexplained(unexplained) => finite(u(unexplained), rounding),
        Nothing => Cell::Empty,
    }
}

fn size(p: &Parameter) -> [Cell; 2] {
    cells(p.value, p.ci_low, p.ci_high)
}
