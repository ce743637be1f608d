//! What things are called: effects, columns, random effects, sources of error, reasons.

use pipeline_clean::zero::ZeroSource;
use pipeline_compare::NEW;
use pipeline_effects as effects;
use pipeline_effects::Need;
use pipeline_findings::{
    ActsOn, CampaignFindings, EffectFinding, ErrorKind, HeldOutBy, LENGTH_LAW, Level, NotAssessed,
    NotMeasurable, Verdict, WhyNot,
};
use pipeline_fit::engine::CoefficientState;
use pipeline_predict::law::LEAST_SQUARES;

/// What stands among effects and is none of the library.
const CALLED: [(&str, &str); 2] = [
    (LENGTH_LAW, "dependence on the resting length"),
    ("placebo", "shuffled column"),
];

/// What is called otherwise than by its id, of all random effects and sources of error.
const SOURCES: [(&str, &str); 16] = [
    ("set_length", "set lengths"),
    ("specimen_gain", "specimen gain"),
    ("actuator_gain", "actuator gain"),
    ("force_zero", "zero of the force"),
    ("torque_zero", "zero of the torque"),
    ("specimen_lengths", "rounding of free lengths"),
    ("contracted_length", "contracted lengths"),
    ("mounting", "mounting lengths of the tests"),
    ("session_misfit", "misfit of the session"),
    ("stroke_misfit", "misfit of the stroke"),
    ("test_misfit", "misfit of the test"),
    ("common_misfit", "misfit of the law"),
    ("estimation", "estimation"),
    ("noise", "noise"),
    ("log_zero", "zero of the log"),
    ("scatter", "other scatter"),
];

fn look_up(table: &[(&str, &'static str)], id: &str) -> Option<&'static str> {
    table
        .iter()
        .find(|(key, _)| *key == id)
        .map(|(_, name)| *name)
}

/// An identifier as words.
fn spelled(id: &str) -> String {
    id.replace('_', " ")
}

/// What an effect is called.
pub fn effect(id: &str) -> String {
    let registered = || effects::index(id).map(|k| effects::all()[k].title());
    look_up(&CALLED, id)
        .or_else(registered)
        .map_or_else(|| spelled(id), str::to_owned)
}

/// What an effect is called, with its form where the effect has several.
pub fn effect_with_form(id: &str, form: &str) -> String {
    let known = effects::index(id).map(|k| effects::all()[k]);
    let about_a_joint = known.map_or(&[][..], |e| e.joint_forms());
    let titled = about_a_joint.iter().find(|f| f.name == form);
    if let Some(title) = titled.and_then(|f| f.title) {
        return title.to_owned();
    }
    let only = known.map_or(&[][..], |e| e.forms());
    let one = matches!(only, [one] if one.name == form);
    if one || form.is_empty() || form == effect(id) {
        effect(id)
    } else {
        format!("{} ({form})", effect(id))
    }
}

/// A column as a sentence calls it.
pub fn column(column: &str) -> String {
    let name = match column {
        "pressure_kpa" => "pressure",
        "contraction_rel" => "relative contraction",
        "force_n" => "force",
        "torque_nm" => "torque",
        "angle" | "angle_rad" | "angle_deg" => "knee angle",
        "direction" => "direction",
        "time_s" => "time in the log",
        "since_step_s" => "time since the step",
        "pressure_rate" => "rate of the pressure",
        "temperature_c" => "temperature",
        "temperature_less_mean" => "temperature less its mean",
        "cycles" => "cycles",
        "session_order" => "order of the sessions",
        "rest_length_m" => "resting length",
        "zero_unknown" => "whether the zero of the force is known",
        "placebo" => "shuffled column",
        "order" => "order of the readings",
        "sense_of_motion" => "sense of motion",
        "predicted_torque" => "predicted torque",
        "origin_bracket_foot" => "foot of the bracket at the origin",
        "insertion_bracket_foot" => "foot of the bracket at the insertion",
        other => return other.to_owned(),
    };
    name.to_owned()
}

/// An effect, or a column where the library has no such effect.
pub fn candidate(id: &str) -> String {
    if effects::index(id).is_some() || look_up(&CALLED, id).is_some() {
        effect(id)
    } else {
        column(id)
    }
}

/// A random effect.
pub fn scatter(id: &str, level: Level) -> String {
    let name = match (id, level) {
        ("length_offset", Level::Session) => "set length",
        ("length_offset", Level::Test) => "mounting length",
        ("specimen_variation" | "force_gain", Level::Specimen) => "specimen gain",
        ("specimen_variation" | "force_gain", Level::Actuator) => "actuator gain",
        ("specimen_variation" | "force_gain", Level::Campaign) => "campaign gain",
        ("force_zero_offset", Level::Test | Level::Actuator) => "zero of the torque",
        ("force_zero_offset", _) => "zero of the force",
        ("hand_length_bias", _) => "bias of the length by hand",
        ("hand_arm_bias", _) => "bias of the arm by hand",
        ("rest_length" | "rest_length_offset", _) => "resting length",
        ("contracted_length" | "contracted_length_offset", _) => "contracted length",
        _ => return effect(id),
    };
    name.to_owned()
}

/// A source of the expected error.
pub fn source(source: &str) -> String {
    look_up(&SOURCES, source).map_or_else(|| spelled(source), str::to_owned)
}

/// The random effect whose standard deviation stands beside a source of error in a sentence: id and levels.
pub fn scatter_of(source: &str) -> Option<(&'static str, [Level; 2])> {
    match source {
        "set_length" | "mounting" => Some(("length_offset", [Level::Session, Level::Test])),
        "specimen_gain" | "actuator_gain" => {
            Some(("specimen_variation", [Level::Specimen, Level::Actuator]))
        }
        "force_zero" => Some(("force_zero_offset", [Level::Session, Level::Log])),
        "contracted_length" => Some(("contracted_length", [Level::Specimen, Level::Specimen])),
        _ => None,
    }
}

/// A level, of one group.
pub fn level(level: Level) -> &'static str {
    match level {
        Level::Campaign => "campaign",
        Level::Specimen => "specimen",
        Level::Session => "session",
        Level::Log => "log",
        Level::Actuator => "actuator",
        Level::Test => "test",
    }
}

/// What is unseen, and what its readings come in: a specimen and its sessions, an actuator and its tests.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Nouns {
    /// One unit.
    pub unit: &'static str,
    /// Several.
    pub units: &'static str,
    /// One set-up.
    pub setup: &'static str,
    /// Several.
    pub setups: &'static str,
}

/// What was measured: a force, about a knee a torque.
pub fn load(found: &CampaignFindings) -> &'static str {
    if found.kind == "knee-torque" {
        "torque"
    } else {
        "force"
    }
}

