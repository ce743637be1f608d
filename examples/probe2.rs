//! Development probe.
use pipeline::base::row::Row;
use pipeline::config::FitOptions;
use pipeline::simulate::{campaign_rows, trials::{self, Size}};
use pipeline::stages::diagnose::{base::Base, candidates, data::Data, search::Search};
use rayon::prelude::*;
fn main() {
    let seeds: u64 = std::env::args().nth(1).and_then(|s| s.parse().ok()).unwrap_or(2);
    let which = std::env::args().nth(2).unwrap_or_default();
    let mut cases: Vec<&trials::Case> = vec![&trials::NULL];
    cases.extend(trials::SINGLE); cases.extend(trials::OTHER_FORMS); cases.extend(trials::OUTSIDE);
    let jobs: Vec<(&trials::Case, Size, u64)> = cases.iter().filter(|c| which.is_empty() || c.id.contains(&which)).flat_map(|c| [Size::Medium, Size::Large].into_iter().flat_map(move |z| (0..seeds).map(move |s| (*c, z, s)))).collect();
    let lines: Vec<String> = jobs.par_iter().map(|(c, z, seed)| {
        let truth = trials::truth(c.design, &c.table(*z), *seed);
        let made = campaign_rows(&truth);
        let rows: Vec<&Row> = made.rows.iter().filter(|r| pipeline::stages::fit::is_fitted(r)).collect();
        let data = Data::new(&rows);
        let base = Base::new(10, true, 6, &FitOptions::default());
        let candidates = candidates::candidates(&data);
        let search = Search { base: &base, data: &data, candidates: &candidates, most: 4 };
        let t = std::time::Instant::now();
        let best = search.run();
        let found: Vec<String> = best.chosen.iter().zip(&best.fitted.terms).map(|(k, v)| {
            let term = &candidates[*k];
            let first = if v.0.len() > 1 { format!("{} values", v.0.len()) } else { format!("{:.4}", v.0[0]) };
            format!("{}[{:?}] {first} {:.2}", term.id().map(str::to_owned).unwrap_or(format!("{:?}", term.what)), term.scope, v.1)
        }).collect();
        let hit = best.chosen.iter().any(|k| candidates[*k].id() == Some(c.id));
        format!("{} {:20} {:18} {:6?} {} n {} s {:.3} u {:.3} {:5.2}s: {}", if hit { "+" } else { "-" }, c.id, c.form, z, seed, data.len(), best.fitted.sigma, best.fitted.scatter, t.elapsed().as_secs_f64(), found.join("; "))
    }).collect();
    for l in lines { println!("{l}"); }
}
