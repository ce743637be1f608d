//! `fits`, `statistics`: how well each equation meets its rows. The honest statistics stand beside those that a robust LAR fit prints, under their
//! own name.

use crate::described::*;
use crate::input::GroupInput;
use pipeline_fit::engine::{Compatible, EquationFit, Goodness};

type Fit<'a> = (&'a GroupInput, &'a EquationFit);

/// On the rows that were fitted.
#[rustfmt::skip]
pub fn fits(groups: &[GroupInput]) -> Table {
    Described::<Fit>::new("fits", "Goodness of the fits, on the rows that were fitted (RMSE over \\v{n} − \\v{p})")
        .group(|(g, _)| &g.fit.group)
        .equation(|(_, e)| &e.id)
        .count("n", "\\v{n}", One, |(_, e)| e.n)
        .count("p", "\\v{p}", One, |(_, e)| e.p)
        .number("adj_r2", "Adj. R^2", One, Decimals(4), |(_, e)| finite(e.adjusted_r2))
        .number("rmse", "RMSE", One, Digits(4), |(_, e)| finite(e.rmse))
        .number("max_abs_error", "Max. error", One, Digits(3), |(_, e)| finite(e.max_abs_error))
        .text("unit", "Unit", |(_, e)| &e.unit)
        .text("loss", "Loss", |(_, e)| &e.loss).machines()
        .text("status", "Fit", |(_, e)| &e.status)
        .blocks(groups.iter().map(|g| g.fit.equations.iter().map(move |e| (g, e))))
}

/// The statistics of a fit on some of its rows.
#[derive(Clone, Copy)]
struct On<'a> {
    group: &'a GroupInput,
    equation: &'a EquationFit,
    rows: &'static str,
    honest: Goodness,
    lar: Option<&'a Compatible>,
}

/// On all rows, and on both sides of the split by row.
#[rustfmt::skip]
pub fn statistics(groups: &[GroupInput]) -> Table {
    Described::<On>::new("statistics", "Statistics of the residuals, and as MATLAB prints them for a fit by least absolute residuals (LAR)")
        .group(|r| &r.group.fit.group)
        .equation(|r| &r.equation.id).once()
        .text("split", "Rows", |r| r.rows)
        .count("n", "\\v{n}", One, |r| r.honest.n)
        .number("adj_r2", "Adj. R^2", One, Decimals(4), |r| r.honest.adjusted_r2)
        .number("rmse", "RMSE", One, Digits(4), |r| r.honest.rmse)
        .number("max_abs_error", "Max. error", One, Digits(3), |r| r.honest.max_abs_error)
        .number("lar_adj_r2", "Adj. R^2", One, Decimals(4), |r| r.lar.and_then(|l| l.adjusted_r2))
        .number("lar_rmse", "RMSE", One, Digits(4), |r| r.lar.map(|l| l.rmse))
        .number("lar_max_abs_error", "Max. error", One, Digits(3), |r| r.lar.map(|l| l.max_abs_error))
        .text("unit", "Unit", |r| &r.equation.unit)
        .span("Residuals", "adj_r2", "max_abs_error")
        .span("LAR print", "lar_adj_r2", "lar_max_abs_error")
        .note(
            "\\v{LAR print}, the right-hand set, is for comparison with the papers and is used nowhere else: its RMSE is a mixed scale, at \
             least \\v{s} \\v{p}/√(\\v{p}^2 + \\v{n}) \
             of the ordinary fit's \\v{s}, not a root mean square. Validation rows are the fifth of each session's rows that the split by \
             row kept out of the fit.",
        )
        .blocks(groups.iter().flat_map(|g| g.fit.equations.iter().map(move |e| on_rows(g, e))))
}

fn on_rows<'a>(group: &'a GroupInput, equation: &'a EquationFit) -> Vec<On<'a>> {
    let on = |rows, honest, lar: Option<&'a Compatible>| On {
        group,
        equation,
        rows,
        honest,
        lar,
    };
    let all = Goodness {
        n: equation.n,
        rmse: finite(equation.rmse),
        adjusted_r2: finite(equation.adjusted_r2),
        max_abs_error: finite(equation.max_abs_error),
    };
    let mut found = vec![on("all, fitted", all, equation.compatible.as_ref())];
    if let Some(split) = &equation.by_rows {
        found.push(on("training", split.train, split.compatible.as_ref()));
        found.push(on("validation", split.validation, None));
    }
    found
}
