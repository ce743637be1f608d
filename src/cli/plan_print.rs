//! The words of `pipeline plan`.

use crate::columns::{Align, aligned};
use crate::print::line;
use pipeline_findings::{NextKind, NextMeasurement};
use pipeline_plan::design::Plan;
use pipeline_plan::foresee::{Foreseen, Limit, More, Worth};
use pipeline_report::number::Rounding;
use pipeline_report::wording::name;
use pipeline_report::wording::number::{percent, rounded, with_unit};
use pipeline_report::wording::sentence::conditions;

fn newtons(value: f64) -> String {
    format!("{} N", rounded(value, Rounding::Digits(2)))
}

fn size(limit: &Limit) -> String {
    with_unit(&rounded(limit.smallest, Rounding::Digits(2)), &limit.unit)
}

/// What a plan could show, and what would lower its error.
pub(super) fn print(plan: &Plan, foreseen: &Foreseen) {
    print_plan(plan, foreseen);
    print_error(foreseen);
    print_worth(foreseen);
    print_points(foreseen);
    print_limits(foreseen);
    print_aliases(foreseen);
}

/// What was planned, and what was drawn.
fn print_plan(plan: &Plan, foreseen: &Foreseen) {
    let s = &plan.scatter;
    line(format!(
        "plan      {} readings in {} sessions of {} actuators, {} mm",
        plan.readings(),
        plan.rest_lengths_mm.len() * plan.contractions.len(),
        plan.rest_lengths_mm.len(),
        plan.diameter_mm
    ));
    line(format!(
        "scatter   {}specimen gain {}, set lengths {:.2} mm, contracted lengths {}%, zero {}, misfit of the law {} and of a session {}, noise {}",
        plan.scatter_of
            .as_ref()
            .map_or_else(String::new, |c| format!("as in {c}: ")),
        percent(s.gain),
        s.length_mm,
        rounded(100.0 * s.contracted, Rounding::Digits(2)),
        newtons(s.zero_n),
        percent(s.common_misfit),
        percent(s.session_misfit),
        newtons(s.noise_n)
    ));
    let (draws, answered) = foreseen.draws;
    line(format!(
        "draws     {draws}, without any effect; an effect was found in {answered}"
    ));
}

/// The error to expect, and what it is made of.
fn print_error(foreseen: &Foreseen) {
    line("");
    if let Some(error) = foreseen.expected_rmse_n {
        line(format!(
            "error     {} expected on an unseen actuator{}",
            newtons(error),
            foreseen
                .calibrated_rmse_n
                .map_or_else(String::new, |e| format!(
                    ", {} with its gain and lengths known",
                    newtons(e)
                ))
        ));
        let parts = foreseen.budget.iter().take(5);
        let parts: Vec<String> = parts
            .map(|(source, n)| format!("{} {}", name::source(source), newtons(*n)))
            .collect();
        line(format!("sources   {}", parts.join(", ")));
    }
}

/// What one thing more is worth.
fn print_worth(foreseen: &Foreseen) {
    line("");
    line(
        "additions: the error expected with each (median of the draws), and its change (mean over draws with the same seeds)",
    );
    let rows: Vec<Vec<String>> = foreseen.worth.iter().map(worth_row).collect();
    for text in aligned(&rows, &[Align::Left, Align::Right, Align::Left]) {
        line(format!("  {text}"));
    }
}

/// What could be found, and what could not.
fn print_limits(foreseen: &Foreseen) {
    line("");
    line("smallest sizes detected in 80 of 100 such campaigns");
    let rows: Vec<Vec<String>> = foreseen
        .limits
        .iter()
        .map(|l| vec![name::effect(&l.id), l.form.clone(), size(l)])
        .collect();
    for text in aligned(&rows, &[Align::Left, Align::Left, Align::Right]) {
        line(format!("  {text}"));
    }
    if !foreseen.not_measurable.is_empty() {
        line("");
        line("not measurable with this design");
        let of = |n: &pipeline_findings::NotMeasurable| {
            let form = n
                .form
                .as_ref()
                .map_or_else(String::new, |f| format!(", {f}"));
            vec![
                format!("{}{form}", name::effect(&n.id)),
                name::why_not_of_law(n),
            ]
        };
        let rows: Vec<Vec<String>> = foreseen.not_measurable.iter().map(of).collect();
        for text in aligned(&rows, &[Align::Left, Align::Left]) {
            line(format!("  {text}"));
        }
    }
}

/// What this design cannot tell apart.
fn print_aliases(foreseen: &Foreseen) {
    if !foreseen.aliases.is_empty() {
        line("");
        line("indistinguishable with this design");
        for alias in &foreseen.aliases {
            let [a, b] = &alias.ids;
            line(format!(
                "  {} and {} (cosine {:.3})",
                name::effect(a),
                name::effect(b),
                alias.cosine
            ));
        }
    }
}

/// The set points that the search of a draw would read next.
pub(super) fn best_points(foreseen: &Foreseen) -> impl Iterator<Item = &NextMeasurement> {
    let next = foreseen.next.iter();
    next.filter(|n| n.kind == NextKind::SetPoints && !n.at.contains_key("set_points"))
}

fn print_points(foreseen: &Foreseen) {
    let points: Vec<String> = best_points(foreseen)
        .map(|n| format!("  {}", conditions(n)))
        .collect();
    if !points.is_empty() {
        line("");
        line("best further set points");
        points.into_iter().for_each(line);
    }
}

fn worth_row(worth: &Worth) -> Vec<String> {
    let what = match worth.more {
        More::Specimen(mm) => format!("an actuator of {mm} mm"),
        More::LengthsKnown(mm) => format!("set lengths known to {mm} mm"),
        More::ContractedKnown(mm) => format!("contracted lengths known to {mm} mm"),
        More::Contraction(c) => format!("sessions at a relative contraction of {c:.2}"),
        More::Run => "one more log per session".to_owned(),
    };
    vec![
        what,
        newtons(worth.expected_rmse_n),
        format!("{:+.1} ± {:.1} N", -worth.less_n, worth.spread_n),
    ]
}