/// The nouns of a campaign.
pub fn nouns(found: &CampaignFindings) -> Nouns {
    if found.kind == "knee-torque" {
        Nouns {
            unit: "actuator",
            units: "actuators",
            setup: "test",
            setups: "tests",
        }
    } else {
        Nouns {
            unit: "specimen",
            units: "specimens",
            setup: "session",
            setups: "sessions",
        }
    }
}

/// A verdict as data files name it.
pub fn verdict_id(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::EffectFound => "effect_found",
        Verdict::None => "none",
        Verdict::Unexplained => "unexplained",
        Verdict::NotAssessed => "not_assessed",
    }
}

/// A verdict for people.
pub fn verdict(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::EffectFound => "effect found",
        Verdict::None => "no effect detected",
        Verdict::Unexplained => "unexplained",
        Verdict::NotAssessed => "not assessed",
    }
}

/// Why nothing could be said.
pub fn not_assessed(found: &CampaignFindings) -> String {
    let nouns = nouns(found);
    match found.not_assessed {
        Some(NotAssessed::TooFewReadings) => "too few readings".to_owned(),
        Some(NotAssessed::TooFewSpecimens) => format!("fewer than two {}", nouns.units),
        Some(NotAssessed::NoConvergence) => "the fit without effects did not converge".to_owned(),
        None => "no reason given".to_owned(),
    }
}

/// On what the held-out errors are.
pub fn held_out(found: &CampaignFindings) -> String {
    let nouns = nouns(found);
    match found.design.held_out_by {
        HeldOutBy::Holdout => format!("the {} designated as holdout", nouns.setups),
        HeldOutBy::None => "nothing unseen".to_owned(),
        HeldOutBy::Specimen | HeldOutBy::SpecimenGroups | HeldOutBy::Actuator => {
            format!("unseen {}", nouns.units)
        }
    }
}

/// What each of the searches is without whose errors are held out: `specimen`, or where there are many, `group of specimens`.
pub fn without_one(found: &CampaignFindings) -> &'static str {
    match found.design.held_out_by {
        HeldOutBy::SpecimenGroups => "group of specimens",
        _ => nouns(found).unit,
    }
}

/// How the held-out errors were made.
pub fn held_out_by(found: &CampaignFindings) -> String {
    let nouns = nouns(found);
    match found.design.held_out_by {
        HeldOutBy::Holdout => format!(
            "the {} with the role holdout, used in no fit and no selection",
            nouns.setups
        ),
        HeldOutBy::Specimen => {
            "each specimen in turn, the whole search repeated without it".to_owned()
        }
        HeldOutBy::SpecimenGroups => {
            "groups of specimens in turn, the whole search repeated without them".to_owned()
        }
        HeldOutBy::Actuator => {
            "each actuator in turn, the whole search repeated without it".to_owned()
        }
        HeldOutBy::None if found.design.specimens > 1 => "none: no search was made".to_owned(),
        HeldOutBy::None => format!("none: there is only one {}", nouns.unit),
    }
}

