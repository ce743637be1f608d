//! `residual_errors`: the errors of every campaign and of every unit that was held out, before and after, in every form.

use super::described::{Described, Of, number, of_all, text, unit};
use crate::input::ReportInput;
use crate::table::{Cell, Rounding, Table};
use crate::wording::number::{error_rounding, finite};
use pipeline_findings::{CampaignFindings, Errors, UnitErrors};

/// What stands for all units together.
const ALL: &str = "all";

/// The errors of a model on a unit, or on all.
struct Line<'a> {
    unit: Option<&'a UnitErrors>,
    model: &'static str,
    errors: &'a Errors,
    /// Whether the model is that with the effects.
    after: bool,
}

type Row<'a> = Of<'a, Line<'a>>;

/// All campaigns.
pub fn table(input: &ReportInput) -> Table {
    let columns: Vec<Described<Row>> = vec![
        text("held_out", "Held out", |r: &Row| {
            Cell::text(r.one.unit.map_or(ALL, |u| u.unit.as_str()))
        }),
        number("readings", "Readings", "", |r| {
            Cell::Integer(r.one.unit.map_or(r.found.design.readings, |u| u.readings) as i64)
        }),
        text("model", "Model", |r| Cell::text(r.one.model)),
        number("rmse_train", "Training", "", |r| error(r, |e| e.rmse_train)),
        number("rmse_heldout", "Unseen", "", |r| {
            error(r, |e| e.rmse_heldout)
        }),
        number("rmse_heldout_calibrated", "Own values", "", |r| {
            error(r, |e| e.rmse_heldout_calibrated)
        }),
        number("rmse_heldout_after_1", "1", "", |r| {
            error(r, |e| given(e, "1"))
        }),
        number("rmse_heldout_after_2", "2", "", |r| {
            error(r, |e| given(e, "2"))
        }),
        number("rmse_heldout_after_3", "3", "", |r| {
            error(r, |e| given(e, "3"))
        }),
        number("rmse_heldout_after_5", "5", "", |r| {
            error(r, |e| given(e, "5"))
        }),
        number("max_abs_error_heldout", "Largest", "", |r| {
            error(r, |e| e.max_abs_error_heldout)
        }),
        unit(),
        number("log_density_heldout", "Log density", "", |r| {
            finite(r.one.errors.log_density_heldout, Rounding::Decimals(3))
        }),
        number("realised_over_expected", "Realised", "", |r| {
            finite(
                of_unit(r, |u| u.realised_over_expected),
                Rounding::Decimals(2),
            )
        }),
        number("inside_95", "Inside 95%", "", |r| {
            finite(inside(r), Rounding::Percent(0))
        }),
        text("found", "Found without it", |r| {
            let found = r.one.unit.filter(|_| r.one.after);
            found.map_or(Cell::Empty, |u| Cell::text(u.found.join(" ")))
        }),
    ];
    let caption =
        "The error on what was held out, without effects and with those that were found without it";
    of_all(input, ("residual_errors", caption), columns, rows)
        .span("After so many readings", "rmse_heldout_after_1", "rmse_heldout_after_5")
        .note(
            "Root-mean-square errors. \\v{Own values}: gain, lengths and zeros of the held-out unit that fit all its readings best, in sample in these. \\v{After so many readings} of each session \
             (test), scored on the others. \\v{Realised}: mean squared error over the expected one.",
        )
}

fn rows(found: &CampaignFindings) -> Vec<Line<'_>> {
    let both = |unit, before, after| {
        [("before", before, false), ("after", after, true)].map(|(model, errors, after)| Line {
            unit,
            model,
            errors,
            after,
        })
    };
    let all = both(None, &found.before, &found.after);
    let units = found
        .by_unit
        .iter()
        .flat_map(|u| both(Some(u), &u.before, &u.after));
    all.into_iter().chain(units).collect()
}

fn given(errors: &Errors, readings: &str) -> Option<f64> {
    errors.rmse_heldout_after.get(readings).copied()
}

fn error(row: &Row, of: fn(&Errors) -> Option<f64>) -> Cell {
    let value = of(row.one.errors).unwrap_or(f64::NAN);
    finite(value, error_rounding(value, &row.found.unit))
}

fn of_unit(row: &Row, of: fn(&UnitErrors) -> Option<f64>) -> Option<f64> {
    row.one.unit.filter(|_| row.one.after).and_then(of)
}

fn inside(row: &Row) -> Option<f64> {
    match row.one.unit {
        None => row.found.inside_95.filter(|_| row.one.after),
        Some(_) => of_unit(row, |u| u.inside_95),
    }
}
