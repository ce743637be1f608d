//! Each effect's closed form on one reading, and how far the other forms lie from the plain one.

use super::*;
use crate::base::session::Phase;
use crate::simulate::chain::{Acting, Actuator, Chain};
use crate::simulate::logged_columns::LogColumns;
use crate::simulate::moment::Instant;

const ACTUATOR: Actuator = Actuator {
    surface: [0.5682, 4.254, 0.5597],
    f620_n: 300.0,
    diameter_mm: 10.0,
    rest_length_m: 0.182,
    contracted_length_m: 0.152,
};

/// A reading in the middle of things.
fn moment() -> Moment {
    Moment {
        place: 5.0,
        cycle: 3.0,
        rest_length_m: 0.182,
        contraction_rel: 0.25,
        f620_n: 300.0,
        axial_force_n: 120.0,
        at: Instant {
            time_s: 12.0,
            share: 0.5,
            since_step_s: 20.0,
            rate_kpa_per_s: 10.0,
            phase: Phase::Depressurizing,
            pressure_kpa: 400.0,
            peak_kpa: 600.0,
        },
    }
}

fn form(id: &str, name: &str) -> &'static Form {
    let effect = by_id(id).expect("an effect");
    effect
        .forms
        .iter()
        .find(|f| f.name == name)
        .expect("a form")
}

fn applied(id: &str, name: &str, p: [f64; 3], column: f64, x: f64) -> f64 {
    (form(id, name).act)(&Given { p, column }, &moment(), x)
}

#[test]
fn every_form_is_its_closed_form() {
    // Computed by hand (Python) from the equations in the documentation, at 400 kPa on the way down from 600 kPa, 20 s after the
    // step, 12 s into the log, in the sixth session, after three cycles, at eps* = 0.25.
    for (id, form, p, column, x, expected) in CLOSED_FORMS {
        let y = applied(id, form, *p, *column, *x);
        assert!(
            (y - expected).abs() <= 1e-9 * expected.abs(),
            "{id} {form}: {y}, {expected}"
        );
    }
    let forms = EFFECTS
        .iter()
        .flat_map(|e| e.forms.iter().map(|f| (e.id, f.name)));
    for (id, name) in forms {
        let checked = CLOSED_FORMS.iter().any(|c| (c.0, c.1) == (id, name));
        assert!(checked, "{id} {name} has no closed form here");
    }
}

type ClosedForm = (&'static str, &'static str, [f64; 3], f64, f64, f64);

