//! How often one number is called too little for the size of an effect: where it is enough, and where the form differs.
//!
//! ```sh
//! cargo run --release --example free_forms -- [SEEDS] [MULTIPLE] [WORD]
//! ```
//!
//! Rig-like campaigns with one effect, its size in multiples of the detection limit that the loop states for the campaign without it. The model with
//! the effect in the library's form is fitted as it is (no search), and asked for the free form. A form that differs is as strong, to the
//! generating model, as the plain one. A line a case: how many were called different, and of how many.

use pipeline::base::random::Stream;
use pipeline::base::row::Row;
use pipeline::config::FitOptions;
use pipeline::inference::fit::{Fitted, Setting};
use pipeline::inference::statistic::deviate;
use pipeline::simulate::rig_like::{Campaign, Generating, Pace, Put, Settings, campaign};
use pipeline::stages::diagnose::base::Base;
use pipeline::stages::diagnose::data::Data;
use pipeline::stages::diagnose::library::{self, Scope, Term};
use pipeline::stages::diagnose::problem::ForceProblem;
use pipeline::stages::diagnose::{form, limits};
use std::time::Instant;

/// Effect, form of the library and of the simulator, largest amplitude, how it is measured, from which part of the campaign on.
struct Case {
    id: &'static str,
    plain: &'static str,
    other: &'static str,
    most: f64,
    pace: Pace,
    from: f64,
}

const fn case(id: &'static str, plain: &'static str, other: &'static str, most: f64) -> Case {
    Case {
        id,
        plain,
        other,
        most,
        pace: Pace::Staircase,
        from: 0.0,
    }
}

const CASES: [Case; 6] = [
    case("series_compliance", "linear", "stiffening", 160.0),
    case("bladder_threshold", "sharp", "smooth", 150.0),
    case("length_offset", "constant", "growing", 8.0),
    case("pressure_zero_offset", "constant", "gained", 45.0),
    case("temperature", "linear", "quadratic", 0.08),
    Case {
        pace: Pace::Dwell,
        ..case("creep", "logarithmic", "stretched", 0.3)
    },
];

const GENERATING_LIMIT: f64 = 3.7 + 0.84;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |k: usize, or: f64| {
        let given = arguments.get(k).and_then(|a| a.parse().ok());
        given.unwrap_or(or)
    };
    let (seeds, multiple) = (number(0, 20.0) as u64, number(1, 4.0));
    let word = arguments.get(2).map_or("", |w| w.as_str());
    for case in CASES.iter().filter(|c| c.id.contains(word)) {
        for is_other in [false, true] {
            let mut ps = Vec::new();
            let mut seconds = 0.0;
            for seed in 0..seeds {
                let (p, took) = tried(case, is_other, multiple, 5_000 + seed);
                ps.extend(p);
                seconds += took;
            }
            let different = ps.iter().filter(|p| **p < 0.05).count();
            let form = if is_other { case.other } else { "plain" };
            let listed: Vec<String> = ps.iter().map(|p| format!("{p:.3}")).collect();
            println!(
                "{} {form} x{multiple}: {different} of {} different, {:.2} s each; p {}",
                case.id,
                ps.len(),
                seconds / seeds as f64,
                listed.join(" ")
            );
        }
    }
}

