//! What this joint could have shown: the smallest detectable size of every effect, effects that it cannot show, and pairs with nearly one trace.

use super::problem::TorqueProblem;
use super::terms::{ALL, Term};
use pipeline_effects as effects;
use pipeline_effects::JointNeed;
use pipeline_findings::{Alias, DetectionLimit, NotMeasurable, WhyNot};
use pipeline_inference::decisions::{IDENTIFIABLE, PARALLEL};
use pipeline_inference::fit::{Fitted, Setting};
use pipeline_inference::power::at_known_variances;
use pipeline_inference::problem::Problem;
use pipeline_inference::screen::{Screen, Shown};
use pipeline_inference::statistic::likelihood_ratio;
use pipeline_inference::system::{Factor, Panel};

/// The answers.
pub struct Limits {
    /// One entry a form.
    pub smallest: Vec<DetectionLimit>,
    /// What cannot be shown.
    pub not_measurable: Vec<NotMeasurable>,
    /// Pairs.
    pub aliases: Vec<Alias>,
}

/// The limits beside a model, for a critical value of the family-wise test.
pub fn limits(setting: &Setting, problem: &TorqueProblem, model: &Fitted, critical: f64) -> Limits {
    let mut directions = problem.directions(&model.point);
    directions.retain(|d| problem.library[d.term].form().is_some());
    let screen = Screen::of(setting, model, directions);
    let shown = screen.shown(0);
    let mut smallest: Vec<DetectionLimit> = Vec::new();
    let mut not_measurable = Vec::new();
    for form in &ALL {
        let in_model = |(t, _): &(usize, Vec<f64>)| is(form, problem.library[*t].form());
        if model.point.terms.iter().any(in_model) {
            continue;
        }
        match limit(form, problem, (&screen, &shown), critical) {
            Ok(limit) => smallest.push(limit),
            Err(refused) => not_measurable.push(refused),
        }
    }
    let absorbed = effects::all().iter();
    let absorbed = absorbed.filter_map(|e| Some((e.id(), e.joint_absorbed_by()?)));
    not_measurable.extend(absorbed.map(|(id, by)| NotMeasurable {
        id: id.to_owned(),
        form: None,
        reason: WhyNot::Absorbed,
        by: Some(by.to_owned()),
    }));
    Limits {
        smallest,
        not_measurable,
        aliases: aliases(problem, model, &screen),
    }
}

/// Whether a form is another.
fn is(form: &Term, other: Option<&'static Term>) -> bool {
    other.is_some_and(|o| std::ptr::eq(o, form))
}

/// The smallest detectable size of a form, or why it cannot be shown.
fn limit(
    form: &Term,
    problem: &TorqueProblem,
    (screen, shown): (&Screen, &[Shown]),
    critical: f64,
) -> Result<DetectionLimit, NotMeasurable> {
    if !problem.library.iter().any(|t| is(form, t.form())) {
        let by = form.needs.and_then(JointNeed::column);
        return Err(refused(form, missing(form), by));
    }
    let form_of = |d: usize| problem.library[screen.directions[d].term].form();
    let mine = shown.iter().filter(|s| is(form, form_of(s.direction)));
    // For two amplitudes the length is that of the first.
    // One test has variances of its own that nothing but their priors holds: what these leave of a likelihood ratio has no simple form.
    let size = |s: &Shown| at_known_variances(likelihood_ratio(critical, s.amplitudes), s.length);
    let best = mine.map(|s| (size(s), s.share));
    let best = best
        .filter(|(size, _)| size.is_finite())
        .min_by(|a, b| a.0.total_cmp(&b.0));
    match best {
        None => Err(refused(form, WhyNot::Absorbed, None)),
        Some((size, _)) if size > form.bounds.1 => Err(refused(form, WhyNot::Bound, None)),
        Some((size, share)) => Ok(DetectionLimit {
            id: form.id.to_owned(),
            form: form.form.to_owned(),
            smallest: size,
            unit: form.unit.to_owned(),
            identifiable_share: share,
        }),
    }
}

/// A form that cannot be shown; it is named where its effect has several.
fn refused(form: &Term, reason: WhyNot, by: Option<&str>) -> NotMeasurable {
    let forms = ALL.iter().filter(|f| f.id == form.id).count();
    NotMeasurable {
        id: form.id.to_owned(),
        form: (forms > 1).then(|| form.form.to_owned()),
        reason,
        by: by.map(str::to_owned),
    }
}

/// Why a form means nothing for the joint.
fn missing(form: &Term) -> WhyNot {
    match form.needs {
        Some(JointNeed::OriginBracket | JointNeed::InsertionBracket) => WhyNot::NoColumn,
        _ => WhyNot::NoTrace,
    }
}

/// Pairs of effects, each by its most identifiable form, whose whitened sensitivities are nearly parallel.
fn aliases(problem: &TorqueProblem, model: &Fitted, screen: &Screen) -> Vec<Alias> {
    let mut best: Vec<&'static str> = Vec::new();
    let mut columns: Vec<Vec<f64>> = Vec::new();
    for s in screen.shown(0) {
        let direction = &screen.directions[s.direction];
        let Some(form) = problem.library[direction.term].form() else {
            continue;
        };
        // A form with two sizes has no one sensitivity.
        if form.symbols.len() == 1 && s.share > IDENTIFIABLE && !best.contains(&form.id) {
            best.push(form.id);
            columns.push(direction.columns[0].iter().map(|x| x / s.length).collect());
        }
    }
    let count = best.len();
    let pairs: Vec<(usize, usize)> = (0..count)
        .flat_map(|i| (0..i).map(move |j| (i, j)))
        .collect();
    for &(i, j) in &pairs {
        let sum = columns[i].iter().zip(&columns[j]).map(|(a, b)| a + b);
        let sum = sum.collect();
        columns.push(sum);
    }
    let panel = Panel::new(&model.design, &model.gram, &columns);
    let projected = Factor::new(&model.design.tree, &model.gram, &model.variances).project(&panel);
    let alias = |(k, &(i, j)): (usize, &(usize, usize))| {
        let squares = &projected.squares;
        let product = 0.5 * (squares[count + k] - squares[i] - squares[j]);
        Alias {
            ids: [best[j].to_owned(), best[i].to_owned()],
            cosine: product / (squares[i] * squares[j]).sqrt(),
        }
    };
    let mut aliases: Vec<Alias> = pairs.iter().enumerate().map(alias).collect();
    aliases.retain(|a| a.cosine.abs() >= PARALLEL);
    aliases.sort_by(|a, b| b.cosine.abs().total_cmp(&a.cosine.abs()));
    aliases
}
