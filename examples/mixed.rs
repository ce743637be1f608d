use pipeline::base::{frame::Frame, row::{self, Row}};
use pipeline::config::FitOptions;
use pipeline::inference::fit::Setting;
use pipeline::inference::problem::Problem;
use pipeline::stages::diagnose::{base::Base, data::Data, library, problem::ForceProblem};
use std::time::Instant;
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let bytes = std::fs::read(&args[1]).unwrap();
    let frame = Frame::from_parquet(&bytes).unwrap();
    let rows: Vec<Row> = row::from_frame(&frame).unwrap();
    let rows: Vec<&Row> = rows.iter().filter(|r| r.campaign == args[2] && r.force_n.is_finite() && !r.excluded).collect();
    let d = rows[0].diameter_mm as u32;
    let data = Data::new(&rows).with_placebo(1);
    let lengths: std::collections::BTreeSet<u64> = rows.iter().map(|r| r.rest_length_m.to_bits()).collect();
    let base = Base::new(d, true, lengths.len(), &FitOptions::default());
    let lib = library::terms(&data);
    println!("{} readings {} sessions {} specimens {} terms", data.len(), data.sessions.len(), data.specimens.len(), lib.len());
    let p = ForceProblem::new(&base, &data, &lib).with_reference();
    let s = Setting::new(&p);
    let t = Instant::now();
    let null = s.fit_afresh(&p.start());
    println!("null {:?} ll {:.1} conv {} {:?}\n {:?}\n {:?}", t.elapsed(), null.log_likelihood, null.converged, null.point.coefficients, null.variances, 0);
    { let t = Instant::now(); for _ in 0..20 { let _ = p.linearise(&null.point); } println!("linearise {:?}", t.elapsed()/20); let t = Instant::now(); for _ in 0..20 { let _ = p.predict(&null.point); } println!("predict {:?}", t.elapsed()/20); let t = Instant::now(); for _ in 0..20 { let _ = null.design.gram(); } println!("gram {:?}", t.elapsed()/20); let t = Instant::now(); for _ in 0..20 { let _ = null.factor(); } println!("factor {:?}", t.elapsed()/20); let t = Instant::now(); for _ in 0..20 { let _ = null.factor().posterior(pipeline::inference::system::Likelihood::Full); } println!("posterior {:?}", t.elapsed()/20);}
    let t = Instant::now();
    let dirs = p.directions(&null.point);
    println!("{} directions {:?}", dirs.len(), t.elapsed());
    let t = Instant::now();
    let cols: Vec<Vec<f64>> = dirs.iter().flat_map(|d| d.columns.clone()).collect();
    let panel = pipeline::inference::system::Panel::new(&null.design, &cols, false);
    println!("panel {:?}", t.elapsed());
    let t = Instant::now();
    let f = null.factor();
    let pr = f.project(&panel);
    println!("project {:?}", t.elapsed());
    let mut list: Vec<(f64, String)> = Vec::new();
    let mut k = 0;
    for d in &dirs {
        let term = &lib[d.term];
        let name = format!("{:?} {:?} {:?} {:?}", term.id(), term.form().map(|f| f.name), term.scope, term.what);
        for _ in &d.columns {
            let share = pr.squares[k] / pr.unprojected[k];
            if share > 0.01 { list.push((pr.scores[k]*pr.scores[k]/pr.squares[k], format!("{name} a={:.3} share {:.3}", pr.scores[k]/pr.squares[k], share))); }
            k += 1;
        }
    }
    list.sort_by(|a, b| b.0.total_cmp(&a.0));
    for (z, n) in list.iter().take(15) { println!("{z:8.1} {n}"); }
    let mut seen = std::collections::BTreeSet::new();
    for (d, _) in dirs.iter().map(|d| (d, ())) {
        let term = &lib[d.term];
        let Some(id) = term.id() else { continue };
        if term.scope != library::Scope::All || !seen.insert((id, term.form().unwrap().name)) || !(args.len() > 3 && args[3..].contains(&id.to_string())) { continue; }
        for a in std::env::var("A").unwrap_or("0.001".into()).split(',') { let a: f64 = a.parse().unwrap();
        let t = Instant::now();
        let mut from = if std::env::var("FRESH").is_ok() { p.start() } else { null.point.clone() };
        from.terms.push((d.term, term.start(a)));
        let fit = if std::env::var("FRESH").is_ok() { s.fit_afresh(&from) } else { s.fit(&from, &s.fresh()) };
        println!("  {a} {:?}", fit.point.coefficients);
        println!("{id} {:?} ll {:.1} {:?} {:?} conv {} {:?}", term.form().unwrap().name, fit.log_likelihood, fit.point.terms[0].1, fit.variances, fit.converged, t.elapsed());
    }}
}
