//! Every effect against closed forms, and all of them against what an operator must be.

use super::*;
use pipeline_numerics::real::Dual;
use std::cell::RefCell;
use std::collections::BTreeSet;

/// A linear spring with a gain for the pressure: F = a P + k (l - l_rest).
struct Spring;

const GAIN: f64 = 0.5;
const STIFFNESS: f64 = 2e4;

impl Actuator for Spring {
    fn force<R: Real>(&self, _: &[R], pressure: R, length: R, at: &Conditions) -> R {
        pressure * GAIN + (length - at.rest_length_m) * STIFFNESS
    }
}

fn somewhere() -> Conditions {
    Conditions {
        direction: 1.0,
        moved: 1.0,
        highest_kpa: 620.0,
        first_filling: true,
        log_time_s: 12.0,
        campaign_time: 0.4,
        since_step_s: 3.0,
        rate_kpa_per_s: 7.0,
        temperature_c: 2.5,
        cycles: 15.0,
        zero_force_n: 4.0,
        pulls: false,
        middle_rest_length_m: 0.25,
        ..Conditions::at(0.2, 0.16, 0.195, 400.0)
    }
}

fn shown<R: Real>(effects: &[Applied<R>], at: &Conditions) -> R {
    force(&Spring, &[], R::constant(1.0), effects, at)
}

fn applied<R: Real>(id: &str, form: usize, amplitude: f64, shape: f64) -> Applied<R> {
    Applied {
        effect: index(id).unwrap_or_else(|| panic!("{id}")),
        form,
        parameters: [R::constant(amplitude), R::constant(shape)],
    }
}

/// Every effect, form and shape of the library, with an amplitude inside its bounds.
fn all_forms() -> Vec<(usize, usize, f64, f64)> {
    let mut list = Vec::new();
    for (e, effect) in all().iter().enumerate() {
        for (f, form) in effect.forms().iter().enumerate() {
            let shapes = form.shape.map_or(vec![f64::NAN], |(_, grid)| grid.to_vec());
            let amplitude = 0.01 * form.amplitude.bounds.1;
            list.extend(shapes.into_iter().map(|shape| (e, f, amplitude, shape)));
        }
    }
    list
}

#[test]
fn an_effect_of_no_size_changes_nothing() {
    let at = somewhere();
    let plain: f64 = shown(&[], &at);
    assert!((plain - 100.0).abs() < 1e-9, "{plain}");
    for (effect, form, _, shape) in all_forms() {
        let nothing = Applied {
            effect,
            form,
            parameters: [0.0, shape],
        };
        let same = shown(&[nothing], &at);
        assert!(
            (same - plain).abs() < 1e-9,
            "{} {form}: {same}",
            all()[effect].id()
        );
    }
}

#[test]
fn derivatives_by_amplitude_and_shape_are_those_of_differences() {
    let at = somewhere();
    for (effect, form, amplitude, shape) in all_forms() {
        let value = |a: f64, s: f64| {
            let parameters = [a, s];
            shown(
                &[Applied {
                    effect,
                    form,
                    parameters,
                }],
                &at,
            )
        };
        let exact: Dual<2> = shown(
            &[Applied {
                effect,
                form,
                parameters: [Dual::variable(amplitude, 0), Dual::variable(shape, 1)],
            }],
            &at,
        );
        let name = format!("{} {form}", all()[effect].id());
        let step = 1e-5 * amplitude.abs().max(1e-3);
        let by_amplitude =
            (value(amplitude + step, shape) - value(amplitude - step, shape)) / (2.0 * step);
        let near = |a: f64, b: f64| (a - b).abs() < 1e-5 * (1.0 + a.abs().max(b.abs()));
        assert!(
            near(exact.gradient[0], by_amplitude),
            "{name}: {} {by_amplitude}",
            exact.gradient[0]
        );
        if shape.is_finite() {
            let step = 1e-5 * shape.abs();
            let by_shape =
                (value(amplitude, shape + step) - value(amplitude, shape - step)) / (2.0 * step);
            assert!(
                near(exact.gradient[1], by_shape),
                "{name}: {} {by_shape}",
                exact.gradient[1]
            );
        }
    }
}

/// Where a reading pulls, friction is a constant of the tension, through nothing and beyond; where nobody knows, it takes the last of the tension
/// and the derivatives with it.
#[test]
fn friction_of_a_reading_that_pulls_keeps_the_derivatives() {
    let at = |tension: f64, pulls: bool| Conditions {
        pulls,
        pressure_kpa: 0.0,
        length_m: 0.2 + tension / STIFFNESS,
        ..somewhere()
    };
    for (id, form) in [("hysteresis", 0), ("rate_dependence", 0)] {
        let slope = |tension: f64, pulls: bool| {
            let at = at(tension, pulls);
            let by_length = |step: f64| {
                let at = Conditions {
                    length_m: at.length_m + step,
                    ..at
                };
                let friction = applied(id, form, 2.0, f64::NAN);
                shown::<f64>(&[friction], &at)
            };
            (by_length(1e-7) - by_length(-1e-7)) / 2e-7
        };
        for tension in [-1.0, -1e-3, 1e-3, 1.0, 100.0] {
            let slope = slope(tension, true);
            assert!(
                (slope / STIFFNESS - 1.0).abs() < 1e-6,
                "{id} {tension}: {slope}"
            );
        }
        assert!(slope(0.05, false) < 0.01 * STIFFNESS, "{id}");
    }
}