/// The campaign, with joint and diameter.
pub fn campaign(found: &CampaignFindings) -> String {
    let part = found
        .part
        .as_ref()
        .map_or_else(String::new, |part| format!(", {part}"));
    format!("{}{part}, {} mm", found.campaign, found.diameter_mm)
}

/// What an effect acts on, with its preposition.
pub fn acts_on(effect: &EffectFinding) -> String {
    match (effect.acts_on, &effect.column, &effect.from) {
        (ActsOn::Levels, Some(label), _) => format!("by {}", column(label)),
        (ActsOn::From, _, Some(session)) => format!("from {session} on"),
        (only, _, _) => format!("on {}", acts_on_what(only)),
    }
}

/// What an effect acts on, in general.
pub fn acts_on_what(acts_on: ActsOn) -> &'static str {
    match acts_on {
        ActsOn::All => "all readings",
        ActsOn::Levels => "levels of a label",
        ActsOn::From => "from a session on",
    }
}

/// What a recording error looks like: "set length", "force and pressure exchanged".
pub fn recording_error(kind: ErrorKind, quantity: Option<&str>) -> String {
    let what = quantity.map(column_or_quantity);
    match (kind, what) {
        (ErrorKind::Length, Some(what)) => what,
        (ErrorKind::Length, None) => "a length".to_owned(),
        (ErrorKind::SwappedColumns, _) => "force and pressure exchanged".to_owned(),
        (ErrorKind::Unit, what) => format!("unit of the {}", what.as_deref().unwrap_or("column")),
        (ErrorKind::Sign, what) => format!("sign of the {}", what.as_deref().unwrap_or("column")),
        (ErrorKind::Zero, what) => format!("zero of the {}", what.as_deref().unwrap_or("channel")),
        (ErrorKind::Outlier, _) => "an outlier that no common mistake explains".to_owned(),
    }
}

fn column_or_quantity(quantity: &str) -> String {
    match quantity {
        "length" | "length_m" => "set length".to_owned(),
        "rest_length" => "resting length".to_owned(),
        "contracted_length" => "contracted length".to_owned(),
        "mounting_length" => "mounting length".to_owned(),
        "muscle_length" => "muscle length by hand".to_owned(),
        "moment_arm" => "moment arm by hand".to_owned(),
        other => column(other),
    }
}

/// What a campaign would need to show an effect.
pub fn quantity(by: &str) -> String {
    let need = Need::ALL.iter().find(|need| need.id() == by);
    need.map_or_else(|| column(by), |need| need.text().to_owned())
}

/// Why a campaign cannot show an effect.
pub fn why_not(found: &CampaignFindings, none: &NotMeasurable) -> String {
    match (none.reason, &none.by) {
        (WhyNot::Absorbed, None) if found.coefficients.is_empty() => {
            "absorbed by the effects found and the random effects".to_owned()
        }
        _ => why_not_of_law(none),
    }
}

/// The same where the coefficients of a law are fitted.
pub fn why_not_of_law(none: &NotMeasurable) -> String {
    let by = none.by.as_deref();
    match (none.reason, by) {
        (WhyNot::Absorbed, Some(by)) if effects::index(by).is_some() => {
            format!("absorbed by {}", effect(by))
        }
        (WhyNot::Absorbed, Some(by)) => format!("absorbed by {by}"),
        (WhyNot::Absorbed, None) => "absorbed by the fitted coefficients".to_owned(),
        (WhyNot::NoColumn, Some(by)) => format!("the readings lack {}", quantity(by)),
        (WhyNot::NoColumn, None) => "a quantity that it needs was not recorded".to_owned(),
        (WhyNot::Bound, _) => {
            "only sizes beyond what is physically possible would be detected".to_owned()
        }
        (WhyNot::NoTrace, Some(by)) => format!("too few of the readings vary the {}", column(by)),
        (WhyNot::NoTrace, None) => "nothing in these readings would show it".to_owned(),
    }
}

/// A part of the law, as the table of alternatives calls it.
pub fn part(part: &str) -> String {
    effect(part)
}

