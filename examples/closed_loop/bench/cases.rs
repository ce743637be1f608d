//! What is put in: effects in the library's form, in other forms, and outside the library; and how a size of the findings becomes one of the
//! simulator.

use pipeline::effects;
use pipeline::simulate::rig_like::{Family, Pace, Put};

/// One effect that is put in.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    /// Id of the simulator's effect; that of the library where it has one.
    pub id: &'static str,
    /// The simulator's form.
    pub form: &'static str,
    /// Other numbers of the form.
    pub others: &'static [f64],
    /// How the campaign is measured: so that the effect can show.
    pub pace: Pace,
    /// It acts from this part of the campaign on.
    pub from: f64,
    /// The form of the library that has the same equation; of another form, the one whose detection limit is taken. Outside the library the
    /// shape of a dependence on the column.
    pub plain: &'static str,
    /// The simulator's form with the equation of `plain`; empty for the first. The plain form of a drift or a hysteresis is the first of the
    /// simulator's, as it is of the library's.
    pub line: &'static str,
    /// Outside the library, the simulator's amplitude for a slope of 1 of `line`.
    pub of_slope: f64,
    /// The simulator's size for an amplitude of 1 of the findings.
    pub scale: Scale,
    /// Amplitudes below 0 are possible, and half of the campaigns have one.
    pub both_signs: bool,
    /// Largest amplitude, in the findings' unit: beyond it the set-up would be absurd.
    pub most: f64,
}

/// The simulator's size for an amplitude of the findings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Scale {
    /// The same number.
    Same,
    /// Of the other sign.
    Negative,
    /// A gain: 1 and the amplitude.
    Gain,
    /// The findings count from the first session to the last, the simulator a session.
    PerSession,
}

impl Case {
    const fn new(id: &'static str, form: &'static str, plain: &'static str, most: f64) -> Self {
        Self {
            id,
            form,
            others: &[],
            pace: Pace::Staircase,
            from: 0.0,
            plain,
            line: "",
            of_slope: 1.0,
            scale: Scale::Same,
            both_signs: true,
            most,
        }
    }

    const fn positive(self) -> Self {
        Self {
            both_signs: false,
            ..self
        }
    }

    /// A gain or angle of all readings hides in F_620: it has to begin somewhere.
    const fn acting_from_the_middle(self, scale: Scale) -> Self {
        Self {
            from: 0.5,
            scale,
            ..self
        }
    }

    const fn line(self, line: &'static str, of_slope: f64) -> Self {
        Self {
            line,
            of_slope,
            ..self
        }
    }

    /// Whether it has the equation of `line`.
    pub fn is_line(&self) -> bool {
        self.form == self.line
    }

    const fn scaled(self, scale: Scale) -> Self {
        Self { scale, ..self }
    }

    const fn at(self, pace: Pace) -> Self {
        Self { pace, ..self }
    }

    const fn with(self, others: &'static [f64]) -> Self {
        Self { others, ..self }
    }

    /// Name in the table and the log.
    pub fn name(&self) -> String {
        let numbers: Vec<String> = self.others.iter().map(f64::to_string).collect();
        format!("{} {} {}", self.id, self.form, numbers.join(","))
            .trim_end()
            .to_owned()
    }

    /// The effect at an amplitude of the findings, in a campaign of so many sessions.
    pub fn put(&self, amplitude: f64, sessions: usize) -> Put {
        let size = match self.scale {
            Scale::Same => amplitude,
            Scale::Negative => -amplitude,
            Scale::Gain => 1.0 + amplitude,
            Scale::PerSession => amplitude / (sessions - 1) as f64,
        };
        Put {
            id: self.id,
            form: self.form,
            size,
            others: self.others,
            from: self.from,
        }
    }

    /// What the findings report where the amplitude is 0: 1 for a gain.
    pub fn absent(&self) -> f64 {
        let form = effects::index(self.id).map(|k| effects::all()[k].forms()[0]);
        form.map_or(0.0, |f| f.amplitude.absent)
    }
}

const GAIN: Scale = Scale::Gain;
const SAME: Scale = Scale::Same;
/// The library's form of a braid that slides.
const SLIDING: &str = "sliding, closed at the top";

