//! The generator does what it says: sizes as asked, nothing moved by an effect but the effect, and a density that is right for its readings.

use super::*;
use pipeline_numerics::statistics::{mean, standard_deviation};

fn with(effects: Vec<Put>) -> Settings {
    Settings {
        effects,
        ..Settings::default()
    }
}

fn put(id: &'static str, form: &'static str, size: f64) -> Put {
    Put {
        id,
        form,
        size,
        others: &[],
        from: 0.0,
    }
}

#[test]
fn a_campaign_has_four_to_eight_specimens_of_four_sessions_of_three_runs_up_and_down() {
    let mut sizes = std::collections::BTreeSet::new();
    for seed in 0..20 {
        let made = campaign(seed, &Settings::default());
        let n = made.truth.drawn.muscles.len();
        sizes.insert(n);
        assert_eq!(made.rows.len(), n * 4 * 3 * 24);
        assert!(made.rows.iter().all(|r| r.force_n.is_finite()));
        let pressures: Vec<f64> = made.rows.iter().map(|r| r.pressure_kpa).collect();
        assert!(pressures.iter().all(|p| (25.0..650.0).contains(p)));
    }
    assert_eq!(sizes.into_iter().collect::<Vec<usize>>(), [4, 5, 6, 7, 8]);
}

#[test]
fn what_is_drawn_has_the_sizes_that_it_says() {
    for family in [Family::Design, Family::Published] {
        let settings = Settings {
            family,
            ..Settings::default()
        };
        let (mut lengths, mut gains, mut misfits, mut common) = (vec![], vec![], vec![], vec![]);
        for seed in 0..60 {
            let drawn = Drawn::new(seed, &settings);
            let sizes = drawn.sizes;
            lengths.extend(
                drawn
                    .setups
                    .iter()
                    .map(|s| s.length_error_mm / sizes.length_mm),
            );
            gains.extend(drawn.muscles.iter().map(|m| m.gain / sizes.gain));
            for setup in &drawn.setups {
                let along = drawn.misfit.along(300.0);
                misfits.push(along.iter().zip(&setup.weights).map(|(f, w)| f * w).sum());
            }
            for k in 0..100 {
                let (x, p) = (0.075 * f64::from(k % 10), 0.1 + 0.09 * f64::from(k / 10));
                common.push(drawn.misfit.common(x, p));
            }
        }
        assert!((standard_deviation(&lengths) - 1.0).abs() < 0.08);
        assert!((standard_deviation(&gains) - 1.0).abs() < 0.15);
        let sd = standard_deviation(&misfits);
        assert!((sd - 1.0).abs() < 0.15, "{family:?} {sd}");
        let rms = mean(&common.iter().map(|m| m * m).collect::<Vec<f64>>()).sqrt();
        assert!((rms - 1.0).abs() < 0.2, "{family:?} {rms}");
    }
}

#[test]
fn an_effect_changes_nothing_but_its_own_trace() {
    let null = campaign(3, &Settings::default());
    let zero = campaign(3, &with(vec![put("force_zero_offset", "", 5.0)]));
    for (a, b) in null.rows.iter().zip(&zero.rows) {
        assert!((b.force_n - a.force_n - 5.0).abs() < 1e-9);
        assert_eq!(a.pressure_kpa, b.pressure_kpa);
    }
    let threshold = campaign(3, &with(vec![put("bladder_threshold", "", 40.0)]));
    let lower = |(a, b): &(&Row, &Row)| b.force_n <= a.force_n;
    assert!(null.rows.iter().zip(&threshold.rows).all(|p| lower(&p)));
}

#[test]
fn an_effect_from_the_middle_of_the_campaign_on_leaves_the_first_half_alone() {
    let gain = Put {
        from: 0.5,
        ..put("force_gain", "", 1.1)
    };
    let (null, changed) = (
        campaign(4, &Settings::default()),
        campaign(4, &with(vec![gain])),
    );
    let dates: std::collections::BTreeSet<&String> =
        null.rows.iter().filter_map(|r| r.date.as_ref()).collect();
    let middle = *dates.iter().nth(dates.len().div_ceil(2)).expect("dates");
    for (a, b) in null.rows.iter().zip(&changed.rows) {
        let acts = a.date.as_ref() >= Some(middle);
        assert!(acts || a.force_n == b.force_n);
        // Noise is not part of what is gained.
        assert!(!acts || a.force_n < 60.0 || (b.force_n / a.force_n - 1.1).abs() < 0.03);
    }
}

#[test]
fn families_and_seeds_share_nothing() {
    let design = campaign(1, &Settings::default());
    let other = campaign(
        1,
        &Settings {
            family: Family::Published,
            ..Settings::default()
        },
    );
    assert_ne!(design.truth.drawn.sizes, other.truth.drawn.sizes);
    assert_ne!(design.truth.drawn.misfit, other.truth.drawn.misfit);
    assert_ne!(
        design.rows[0].force_n,
        campaign(2, &Settings::default()).rows[0].force_n
    );
}

/// Twice the gap between the log density and that of white noise is chi-squared: the mean of many tells whether a variance is wrong.
#[test]
fn the_readings_are_as_likely_as_the_generating_model_says() {
    for family in [Family::Design, Family::Published] {
        let mut excess = Vec::new();
        for seed in 0..6 {
            let settings = Settings {
                family,
                specimens: Some(4),
                ..Settings::default()
            };
            let made = campaign(100 + seed, &settings);
            excess.extend(Generating::new(&made).mahalanobis());
        }
        // 24 specimens of 288 readings: a standard deviation of 0.017.
        let mean = mean(&excess);
        assert!((mean - 1.0).abs() < 0.06, "{family:?} {mean}");
    }
}

#[test]
fn the_strength_of_an_effect_grows_with_its_size_and_is_none_for_what_the_law_absorbs() {
    let made = campaign(5, &Settings::default());
    let model = Generating::new(&made);
    let strength = |size| model.strength(&[put("hysteresis", "", size)]);
    assert!((strength(2.0) / strength(1.0) - 2.0).abs() < 0.1);
    // A gain of all readings hides in F_620.
    assert!(model.strength(&[put("force_gain", "", 1.1)]) < 0.3);
}

#[test]
fn mistakes_are_made_in_one_session_or_specimen() {
    let null = campaign(6, &Settings::default());
    for mistake in [
        Mistake::SwappedColumns,
        Mistake::Sign,
        Mistake::SetLength,
        Mistake::RestLength,
    ] {
        let settings = Settings {
            mistake: Some(mistake),
            ..Settings::default()
        };
        let made = campaign(6, &settings);
        let told = made.truth.mistaken.as_ref().expect("a mistake");
        for (a, b) in null.rows.iter().zip(&made.rows) {
            let recorded = |r: &Row| [r.force_n, r.pressure_kpa, r.length_m, r.rest_length_m];
            let wrong = told.sessions.contains(&b.session);
            assert_eq!(recorded(a) != recorded(b), wrong);
        }
    }
}