/// At resting length nothing slides; a second filling has nothing of the first.
#[test]
fn what_does_not_slide_has_no_friction_and_what_has_settled_stays_settled() {
    let forms = [("hysteresis", 5), ("conditioning", 1)];
    let changed = |at: &Conditions| -> [f64; 2] {
        forms.map(|(id, form)| {
            let plain: f64 = shown(&[], at);
            let with: f64 = shown(&[applied(id, form, 5.0, f64::NAN)], at);
            with - plain
        })
    };
    let at_rest = Conditions {
        length_m: 0.2,
        ..somewhere()
    };
    assert_eq!(changed(&at_rest), [0.0, 0.0]);
    let settled = Conditions {
        first_filling: false,
        pressure_kpa: 620.0,
        ..somewhere()
    };
    assert_eq!(changed(&settled), [0.0, 0.0]);
}

/// F = a P + k (l - C F - l_rest) is F = (a P + k (l - l_rest))/(1 + k C).
#[test]
fn a_yielding_frame_balances_as_two_springs_in_series() {
    let at = somewhere();
    let c = 8.0;
    let compliance = Applied {
        parameters: [Dual::<1>::variable(c, 0), Dual::constant(f64::NAN)],
        ..applied("series_compliance", 0, c, f64::NAN)
    };
    let force = shown(&[compliance], &at);
    let softer = 1.0 + STIFFNESS * c * 1e-6;
    assert!(
        (force.value - 100.0 / softer).abs() < 1e-9,
        "{}",
        force.value
    );
    let slope = -STIFFNESS * 1e-6 * 100.0 / (softer * softer);
    assert!(
        (force.gradient[0] - slope).abs() < 1e-9,
        "{} {slope}",
        force.gradient[0]
    );
}

/// What the braid loses in friction is no load of the frame: F = (a P + k (l - l_rest) - h)/(1 + k C).
#[test]
fn a_yielding_frame_carries_what_friction_leaves() {
    let at = Conditions {
        pulls: true,
        ..somewhere()
    };
    let c = 8.0;
    let softer = 1.0 + STIFFNESS * c * 1e-6;
    let of = |form: usize| {
        let friction = applied("hysteresis", form, 4.0, f64::NAN);
        let frame = applied("series_compliance", 0, c, f64::NAN);
        shown::<f64>(&[friction, frame], &at)
    };
    assert!((of(0) - 96.0 / softer).abs() < 1e-9, "{}", of(0));
    // What also shows where the actuator is slack is no friction of its braid.
    assert!((of(1) - (100.0 / softer - 4.0)).abs() < 1e-9, "{}", of(1));
}