/// One effect in the library's own form. Left out are those that the base `new` cannot show: `specimen_variation` is scatter, a
/// `force_gain` of all readings hides in F_620, `rest_length_scaling` is part of the law.
pub const SINGLE: &[Case] = &[
    Case::new("force_zero_offset", "constant", "constant", 40.0),
    Case::new("force_gain", "constant", "gain", 0.4).acting_from_the_middle(GAIN),
    Case::new("force_drift", "linear", "within a log", 2.0),
    Case::new("force_drift", "campaign", "along the campaign", 60.0).scaled(Scale::PerSession),
    Case::new("pressure_zero_offset", "constant", "constant", 45.0),
    Case::new("pressure_gain", "constant", "gain", 0.3).acting_from_the_middle(GAIN),
    Case::new("temperature", "linear", "linear", 0.08),
    Case::new("length_offset", "constant", "constant", 8.0),
    Case::new("series_compliance", "linear", "linear", 80.0).positive(),
    Case::new("misalignment", "constant", "constant angle", 40.0)
        .acting_from_the_middle(SAME)
        .positive(),
    Case::new("bladder_threshold", "sharp", "sharp", 150.0).positive(),
    Case::new("hysteresis", "constant", "constant", 60.0),
    Case::new("creep", "logarithm", "logarithmic", 0.15).at(Pace::Dwell),
    Case::new("conditioning", "exponential", "exponential", 0.45).positive(),
    Case::new("rate_dependence", "linear", "linear", 2.0)
        .scaled(Scale::Negative)
        .at(Pace::Ramp),
];

/// Forms that differ from the library's, to design with.
const OTHER_FORMS_DESIGN: &[Case] = &[
    Case::new("force_zero_offset", "wandering", "constant", 40.0),
    Case::new("force_gain", "curved", "gain", 0.4).acting_from_the_middle(GAIN),
    Case::new("force_drift", "saturating", "within a log", 4.0),
    Case::new("pressure_zero_offset", "gained", "constant", 45.0),
    Case::new("pressure_gain", "curved", "gain", 0.3).acting_from_the_middle(GAIN),
    Case::new("temperature", "quadratic", "linear", 0.08),
    Case::new("length_offset", "growing", "constant", 8.0),
    Case::new("series_compliance", "stiffening", "linear", 160.0).positive(),
    Case::new("misalignment", "turning", "constant angle", 40.0)
        .acting_from_the_middle(SAME)
        .positive(),
    Case::new("bladder_threshold", "smooth", "sharp", 150.0).positive(),
    Case::new("hysteresis", "play", "constant", 60.0).positive(),
    Case::new("creep", "stretched", "logarithmic", 0.3).at(Pace::Dwell),
    Case::new("conditioning", "power", "exponential", 0.45).positive(),
    Case::new("rate_dependence", "square_root", "linear", 2.0)
        .scaled(Scale::Negative)
        .at(Pace::Ramp),
    Case::new("hysteresis", "sliding", SLIDING, 60.0).positive(),
    Case::new("conditioning", "first_filling", "first filling", 60.0).positive(),
];

/// Forms that differ from the library's and from those designed with, for the published table.
const OTHER_FORMS_PUBLISHED: &[Case] = &[
    Case::new("force_zero_offset", "wandering", "constant", 40.0).with(&[7.0]),
    Case::new("force_gain", "curved", "gain", 0.4)
        .acting_from_the_middle(GAIN)
        .with(&[-0.5]),
    Case::new("force_drift", "saturating", "within a log", 4.0).with(&[18.0]),
    Case::new("pressure_zero_offset", "gained", "constant", 45.0).with(&[-0.5]),
    Case::new("pressure_gain", "curved", "gain", 0.3)
        .acting_from_the_middle(GAIN)
        .with(&[-0.5]),
    Case::new("temperature", "quadratic", "linear", 0.08).with(&[20.0, -0.07]),
    Case::new("length_offset", "growing", "constant", 8.0).with(&[1.8]),
    Case::new("series_compliance", "stiffening", "linear", 160.0)
        .positive()
        .with(&[250.0]),
    Case::new("misalignment", "turning", "constant angle", 40.0)
        .acting_from_the_middle(SAME)
        .positive()
        .with(&[0.5]),
    Case::new("bladder_threshold", "smooth", "sharp", 150.0)
        .positive()
        .with(&[18.0]),
    Case::new("hysteresis", "proportional", "constant", 60.0),
    Case::new("creep", "stretched", "logarithmic", 0.3)
        .at(Pace::Dwell)
        .with(&[30.0, 0.4]),
    Case::new("conditioning", "power", "exponential", 0.45)
        .positive()
        .with(&[3.0, 0.7]),
    Case::new("rate_dependence", "saturating", "linear", 4.0)
        .scaled(Scale::Negative)
        .at(Pace::Ramp)
        .with(&[40.0]),
    Case::new("hysteresis", "sliding", SLIDING, 60.0)
        .positive()
        .with(&[90.0]),
    Case::new("conditioning", "first_filling", "first filling", 60.0).positive(),
];

