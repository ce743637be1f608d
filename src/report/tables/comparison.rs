//! `model_comparison`, `comparison_by_length`: every model on the readings that it answers, on those that the ranked models have in common, and on
//! each specimen.

use crate::described::*;
use crate::input::GroupInput;
use crate::wording::name::{model_name, split};
use pipeline_compare::{COMMON, Comparison, GroupComparison, SpecimenComparison};

type Row<'a> = (&'a GroupComparison, &'a Comparison);

/// One row a model and split.
pub fn models(groups: &[GroupInput]) -> Table {
    models_where(groups, |_| true)
}

/// The same for people: a published model has seen none of the rows, so that one split says all of it, beside the readings on which all are ranked.
pub fn models_in_print(groups: &[GroupInput]) -> Table {
    models_where(groups, |c| {
        c.split == COMMON || c.fitted_here != (c.split == "all")
    })
}

#[rustfmt::skip]
fn models_where(groups: &[GroupInput], shown: fn(&Comparison) -> bool) -> Table {
    Described::<Row>::new("model_comparison", "Every model on the readings that it covers, and on common ones")
        .group(|(g, _)| &g.group)
        .text("model", "Model", |(_, c)| &c.model).machines()
        .text("title", "Model", |(_, c)| model_name(&c.model, &c.title)).people().once()
        .flag("fitted_here", "Fitted", |(_, c)| c.fitted_here).machines()
        .text("split", "Split", |(_, c)| &c.split).machines()
        .text("readings", "Readings", |(_, c)| split(&c.split)).people()
        .count("n", "\\v{n}", One, |(_, c)| c.n)
        .number("adj_r2", "Adj. R^2", One, Decimals(4), |(_, c)| c.adj_r2)
        .number("rmse", "RMSE", N, Decimals(2), |(_, c)| c.rmse)
        .number("max_abs_error", "Max. error", N, Decimals(1), |(_, c)| c.max_abs_error)
        .number("max_abs_error_pct", "Max. error", PercentOfMaximum, Decimals(1), |(_, c)| c.max_abs_error_pct)
        .number("bias", "Bias", N, Decimals(2), |(_, c)| c.bias)
        .text("unit", "Unit", |_| "N").machines()
        .count("n_excluded", "Outside", One, |(_, c)| c.n_excluded)
        .count("n_extrapolated", "Extrap.", One, |(_, c)| c.n_extrapolated)
        .note(
            "Only errors on common readings rank the models: those that the new model (fitted without their specimen), Hunt 2017 and the Festo \
             tool all cover, as far as they have coefficients for the diameter. Errors and bias are measured minus predicted. \\v{Outside}: readings outside the model's domain, not counted in its \
             errors; \
             \\v{Extrap.}: readings beyond the model's own data, counted. Directions of filling and venting enter Hunt's model as \\v{S} = 0, the mean of both.",
        )
        .blocks(groups.iter().flat_map(|g| by_model(&g.comparison, shown)))
}

fn by_model(g: &GroupComparison, shown: fn(&Comparison) -> bool) -> Vec<Vec<Row<'_>>> {
    let all = g.comparisons.iter().filter(|c| shown(c)).map(|c| (g, c));
    runs(all, |a, b| a.1.model == b.1.model)
}

type OfSpecimen<'a> = (&'a GroupComparison, &'a SpecimenComparison);

/// One row a model and specimen, by resting length.
#[rustfmt::skip]
pub fn by_length(groups: &[GroupInput]) -> Table {
    Described::<OfSpecimen>::new("comparison_by_length", "Every model on each specimen")
        .group(|(g, _)| &g.group)
        .text("model", "Model", |(_, s)| &s.comparison.model).machines()
        .text("title", "Model", |(_, s)| model_name(&s.comparison.model, &s.comparison.title)).people().once()
        .text("split", "Split", |(_, s)| &s.comparison.split).machines()
        .text("specimen", "Specimen", |(_, s)| &s.specimen)
        .number("rest_length_mm", "l_{rest}", Mm, Decimals(0), |(_, s)| 1e3 * s.rest_length_m)
        .count("n", "\\v{n}", One, |(_, s)| s.comparison.n)
        .number("rmse", "RMSE", N, Decimals(1), |(_, s)| s.comparison.rmse)
        .number("max_abs_error", "Max. error", N, Decimals(1), |(_, s)| s.comparison.max_abs_error)
        .number("max_abs_error_pct", "Max. error", PercentOfMaximum, Decimals(1), |(_, s)| s.comparison.max_abs_error_pct)
        .number("bias", "Bias", N, Decimals(1), |(_, s)| s.comparison.bias)
        .count("n_excluded", "Outside", One, |(_, s)| s.comparison.n_excluded)
        .count("n_extrapolated", "Extrap.", One, |(_, s)| s.comparison.n_extrapolated)
        .note("The model that was fitted here predicts each specimen from the others, where there are others.")
        .blocks(groups.iter().flat_map(|g| specimens_by_model(&g.comparison)))
}

fn specimens_by_model(g: &GroupComparison) -> Vec<Vec<OfSpecimen<'_>>> {
    let all = g.by_specimen.iter().map(|s| (g, s));
    runs(all, |a, b| a.1.comparison.model == b.1.comparison.model)
}
