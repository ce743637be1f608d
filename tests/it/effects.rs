//! The registry of effects: complete in itself, as its page shows it, and the one that the simulator refers to.

use pipeline::effects::{self, Effect, Place, Subject};
use pipeline::simulate::effects::EFFECTS;
use std::collections::BTreeSet;

/// What only the simulator has: dependences for which the search must not have a name.
const OF_THE_SIMULATOR: [&str; 4] = ["age", "humidity", "sensor_curvature", "unknown_column"];
/// What the simulator has as the law of its actuators and as no effect.
const OF_THE_LAW: &str = "rest_length_scaling";

const PAGE: &str = "docs/effects.md";

/// The equation as a cell of a table in Markdown.
fn cell(text: &str) -> String {
    text.replace('|', "\\|")
}

fn place(place: Place) -> &'static str {
    match place {
        Place::Input => "input",
        Place::Frame => "frame",
        Place::Actuator => "actuator",
        Place::Braid => "braid",
        Place::Sensor => "sensor",
    }
}

fn bounds((low, high): (f64, f64)) -> String {
    format!("{low} to {high}")
}

/// The tables of the page, from the registry.
fn tables() -> String {
    let mut lines = vec![
        "| effect | name | of | what measures it | source |".to_owned(),
        "|---|---|---|---|---|".to_owned(),
    ];
    for e in effects::all() {
        let of = match e.subject() {
            Subject::Actuator => "actuator",
            Subject::Rig => "set-up",
        };
        lines.push(format!(
            "| `{}` | {} | {of} | {} | {} |",
            e.id(),
            e.title(),
            cell(e.measurement()),
            cell(e.source())
        ));
    }
    lines.extend([
        String::new(),
        "| effect on the force | form | place | equation | size | bounds |".to_owned(),
        "|---|---|---|---|---|---|".to_owned(),
    ]);
    for e in effects::all() {
        for f in e.forms() {
            let size = &f.amplitude;
            lines.push(format!(
                "| `{}` | {} | {} | {} | {} ({}) | {} |",
                e.id(),
                f.name,
                place(f.place),
                cell(f.equation),
                size.name,
                size.unit,
                bounds(size.bounds)
            ));
        }
    }
    lines.extend([
        String::new(),
        "| effect on a torque | form | place | equation | size | bounds | measured up to |"
            .to_owned(),
        "|---|---|---|---|---|---|---|".to_owned(),
    ]);
    for e in effects::all() {
        for f in e.joint_forms() {
            lines.push(format!(
                "| `{}` | {} | {} | {} | {} ({}) | {} | {} |",
                e.id(),
                f.name,
                place(f.place),
                cell(f.equation),
                f.symbols.join(", "),
                f.unit,
                bounds(f.bounds),
                f.usual
            ));
        }
    }
    lines.join("\n")
}

#[test]
fn the_page_of_effects_is_the_registry() {
    let page = std::fs::read_to_string(PAGE).unwrap();
    assert!(
        page.contains(&tables()),
        "the tables of {PAGE} should be:\n{}",
        tables()
    );
}

#[test]
fn every_effect_has_all_that_is_said_of_it_once() {
    let ids: BTreeSet<&str> = effects::all().iter().map(|e| e.id()).collect();
    assert_eq!(ids.len(), effects::all().len());
    let is_complete = |e: &&&dyn Effect| {
        let said = [e.title(), e.measurement(), e.source()];
        let about_a_joint = e.joint_forms().iter();
        let of_forms = about_a_joint.flat_map(|f| [f.equation, f.unit, f.measurement, f.source]);
        let of_force = e
            .forms()
            .iter()
            .flat_map(|f| [f.equation, f.amplitude.unit]);
        let has_form = e.forms().len() + e.joint_forms().len() > 0;
        has_form
            && said
                .into_iter()
                .chain(of_forms)
                .chain(of_force)
                .all(|s| !s.is_empty())
    };
    for e in effects::all() {
        assert!(is_complete(&e), "{}", e.id());
        for f in e.joint_forms() {
            let (low, high) = f.bounds;
            assert!(
                low <= 0.0 && 0.0 < f.usual && f.usual < high,
                "{} {}",
                e.id(),
                f.name
            );
            assert!((1..=2).contains(&f.symbols.len()), "{} {}", e.id(), f.name);
            // What has an operator of its own stands for itself.
            let has_operator = |id: &str| {
                let known = effects::index(id).map(|k| effects::all()[k]);
                known.is_none_or(|other| !other.joint_forms().is_empty())
            };
            assert!(
                !f.stands_for.iter().any(|s| has_operator(s.id)),
                "{} {}",
                e.id(),
                f.name
            );
        }
    }
}

#[test]
fn the_simulator_has_the_effects_on_the_force_and_refers_to_their_ids() {
    let simulated: BTreeSet<&str> = EFFECTS.iter().map(|e| e.id).collect();
    let on_the_force = effects::all().iter().filter(|e| !e.forms().is_empty());
    let mut expected: BTreeSet<&str> = on_the_force.map(|e| e.id()).collect();
    assert!(expected.remove(OF_THE_LAW));
    expected.extend(OF_THE_SIMULATOR);
    assert_eq!(simulated, expected);
}