/// Full scale of the simulator's force sensor where a case does not state it.
const FULL_SCALE_N: f64 = 500.0;

/// Effects outside the library, to design with.
const OUTSIDE_DESIGN: &[Case] = &[
    Case::new("humidity", "gain", "gain", 0.05).line("gain", 1.0),
    Case::new("humidity", "offset", "offset", 8.0).line("offset", 1.0),
    Case::new("age", "gain", "gain", 0.03).line("gain", 1.0),
    Case::new("sensor_curvature", "quadratic", "gain", 0.6).line("quadratic", FULL_SCALE_N),
    Case::new("sensor_curvature", "cubic", "gain", 0.6).line("quadratic", FULL_SCALE_N),
];

/// Effects outside the library for the published table.
const OUTSIDE_PUBLISHED: &[Case] = &[
    Case::new("humidity", "gain", "gain", 0.05)
        .with(&[55.0])
        .line("gain", 1.0),
    Case::new("humidity", "offset", "offset", 8.0)
        .with(&[55.0])
        .line("offset", 1.0),
    Case::new("age", "saturating", "gain", 0.05)
        .with(&[45.0])
        .line("gain", 1.0),
    Case::new("sensor_curvature", "quadratic", "gain", 0.6)
        .with(&[400.0])
        .line("quadratic", 400.0),
    Case::new("sensor_curvature", "cubic", "gain", 0.6)
        .with(&[400.0])
        .line("quadratic", FULL_SCALE_N),
];

/// Forms that differ from the library's.
pub fn other_forms(family: Family) -> &'static [Case] {
    match family {
        Family::Design => OTHER_FORMS_DESIGN,
        Family::Published => OTHER_FORMS_PUBLISHED,
    }
}

/// Effects outside the library.
pub fn outside(family: Family) -> &'static [Case] {
    match family {
        Family::Design => OUTSIDE_DESIGN,
        Family::Published => OUTSIDE_PUBLISHED,
    }
}

/// The column that is right for an effect outside the library: words with which its name may begin.
pub fn right_columns(id: &str) -> &'static [&'static str] {
    match id {
        "humidity" => &["humidity"],
        "age" => &["age"],
        "sensor_curvature" => &["force", "predicted"],
        _ => &[],
    }
}

/// Effects of which two are put in together: all that a staircase shows, and no two of one nature.
pub fn pairs() -> Vec<[Case; 2]> {
    let shown: Vec<Case> = SINGLE
        .iter()
        .copied()
        .filter(|c| c.pace == Pace::Staircase)
        .collect();
    let mut list = Vec::new();
    for (k, first) in shown.iter().enumerate() {
        for second in &shown[k + 1..] {
            if !alike(first.id, second.id) {
                // Two that begin somewhere begin at different places.
                let second = Case {
                    from: if second.from > 0.0 && first.from > 0.0 {
                        0.3
                    } else {
                        second.from
                    },
                    ..*second
                };
                list.push([*first, second]);
            }
        }
    }
    list
}

/// Whether two effects are the same to a staircase.
fn alike(a: &str, b: &str) -> bool {
    let sets = [
        ["force_gain", "misalignment"],
        ["pressure_zero_offset", "bladder_threshold"],
    ];
    a == b || sets.iter().any(|s| s.contains(&a) && s.contains(&b))
}
