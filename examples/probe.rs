//! Development probe: searches the campaigns of a parquet file of rows.
use pipeline::base::frame::Frame;
use pipeline::base::row;
use pipeline::config::FitOptions;
use pipeline::stages::diagnose::{base::Base, candidates, data::Data, search::Search};
use std::collections::BTreeMap;
fn main() {
    let path = std::env::args().nth(1).unwrap();
    let frame = Frame::from_parquet(&std::fs::read(path).unwrap()).unwrap();
    let rows = row::from_frame(&frame).unwrap();
    let mut groups: BTreeMap<(String, u32), Vec<&row::Row>> = BTreeMap::new();
    for r in rows.iter().filter(|r| pipeline::stages::fit::is_fitted(r)) {
        groups.entry((r.campaign.clone(), r.diameter_mm as u32)).or_default().push(r);
    }
    for ((campaign, d), rows) in groups {
        let data = Data::new(&rows).thinned(1500);
        let lengths: std::collections::BTreeSet<u64> = rows.iter().map(|r| r.rest_length_m.to_bits()).collect();
        let base = Base::new(d, true, lengths.len(), &FitOptions::default());
        let candidates = candidates::candidates(&data);
        println!("{campaign} {d} mm: {} readings {} sessions {} specimens, {} candidates, missing {:?}", data.len(), data.sessions.len(), data.specimens.len(), candidates.len(), data.missing.keys());
        let search = Search { base: &base, data: &data, candidates: &candidates, most: 4 };
        let t = std::time::Instant::now();
        let best = search.run();
        println!("  {:?} criterion {:.1} sigma {:.3} scatter {:.3} n_eff {:.0} in {:.2?}", best.fitted.base, best.criterion, best.fitted.sigma, best.fitted.scatter, best.effective, t.elapsed());
        println!("  strengths {:.3?}", best.fitted.strengths);
        for (c, v) in best.chosen.iter().zip(&best.fitted.terms) {
            println!("  {:?} {:?} {:?} -> {:.4?}", candidates[*c].id(), candidates[*c].what, candidates[*c].scope, v);
        }
    }
}