/// Models by id: who made them, and what they are called in every table, legend and sentence.
const MODELS: [(&str, &str, &str); 10] = [
    (NEW, "New", "New model, fitted"),
    (LEAST_SQUARES, "New", "New model, least squares"),
    ("new_published", "New", "New model, published"),
    ("knee_paper", "Knee paper", "Earlier form (knee paper)"),
    ("chou_hannaford", "Chou", "Chou and Hannaford 1996"),
    ("festo_tool", "Festo", "Festo tool"),
    ("hunt2017", "Hunt", "Hunt 2017"),
    ("martens2017", "Martens", "Martens and Boblan 2017"),
    ("sarosi2012", "Sarosi", "Sarosi 2012"),
    ("tondu_lopez", "Tondu", "Tondu and Lopez 2000"),
];

/// What a model is called; its title where it has no shorter name.
pub fn model_name<'a>(id: &str, title: &'a str) -> &'a str {
    MODELS.iter().find(|m| m.0 == id).map_or(title, |m| m.2)
}

/// The first of a model's authors, or its maker; its title where nobody is known.
pub fn model_author<'a>(id: &str, title: &'a str) -> &'a str {
    MODELS.iter().find(|m| m.0 == id).map_or(title, |m| m.1)
}

/// The readings on which a model is judged; those of a split are unseen where the model was fitted to others.
pub fn split(id: &str) -> &str {
    match id {
        "train" => "fitted",
        "loso" => "unseen specimens",
        "validation" => "validation sessions",
        "holdout" => "held-out sessions",
        "rows_train" => "by row, fitted",
        "rows_validation" => "by row, unseen",
        "common" => "common, unseen",
        other => other,
    }
}

/// A robust loss as a sentence calls it, by the name that the configuration has for it.
pub fn loss(id: &str) -> &str {
    match id {
        "huber" => "Huber's robust loss",
        "least_squares" => "ordinary least squares",
        "lar" => "least absolute residuals",
        "bisquare" => "Tukey's bisquare loss",
        "cauchy" => "Cauchy's loss",
        other => other,
    }
}

/// A set of statistics or a method of intervals in a table, by the name that data files have for it.
pub fn statistics(id: &str) -> &str {
    match id {
        "honest" => "residuals",
        "LAR-compatible" => "LAR\u{a0}print",
        other => other,
    }
}

/// A human muscle by its name in OpenSim's models.
pub fn muscle(id: &str) -> &str {
    match id {
        "bifemsh" => "biceps femoris, short head",
        "vas_int" => "vastus intermedius",
        "vas_lat" => "vastus lateralis",
        "vas_med" => "vastus medialis",
        other => other,
    }
}

/// A route by its id: the muscle, or the words of the id, `flexor, 10 mm`.
pub fn route(id: &str) -> String {
    let words = |word: &str| match word.strip_suffix("mm") {
        Some(size) if size.parse::<u32>().is_ok() => format!("{size}\u{a0}mm"),
        _ => word.to_owned(),
    };
    match muscle(id) {
        same if same == id => id.split('_').map(words).collect::<Vec<_>>().join(", "),
        known => known.to_owned(),
    }
}

/// A knee by its id.
pub fn knee(id: &str) -> &str {
    match id {
        "gait2392" => "OpenSim Gait2392",
        other => other,
    }
}

/// Where the zero of a force channel is from.
pub fn zero_source(source: ZeroSource) -> &'static str {
    match source {
        ZeroSource::ZeroLog => "zero log",
        ZeroSource::Slack => "slack state",
        ZeroSource::ClippedZeroLog => "clipped zero log",
        ZeroSource::None => "none",
    }
}

/// Words as a sentence lists them: `a, b and c`.
pub fn listed<S: AsRef<str>>(words: &[S]) -> String {
    let words: Vec<&str> = words.iter().map(AsRef::as_ref).collect();
    match words.as_slice() {
        [] => String::new(),
        [only] => (*only).to_owned(),
        [others @ .., last] => format!("{} and {last}", others.join(", ")),
    }
}

/// What became of a coefficient, for a remark beside its value.
pub fn coefficient_state(state: &CoefficientState) -> String {
    match state {
        CoefficientState::Ok => "ok".to_owned(),
        CoefficientState::Unmoved => "unmoved".to_owned(),
        CoefficientState::AtLowerBound => "at its lower bound".to_owned(),
        CoefficientState::AtUpperBound => "at its upper bound".to_owned(),
        CoefficientState::NotIdentified => "not identified".to_owned(),
        CoefficientState::Held => "held: not determined by these specimens".to_owned(),
        CoefficientState::OpenWithout(id) => format!("interval open: not determined without {id}"),
    }
}

/// A text with a capital at its beginning.
pub fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| {
        first.to_uppercase().chain(letters).collect()
    })
}

/// A text that goes on behind a colon.
pub fn uncapitalised(text: &str) -> String {
    let mut letters = text.chars();
    let first = letters.next().map(char::to_lowercase);
    first.into_iter().flatten().chain(letters).collect()
}
