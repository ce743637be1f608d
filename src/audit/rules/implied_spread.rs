//! The spread of the data that RMSE and adjusted R2 imply together: training and validation rows must have the same, and none can have
//! more than the range of the data allows.

use super::{UNLIKELY, either_direction, probability, rows, show, validation};
use crate::claims::{Claim, ClaimList, Fit, Kind, Split};
use crate::findings::{Case, Rule, Verdict};

pub(super) const RULE: Rule = Rule {
    id: "implied_spread",
    title: "The spread of the data that the statistics imply",
    idea: "The standard deviation of the fitted data is RMSE/√(1 − adjusted R²). Training and validation rows are drawn from the same data and must give the same, up to chance (F test, one in a hundred) and the digits printed; and data between two limits cannot spread by more than half their distance.",
    cases,
};

/// The smallest, nominal and largest standard deviation that the printed digits allow.
struct Spread([f64; 3]);

impl Spread {
    fn new(rmse: &Claim, adj_r2: &Claim) -> Self {
        let ((e_low, e_high), (r_low, r_high)) = (rmse.printed.ends(), adj_r2.printed.ends());
        let sd = |rmse: f64, adj_r2: f64| rmse / (1.0 - adj_r2).max(0.0).sqrt();
        Self([
            sd(e_low, r_low),
            sd(rmse.printed.value, adj_r2.printed.value),
            sd(e_high, r_high),
        ])
    }

    fn show(&self) -> String {
        let [low, nominal, high] = self.0.map(|x| show(x, 3));
        format!("{nominal} ({low} to {high} by rounding)")
    }
}

fn cases(list: &ClaimList) -> Vec<Case> {
    list.fits().flat_map(|fit| of_fit(list, fit)).collect()
}

fn of_fit(list: &ClaimList, fit: &Fit) -> Vec<Case> {
    let of = |rmse: Option<&Claim>, r2: Option<&Claim>| Some(Spread::new(rmse?, r2?));
    let train = of(
        list.statistic(&fit.id, Split::Model, Kind::Rmse),
        list.statistic(&fit.id, Split::Model, Kind::AdjR2),
    );
    let kept = of(
        validation(list, fit, Kind::Rmse),
        validation(list, fit, Kind::AdjR2),
    );
    let mut cases = Vec::new();
    for (split, spread) in [(Split::Model, &train), (Split::Validation, &kept)] {
        // What is borrowed from another place is judged there.
        let own = split == Split::Model || fit.validated_as.is_none();
        if let (Some(spread), Some(range), true) = (spread, fit.range, own) {
            cases.push(within_range(fit, split, spread, range));
        }
    }
    if let (Some(train), Some(kept), (Some(n), Some(m))) = (train, kept, rows(list, fit)) {
        cases.push(alike(fit, (&train, n), (&kept, m)));
    }
    cases
}

fn alike(fit: &Fit, (train, n): (&Spread, f64), (kept, m): (&Spread, f64)) -> Case {
    // The ends of the rounding that are nearest to each other.
    let ratio = if kept.0[1] > train.0[1] {
        (kept.0[0] / train.0[2]).max(1.0)
    } else {
        (kept.0[2] / train.0[0]).min(1.0)
    };
    let p = either_direction(ratio * ratio, m - 1.0, n - 1.0);
    let verdict = if p < UNLIKELY {
        Verdict::Inconsistent
    } else {
        Verdict::Consistent
    };
    Case {
        subject: format!("{}: training and validation", fit.title),
        of: vec![fit.id.clone()],
        verdict,
        left: Some(train.0[1]),
        right: Some(kept.0[1]),
        unit: String::new(),
        reasoning: format!(
            "The training statistics imply data with a standard deviation of {}, the validation statistics one of {}; at the nearest, the probability is {}. {}",
            train.show(),
            kept.show(),
            probability(p),
            match verdict {
                Verdict::Inconsistent =>
                    "They cannot be of the same data: at least one of RMSE and adjusted R² is not what its name says.",
                Verdict::Consistent => "This is what chance gives.",
            }
        ),
    }
}

fn within_range(fit: &Fit, split: Split, spread: &Spread, (low, high): (f64, f64)) -> Case {
    let most = 0.5 * (high - low);
    let beyond = spread.0[0] > most;
    Case {
        subject: format!("{}: {}", fit.title, split.name()),
        of: vec![fit.id.clone()],
        verdict: if beyond {
            Verdict::Inconsistent
        } else {
            Verdict::Consistent
        },
        left: Some(spread.0[1]),
        right: Some(most),
        unit: String::new(),
        reasoning: format!(
            "The statistics imply data with a standard deviation of {}; between {low} and {high} at most {most} is possible.",
            spread.show()
        ),
    }
}