/// The probability of a constant size, and the time that it took.
fn tried(case: &Case, is_other: bool, multiple: f64, seed: u64) -> (Option<f64>, f64) {
    let settings = |effects| Settings {
        pace: case.pace,
        effects,
        ..Settings::default()
    };
    let put = |size: f64, other: bool| Put {
        id: case.id,
        form: if other { case.other } else { "" },
        size,
        others: &[],
        from: case.from,
    };
    let plain = campaign(seed, &settings(Vec::new()));
    let limit = stated(&plain.rows, case).unwrap_or_else(|| {
        let wanted = GENERATING_LIMIT;
        of_strength(&plain, |size| put(size, false), case.most, wanted)
    });
    let mut size = (multiple * limit).min(case.most);
    if is_other {
        let strength = Generating::new(&plain).strength(&[put(size, false)]);
        size = of_strength(&plain, |size| put(size, true), case.most, strength);
    }
    let made = campaign(seed, &settings(vec![put(size, is_other)]));
    let mut answer = (None, 0.0);
    fitted(&made.rows, Some(case), |problem, setting, model| {
        let normal = |k: usize| -> Box<dyn FnMut() -> f64> {
            let mut stream = Stream::new(seed, &["form", &k.to_string()]);
            Box::new(move || stream.normal())
        };
        let start = Instant::now();
        let forms = form::free_forms(setting, problem, model, 199, &normal);
        answer.1 = start.elapsed().as_secs_f64();
        if let Some(f) = forms.values().next() {
            let ends = [0, 10, 20].map(|k| &f.curve[k]);
            let ends = ends.map(|c| format!("{:.3} [{:.3}, {:.3}]", c.amplitude, c.low, c.high));
            eprintln!(
                "{} {} {seed}: size {size:.3}, fitted {:.3}, gain {:.2}, p {:.3}: {}",
                case.id,
                if is_other { case.other } else { "plain" },
                model.point.terms[0].1[0],
                f.log_likelihood_gain,
                f.p,
                ends.join(" ")
            );
            answer.0 = Some(f.p);
        }
    });
    answer
}

/// The loop's own detection limit.
fn stated(rows: &[Row], case: &Case) -> Option<f64> {
    let mut found = None;
    fitted(rows, None, |problem, setting, model| {
        let limits = limits::limits(setting, problem, model, deviate(3.4 * 3.4, 1));
        let mut own = limits.smallest.into_iter();
        found = own.find(|l| l.id == case.id && l.form == case.plain);
    });
    found.map(|l| l.smallest)
}

/// The amplitude of a strength.
fn of_strength(plain: &Campaign, put: impl Fn(f64) -> Put, most: f64, wanted: f64) -> f64 {
    let (mut low, mut high) = (1e-4 * most, 2.0 * most);
    for _ in 0..12 {
        let middle = (low * high).sqrt();
        if Generating::new(plain).strength(&[put(middle)]) < wanted {
            low = middle;
        } else {
            high = middle;
        }
    }
    (low * high).sqrt()
}

/// The model with the effect in the library's form, or without one.
fn fitted(rows: &[Row], case: Option<&Case>, ask: impl FnOnce(&ForceProblem, &Setting, &Fitted)) {
    let rows: Vec<&Row> = rows.iter().collect();
    let base = Base::new(10, true, 4, &FitOptions::default());
    let data = Data::new(&rows);
    let library = library::terms(&data);
    let problem = ForceProblem::new(&base, &data, &library).with_reference();
    let setting = Setting::new(&problem);
    let null = setting.fit_afresh(&setting.problem.start());
    let Some(case) = case else {
        return ask(&problem, &setting, &null);
    };
    let is_it = |t: &Term| {
        let form = t.form().is_some_and(|f| f.name == case.plain);
        t.scope == Scope::All && t.id() == Some(case.id) && form
    };
    let terms = library.iter().enumerate().filter(|(_, t)| is_it(t));
    let fits = terms.flat_map(|(k, term)| {
        let bound = term.form().map_or(1.0, |f| f.amplitude.bounds.1);
        let setting = &setting;
        let null = &null;
        [0.05, 0.3, 0.7, -0.05].map(|share| {
            let mut from = null.point.clone();
            from.terms.push((k, term.start(share * bound)));
            setting.fit_afresh(&from)
        })
    });
    let best = fits.max_by(|a, b| a.log_likelihood.total_cmp(&b.log_likelihood));
    ask(
        &problem,
        &setting,
        &best.expect("the library has the effect"),
    );
}
