use pipeline::base::{frame::Frame, random::Stream, row::{self, Row}};
use pipeline::config::FitOptions;
use pipeline::inference::{fit::Setting, problem::Problem, search::{Decision, Search}, heldout::Unseen, profile};
use pipeline::stages::diagnose::{base::Base, data::Data, library, problem::ForceProblem};
use pipeline::simulate::rig_like::{self, *};
use std::time::Instant;
fn name(t: &library::Term, data: &Data) -> String { match t.what { library::What::Column(c) => c.name(data), _ => format!("{}/{}{}", t.id().unwrap(), t.form().unwrap().name, match t.scope { library::Scope::All => String::new(), s => format!("{s:?}") }) } }
fn one(rows: &[&Row], label: &str, verbose: bool) {
    let t0 = Instant::now();
    let d = rows[0].diameter_mm as u32;
    let data = Data::new(rows).with_placebo(1);
    let lengths: std::collections::BTreeSet<u64> = rows.iter().map(|r| r.rest_length_m.to_bits()).collect();
    let base = Base::new(d, true, lengths.len(), &FitOptions::default());
    let lib = library::terms(&data);
    let p = ForceProblem::new(&base, &data, &lib).with_reference();
    let s = Setting::new(&p);
    let null = s.fit_afresh(&p.start());
    let t1 = t0.elapsed();
    let search = Search { setting: &s, decision: Decision { level: 0.05, draws: 99, alike: 2.0, most_terms: 4 } };
    let normal = |k: usize| -> Box<dyn FnMut() -> f64> { let mut st = Stream::new(1, &["draw", &k.to_string()]); Box::new(move || st.normal()) };
    let found = search.run(null, &normal, None);
    let names: Vec<String> = found.accepted.iter().map(|a| format!("{} {:.3?} p {:.3} gain {:.1} [{}]", name(&lib[a.term], &data), found.model.values(a.term).unwrap(), a.p, a.gain, a.in_its_place.iter().map(|(t, l)| format!("{} {l:.1}", name(&lib[*t], &data))).collect::<Vec<_>>().join(", "))).collect();
    println!("{label}: n {} s {} k {} null {:.1} {:?} conv {} | crit {:.2} | {} | {:.2?} {:.2?}", data.len(), data.sessions.len(), data.specimens.len(), found.null.log_likelihood, found.null.restricted(&s).components.iter().map(|x| (x*1e4).round()/1e4).collect::<Vec<_>>(), found.null.converged, found.critical, names.join("; "), t1, t0.elapsed());
    println!("    top {}", found.tested.iter().take(4).map(|(t, s)| format!("{} {:.1} ({:.2})", name(&lib[*t], &data), s.likelihood_ratio, s.deviate())).collect::<Vec<_>>().join(", "));
    if verbose {
        println!("   coef {:?} var {:?} noise {:?}", found.model.point.coefficients, found.model.restricted(&s).components, found.model.variances.noise);
        for a in &found.accepted { println!("   profile {:?}", profile::profile(&s, &found.model, a.term, 0, &normal).map(|p| (p.value, p.low, p.high))); }
        println!("   {:?}", t0.elapsed());
        for &node in &p.specimens {
            let w = s.without(node);
            let null = w.fit_afresh(&p.start());
            let f = Search { setting: &w, decision: search.decision }.run(null, &normal, Some(&found.draws));
            let rms = |e: &[f64]| (e.iter().map(|x| x*x).sum::<f64>()/e.len() as f64).sqrt();
            for (l, m) in [("null", &f.null), ("found", &f.model)] {
                let u = Unseen::new(&w, m); let q = u.predict(node);
                let inside = q.errors.iter().zip(&q.sd).filter(|(e, s)| e.abs() < 1.96 * **s).count() as f64 / q.errors.len() as f64;
                let cal: Vec<f64> = u.errors_calibrated(node).iter().map(|x| x.1).collect();
                println!("   {l}: unseen {:.2} expected {:.2} inside {:.2} ld {:.3} cal {:.2} sources {:?}", rms(&q.errors), rms(&q.sd), inside, q.log_density / q.errors.len() as f64, rms(&cal), q.sources.iter().map(|x| (x*10.0).round()/10.0).collect::<Vec<_>>());
            }
            println!("   {:?} {:?}", f.accepted.iter().map(|a| name(&lib[a.term], &data)).collect::<Vec<_>>(), t0.elapsed());
        }
    }
}
fn main() {
    let args: Vec<String> = std::env::args().collect();
    if args[1] == "sim" {
        let n: u64 = args[2].parse().unwrap();
        for seed in 1..=n {
            let effects = if args.len() > 4 { args[3..].chunks(2).map(|c| Put { id: Box::leak(c[0].split('/').next().unwrap().to_owned().into_boxed_str()), form: Box::leak(c[0].split('/').nth(1).unwrap_or("").to_owned().into_boxed_str()), size: c[1].parse().unwrap(), others: &[], from: 0.0 }).collect() } else { Vec::new() };
            let c = rig_like::campaign(seed, &Settings { effects, ..Settings::default() });
            let rows: Vec<&Row> = c.rows.iter().collect();
            one(&rows, &format!("seed {seed} true {:.3?}", c.truth.drawn.sizes), args.contains(&"-v".to_string()));
        }
        return;
    }
    let bytes = std::fs::read(&args[1]).unwrap();
    let rows: Vec<Row> = { let f = Frame::from_parquet(&bytes).unwrap(); let h = f.height(); let mut f = f; for c in ["rest_length_sd_m", "contracted_length_sd_m", "length_sd_m"] { f = f.with(c, pipeline::base::frame::Values::Number(vec![f64::NAN; h])); } row::from_frame(&f).unwrap() };
    let rows: Vec<&Row> = rows.iter().filter(|r| r.campaign == args[2] && r.force_n.is_finite() && !r.excluded).collect();
    one(&rows, &args[2], true);
}
