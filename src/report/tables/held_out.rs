//! `residual_errors`, `alternatives`: the errors of every campaign and of every unit that was held out, before and after, in every form; the law
//! with and without its parts.

use super::findings::size;
use crate::described::*;
use crate::input::ReportInput;
use pipeline_findings::{Alternative, CampaignFindings, Errors, Parameter, UnitErrors};

/// The errors of a model on a unit, or on all.
#[derive(Clone, Copy)]
struct Line<'a> {
    unit: Option<&'a UnitErrors>,
    model: &'static str,
    errors: &'a Errors,
    /// The unit of a line of the model with the effects.
    after: Option<&'a UnitErrors>,
    /// Share of readings inside their interval, with the effects.
    inside_95: Option<f64>,
}

/// One row a model and held-out unit.
#[rustfmt::skip]
pub fn residual_errors(input: &ReportInput) -> Table {
    let caption = "Held-out error, without effects and with those found without the unit";
    let given = |l: Line, readings| l.errors.rmse_heldout_spread.get::<str>(readings).copied();
    let first = |l: Line, readings| l.errors.rmse_heldout_after.get::<str>(readings).copied();
    Described::<(&CampaignFindings, Line)>::found("residual_errors", caption)
        .text("held_out", "Held out", |(_, l)| l.unit.map_or("all", |u| u.unit.as_str()))
        .count("readings", "Readings", One, |(found, l)| l.unit.map_or(found.design.readings, |u| u.readings))
        .text("model", "Model", |(_, l)| l.model)
        .error("rmse_train", "Training", |(_, l)| l.errors.rmse_train)
        .error("rmse_heldout", "Unseen", |(_, l)| l.errors.rmse_heldout)
        .error("rmse_heldout_calibrated", "Own values", |(_, l)| l.errors.rmse_heldout_calibrated)
        .error("rmse_heldout_spread_1", "1", move |(_, l)| given(l, "1"))
        .error("rmse_heldout_spread_2", "2", move |(_, l)| given(l, "2"))
        .error("rmse_heldout_spread_3", "3", move |(_, l)| given(l, "3"))
        .error("rmse_heldout_spread_5", "5", move |(_, l)| given(l, "5"))
        .error("rmse_heldout_after_1", "1", move |(_, l)| first(l, "1"))
        .error("rmse_heldout_after_2", "2", move |(_, l)| first(l, "2"))
        .error("rmse_heldout_after_3", "3", move |(_, l)| first(l, "3"))
        .error("rmse_heldout_after_5", "5", move |(_, l)| first(l, "5"))
        .error("max_abs_error_heldout", "Largest", |(_, l)| l.errors.max_abs_error_heldout)
        .text("unit", "Unit", |(found, _)| &found.unit)
        .number("log_density_heldout", "Log density", One, Decimals(3), |(_, l)| finite(l.errors.log_density_heldout))
        .number("realised_over_expected", "Realised", One, Decimals(2), |(_, l)| finite(l.after.and_then(|u| u.realised_over_expected)))
        .number("inside_95", "Inside 95%", One, Percent(0), |(_, l)| finite(l.inside_95))
        .text("found", "Found without it", |(_, l)| l.after.map(|u| u.found.join(" ")))
        .span("Readings used, spread", "rmse_heldout_spread_1", "rmse_heldout_spread_5")
        .span("First readings used", "rmse_heldout_after_1", "rmse_heldout_after_5")
        .note(
            "Root-mean-square errors. \\v{Own values}: gain, lengths and zeros of the held-out unit as estimated from all its readings, \
             so in-sample. \\v{Readings used} from each session \
             (test), scored on the others (units with fewer have none): spread from the largest expected force (torque) down, or the first in time. \\v{Realised}: mean squared error divided by the expected one.",
        )
        .of_all(input, lines)
}

fn lines(found: &CampaignFindings) -> Vec<Line<'_>> {
    let before = |unit, errors| Line {
        unit,
        model: "before",
        errors,
        after: None,
        inside_95: None,
    };
    let after = |unit, errors, inside_95| Line {
        model: "after",
        after: unit,
        inside_95,
        ..before(unit, errors)
    };
    let all = [
        before(None, &found.before),
        after(None, &found.after, found.inside_95),
    ];
    let units = found.by_unit.iter();
    let units = units.flat_map(|u| {
        [
            before(Some(u), &u.before),
            after(Some(u), &u.after, u.inside_95),
        ]
    });
    all.into_iter().chain(units).collect()
}

type Part<'a> = (&'a Alternative, Option<&'a Parameter>);

/// One row a number of an alternative.
#[rustfmt::skip]
pub fn alternatives(input: &ReportInput) -> Table {
    Described::<(&CampaignFindings, Part)>::found("alternatives", "The law with and without its parts")
        .text("parts", "With", |(_, (a, _))| if a.parts.is_empty() { "none".to_owned() } else { a.parts.join(" ") })
        .count("parameters", "Parameters", One, |(_, (a, _))| a.parameters)
        .number("log_likelihood", "Log-likelihood", One, Decimals(1), |(_, (a, _))| finite(a.log_likelihood))
        .error("rmse_heldout", "Held out", |(_, (a, _))| a.rmse_heldout)
        .text("unit", "Unit", |(found, _)| &found.unit)
        .number("log_density_heldout", "Log density", One, Decimals(3), |(_, (a, _))| finite(a.log_density_heldout))
        .text("number", "Number", |(_, (_, p))| p.map(|p| &p.name))
        .value("value", "Value", One, |(_, (_, p))| size(p))
        .interval("ci", "95%", One, |(_, (_, p))| size(p))
        .text("number_unit", "Unit", |(_, (_, p))| p.map(|p| &p.unit))
        .note("\\v{Log-likelihood}: relative to the first, what is published of the length law left out. \\v{Held out}: each alternative \
             as it is, without a search. \\v{Log density}: per held-out reading.")
        .of_all(input, |found| found.alternatives.iter().flat_map(numbers).collect())
}

fn numbers(alternative: &Alternative) -> Vec<Part<'_>> {
    if alternative.numbers.is_empty() {
        return vec![(alternative, None)];
    }
    let numbers = alternative.numbers.iter();
    numbers.map(|p| (alternative, Some(p))).collect()
}
