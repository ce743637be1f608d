//! Searches the campaigns of a `rows.parquet` and prints the answers: for development.
use pipeline::base::frame::Frame;
use pipeline::base::row;
use pipeline::config::{DiagnoseOptions, FitOptions};
use pipeline::stages::diagnose::diagnose;
use pipeline::stages::fit::{Group, groups};
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let frame = Frame::from_parquet(&std::fs::read(&a[1]).unwrap()).unwrap();
    let rows = row::from_frame(&frame).unwrap();
    let keys: std::collections::BTreeSet<(String, u32, bool)> = rows
        .iter()
        .map(|r| (r.campaign.clone(), r.diameter_mm as u32, r.simulated))
        .collect();
    let list: Vec<_> = keys.into_iter().collect();
    let options = DiagnoseOptions {
        base_model: a.get(2).cloned().unwrap_or("new".into()),
        refit: a.get(3).is_none(),
        ..Default::default()
    };
    let groups: Vec<Group> = groups(&list, false);
    for g in groups {
        let mine: Vec<row::Row> = rows
            .iter()
            .filter(|r| r.campaign == g.campaign && r.diameter_mm as u32 == g.diameter_mm)
            .cloned()
            .collect();
        let t = std::time::Instant::now();
        let Some(d) = diagnose(&g, &mine, &FitOptions::default(), &options) else {
            println!("{} none", g.campaign);
            continue;
        };
        let f = d.findings;
        println!(
            "== {} {:?} in {:.1?}: {}",
            f.campaign,
            f.verdict,
            t.elapsed(),
            f.summary
        );
        println!(
            "   before {:?}\n   after {:?} emp {:?}\n   noise {:?} box {:?} box after {:?}",
            f.before,
            f.after,
            f.after_empirical,
            f.noise_floor,
            f.black_box_rmse_heldout,
            f.black_box_after_rmse_heldout
        );
        for e in &f.effects {
            println!(
                "   + {} [{}] {} {:?} p {:.1e} again {:.2} helps {:.2} heldout {:.2}->{:.2} train {:.2}->{:.2}",
                e.class.join("/"),
                e.acts_on,
                e.form,
                e.parameters
                    .iter()
                    .map(|p| format!(
                        "{}={:.3} ({:.3}..{:.3}) {}",
                        p.name, p.value, p.ci_low, p.ci_high, p.unit
                    ))
                    .collect::<Vec<_>>(),
                e.p_adjusted,
                e.selected_in_folds,
                e.helps_in_folds,
                e.rmse_heldout_before,
                e.rmse_heldout_after,
                e.rmse_before,
                e.rmse_after
            );
        }
        for u in &f.suspects {
            println!("   !! {u:?}");
        }
        if a.get(4).is_some() {
            continue;
        }
        for u in &f.unexplained {
            println!(
                "   ? {} {} p {:.1e} share {:.2} {:?}->{:?}",
                u.column,
                u.shape,
                u.p_adjusted,
                u.share_of_residual,
                u.rmse_heldout_before,
                u.rmse_heldout_after
            );
        }
        for r in &f.rejected {
            println!("   - {} [{}] {:.2}: {}", r.id, r.acts_on, r.share, r.why);
        }
        for b in &f.by_specimen {
            println!(
                "   fold {} n {} {:.1} -> {:.1} box {:?} {:?}",
                b.unit, b.readings, b.before, b.after, b.black_box, b.chosen
            );
        }
        for c in &f.readings_of_the_base {
            println!(
                "   reading {} p {} train {:.2} held {:.2} own {:.2} {:?}",
                c.model,
                c.parameters,
                c.errors.rmse_train,
                c.errors.rmse_heldout,
                c.errors.rmse_heldout_own_strength,
                c.numbers
            );
        }
        for c in &f.coefficients {
            println!(
                "   {} {:.4} -> {:.4} ({:.4}..{:.4}) {}",
                c.name, c.before, c.after, c.ci_low, c.ci_high, c.remark
            );
        }
    }
}