#[rustfmt::skip]
const CLOSED_FORMS: &[ClosedForm] = &[
    ("age", "gain", [-0.001, 0.0, 0.0], 90.0, 120.0, 109.2),
    ("age", "saturating", [-0.001, 60.0, 0.0], 90.0, 120.0, 114.4065371530687),
    ("bladder_threshold", "sharp", [25.0, 0.0, 0.0], 0.0, 400.0, 375.0),
    ("bladder_threshold", "sharp", [25.0, 0.0, 0.0], 0.0, 20.5, 0.0),
    ("bladder_threshold", "smooth", [25.0, 12.0, 0.0], 0.0, 30.0, 9.668104213508734),
    ("conditioning", "exponential", [0.1, 5.0, 0.0], 0.0, 120.0, 114.58573963312833),
    ("conditioning", "power", [0.1, 5.0, 1.5], 0.0, 120.0, 113.92927061281571),
    ("creep", "logarithm", [0.02, 2.0, 0.0], 0.0, 120.0, 125.75494865471609),
    ("creep", "stretched", [0.02, 15.0, 0.5], 0.0, 120.0, 121.64363544318671),
    ("force_drift", "linear", [0.1, 0.0, 0.0], 0.0, 120.0, 121.2),
    ("force_drift", "saturating", [0.1, 30.0, 0.0], 0.0, 120.0, 120.98903986189308),
    ("force_drift", "campaign", [0.5, 0.0, 0.0], 0.0, 120.0, 122.5),
    ("force_gain", "constant", [1.05, 0.0, 0.0], 0.0, 120.0, 126.0),
    ("force_gain", "curved", [1.05, 0.4, 0.0], 0.0, 120.0, 125.76),
    ("force_zero_offset", "constant", [5.0, 0.0, 0.0], 0.0, 120.0, 125.0),
    ("force_zero_offset", "wandering", [5.0, 12.0, 0.0], 0.0, 120.0, 126.0),
    ("humidity", "gain", [0.002, 40.0, 0.0], 55.0, 120.0, 123.60000000000001),
    ("humidity", "offset", [0.2, 40.0, 0.0], 55.0, 120.0, 123.0),
    ("hysteresis", "constant", [4.0, 0.0, 0.0], 0.0, 120.0, 124.0),
    ("hysteresis", "proportional", [0.01, 0.0, 0.0], 0.0, 120.0, 124.0),
    ("hysteresis", "play", [15.0, 0.0, 0.0], 0.0, 400.0, 415.0),
    ("hysteresis", "play", [15.0, 0.0, 0.0], 0.0, 590.0, 585.0),
    ("length_offset", "constant", [2.0, 0.0, 0.0], 0.0, 0.17, 0.172),
    ("length_offset", "growing", [2.0, 1.0, 0.0], 0.0, 0.17, 0.171964),
    ("misalignment", "constant", [10.0, 0.0, 0.0], 0.0, 120.0, 118.17693036146497),
    ("misalignment", "turning", [10.0, 0.3, 0.0], 0.0, 120.0, 117.89404772706116),
    ("pressure_gain", "constant", [1.02, 0.0, 0.0], 0.0, 400.0, 392.156862745098),
    ("pressure_gain", "curved", [1.02, 0.4, 0.0], 0.0, 400.0, 391.71089208996716),
    ("pressure_zero_offset", "constant", [9.0, 0.0, 0.0], 0.0, 400.0, 409.0),
    ("pressure_zero_offset", "gained", [9.0, 0.4, 0.0], 0.0, 400.0, 409.52258064516127),
    ("rate_dependence", "linear", [0.4, 0.0, 0.0], 0.0, 120.0, 124.0),
    ("rate_dependence", "square_root", [0.4, 50.0, 0.0], 0.0, 120.0, 128.94427190999915),
    ("rate_dependence", "saturating", [0.4, 50.0, 0.0], 0.0, 120.0, 123.33333333333333),
    ("sensor_curvature", "quadratic", [0.1, 500.0, 0.0], 0.0, 120.0, 122.88),
    ("sensor_curvature", "cubic", [0.1, 500.0, 0.0], 0.0, 120.0, 120.6912),
    ("series_compliance", "linear", [6.0, 0.0, 0.0], 0.0, 0.17, 0.16928),
    ("series_compliance", "stiffening", [6.0, 400.0, 0.0], 0.0, 0.17, 0.16944615384615386),
    ("specimen_variation", "normal", [0.03, 0.0, 0.0], 0.0, 120.0, 123.60000000000001),
    ("specimen_variation", "two_batch", [-0.03, 0.0, 0.0], 0.0, 120.0, 116.39999999999999),
    ("temperature", "linear", [-0.003, 20.0, 0.0], 28.0, 120.0, 117.12),
    ("temperature", "quadratic", [-0.003, 20.0, 0.03], 28.0, 120.0, 116.4288),
    ("temperature", "arrhenius", [-0.003, 20.0, 0.0], 28.0, 120.0, 117.22900140787222),
    ("unknown_column", "gain", [0.01, 2.0, 0.0], 5.0, 120.0, 123.60000000000001),
    ("unknown_column", "offset", [0.5, 2.0, 0.0], 5.0, 120.0, 121.5),
    ("unknown_column", "quadratic", [0.5, 2.0, 0.0], 5.0, 120.0, 124.5),
];

/// A chain with one effect.
fn chain(form: &'static Form, p: [f64; 3]) -> Chain {
    let acting = Acting {
        form,
        p,
        column: None,
    };
    Chain::new(ACTUATOR, vec![acting])
}

#[test]
fn a_yielding_frame_is_in_balance() {
    let (at, none) = (moment(), LogColumns::default());
    for c in [1.0, 6.0, 50.0, 200.0] {
        let force =
            chain(form("series_compliance", "linear"), [c, 0.0, 0.0]).force(0.1745, &at, &none);
        let there = ACTUATOR.force(0.1745 - 1e-6 * c * force, 400.0);
        assert!((force - there).abs() < 1e-6, "{c}: {force}, {there}");
        assert!(force < ACTUATOR.force(0.1745, 400.0));
    }
}

#[test]
fn a_slack_actuator_stays_slack_and_none_pushes() {
    let (mut at, none) = (moment(), LogColumns::default());
    at.at.pressure_kpa = 10.0;
    let force =
        |name, half| chain(form("hysteresis", name), [half, 0.0, 0.0]).force(0.16, &at, &none);
    assert_eq!(ACTUATOR.force(0.16, 10.0), 0.0);
    assert_eq!(force("constant", 5.0), 0.0);
    at.at.pressure_kpa = 400.0;
    let force = chain(form("hysteresis", "constant"), [-200.0, 0.0, 0.0]).force(0.1745, &at, &none);
    assert_eq!(force, 0.0);
}