#[test]
fn operators_do_what_their_equations_say() {
    let at = somewhere();
    let tried = RefCell::new(BTreeSet::new());
    let f = |id: &str, form: usize, amplitude: f64, shape: f64| -> f64 {
        tried.borrow_mut().insert((id.to_owned(), form));
        shown(&[applied(id, form, amplitude, shape)], &at)
    };
    let ln = libm::log;
    let within = |change: f64| change / (1.0 + (change / 100.0) * (change / 100.0)).sqrt();
    // Contracted by 2.5%, 2.5 times as far as friction needs to set in.
    let slid = 6.25 / 7.25;
    let gradual = 100.0 - 0.5 * 30.0 * (1.0 - libm::exp(-somewhere().pressure_kpa / 30.0));
    let expected = [
        (f("force_zero_offset", 0, 3.0, f64::NAN), 103.0),
        (f("force_zero_offset", 1, 0.5, f64::NAN), 98.0),
        (f("force_gain", 0, 0.05, f64::NAN), 105.0),
        (f("force_drift", 0, 0.2, f64::NAN), 102.4),
        (f("force_drift", 1, 10.0, f64::NAN), 104.0),
        (f("pressure_zero_offset", 0, 20.0, f64::NAN), 90.0),
        (f("pressure_gain", 0, 0.1, f64::NAN), 120.0),
        (f("bladder_threshold", 0, 30.0, f64::NAN), 85.0),
        (f("bladder_threshold", 1, 30.0, f64::NAN), gradual),
        (f("length_offset", 0, 1.0, f64::NAN), 120.0),
        (f("temperature", 0, -0.01, f64::NAN), 97.5),
        (f("temperature", 1, -0.01, 0.1), 100.0 - 2.5 - 0.625),
        (f("hysteresis", 0, 4.0, f64::NAN), 100.0 - within(4.0)),
        (f("hysteresis", 1, 4.0, f64::NAN), 96.0),
        (f("hysteresis", 2, 0.02, f64::NAN), 98.0),
        (f("hysteresis", 3, 6.2, f64::NAN), 100.0 - within(4.0)),
        (f("hysteresis", 4, 10.0, f64::NAN), 95.0),
        (
            f("hysteresis", 5, 20.0, f64::NAN),
            100.0 - within(40.0 * (1.0 - 400.0 / 620.0) * slid),
        ),
        (f("rate_dependence", 0, 0.5, f64::NAN), 100.0 - within(3.5)),
        (f("creep", 0, -0.01, 1.0), 100.0 * (1.0 - 0.01 * ln(4.0))),
        (
            f("creep", 1, -0.01, 6.0),
            100.0 * (1.0 - 0.01 * (1.0 - libm::exp(-0.5))),
        ),
        (
            f("conditioning", 0, 0.1, 15.0),
            100.0 * (1.0 - 0.1 * (1.0 - libm::exp(-1.0))),
        ),
        (
            f("conditioning", 1, 8.0, f64::NAN),
            100.0 - within(8.0 * slid),
        ),
        (f("misalignment", 0, 60.0, f64::NAN), 50.0),
        (f("rest_length_scaling", 0, 2.0, f64::NAN), 90.0),
        (f("rest_length_scaling", 1, 2.0, f64::NAN), 87.5),
        (f("specimen_variation", 0, 0.05, f64::NAN), 105.0),
    ];
    for (k, (shown, says)) in expected.into_iter().enumerate() {
        assert!((shown - says).abs() < 1e-9, "number {k}: {shown} {says}");
    }
    // A frame that yields is in balance with the force, which has tests of its own.
    let of_effect = |e: &&dyn Effect| {
        let id = e.id().to_owned();
        let forms = e.forms().iter().enumerate();
        let forms = forms.filter(|(_, form)| form.place != Place::Frame);
        forms.map(move |(k, _)| (id.clone(), k)).collect::<Vec<_>>()
    };
    let all: BTreeSet<(String, usize)> = all().iter().flat_map(of_effect).collect();
    assert_eq!(tried.into_inner(), all, "a form has no line above");
}

#[test]
fn a_pressure_below_nothing_is_no_matter_of_the_threshold() {
    let mut at = somewhere();
    at.pressure_kpa = -0.8;
    let without = shown::<f64>(&[], &at);
    for (form, threshold) in [(0, 1e-6), (0, 50.0), (1, 1e-6), (1, 1e-2), (1, 50.0)] {
        let with = shown::<f64>(
            &[applied("bladder_threshold", form, threshold, f64::NAN)],
            &at,
        );
        assert_eq!(with, without, "{form} {threshold}");
    }
}

/// Inputs first, the sensor last, whatever the order in which effects were found.
#[test]
fn the_order_of_the_list_does_not_matter() {
    let at = somewhere();
    let gain = applied::<f64>("force_gain", 0, 0.1, f64::NAN);
    let zero = applied("force_zero_offset", 0, 5.0, f64::NAN);
    let length = applied("length_offset", 0, 1.0, f64::NAN);
    let expected = 120.0 * 1.1 + 5.0;
    for list in [
        [gain, length, zero],
        [length, gain, zero],
        [zero, length, gain],
    ] {
        assert!((shown(&list, &at) - expected).abs() < 1e-9);
    }
}

#[test]
fn arguments_are_known_where_their_form_is_and_scales_turn_back() {
    for effect in all() {
        for (k, form) in effect.forms().iter().enumerate() {
            let Some(argument) = effect.argument(k) else {
                continue;
            };
            let needed = match argument {
                Argument::SinceStep => Some(Need::SinceStep),
                Argument::LogTime => Some(Need::LogTime),
                Argument::CampaignTime => Some(Need::CampaignTime),
                Argument::Cycles => Some(Need::Cycles),
                Argument::Temperature => Some(Need::Temperature),
                Argument::Rate => Some(Need::Rate),
                Argument::RestLength => Some(Need::RestLengths),
                Argument::Force | Argument::Pressure | Argument::Contraction => None,
            };
            assert!(
                needed.is_none_or(|n| form.needs.contains(&n)),
                "{}",
                effect.id()
            );
            for x in [0.0, 0.3, 40.0, 2e4] {
                let back = argument.unscaled(argument.scaled(x));
                assert!((back - x).abs() < 1e-9 * (1.0 + x), "{}", effect.id());
            }
        }
    }
}

/// What a form needs has a name in files, by which pages find its words.
#[test]
fn every_need_of_a_form_is_in_the_list_of_all_under_a_name_of_its_own() {
    let forms = all().iter().flat_map(|e| e.forms());
    let needs: BTreeSet<Need> = forms.flat_map(|f| f.needs.iter().copied()).collect();
    let listed = BTreeSet::from(Need::ALL);
    assert!(needs.is_subset(&listed), "{needs:?}");
    let names: BTreeSet<&str> = Need::ALL.iter().map(|n| n.id()).collect();
    assert_eq!(names.len(), Need::ALL.len());
}
