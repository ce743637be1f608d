//! Specimens and sessions of a campaign, with everything that nobody wrote down.
//!
//! Usual sizes on the laboratory's 10 mm rig; each campaign has its own, within 40% of these:
//!
//! | what | standard deviation |
//! |---|---|
//! | gain of a specimen | 4% |
//! | length set in a session, against the length recorded | 0.8 mm |
//! | resting and contracted length | recorded in whole mm |
//! | zero of the force in a session | 0.6 N |
//! | misfit common to all specimens, over (eps*, P*) | 1.5% of the force, root mean square |
//! | misfit of a session, along the pressure | 2% of the force |
//! | a reading | 2 N |

use super::families::Family;
use super::misfit::Misfit;
use super::{CAMPAIGN, Scatter, Settings};
use crate::coefficients::Coefficients;

/// Relative contractions of the sessions of a specimen.
pub const CONTRACTIONS: [f64; 4] = [0.0, 0.25, 0.5, 0.75];
/// By how much sizes differ from campaign to campaign, either way.
const SPREAD: f64 = 0.4;
/// Fewest and most specimens.
const SPECIMENS: (usize, usize) = (4, 8);
/// Standard deviation of a number that is rounded to 1.
pub const ROUNDING: f64 = 0.288_675_134_594_812_9;

/// Standard deviations of a campaign.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sizes {
    /// Gain of a specimen, as a share.
    pub gain: f64,
    /// Length set less length recorded, of a session, mm.
    pub length_mm: f64,
    /// Resting and contracted length less those recorded, mm.
    pub rounding_mm: f64,
    /// Zero of the force in a session, N.
    pub zero_n: f64,
    /// Misfit common to all, as a share of the force.
    pub common: f64,
    /// Misfit of a session, as a share of the force.
    pub session: f64,
    /// Force of a reading, N.
    pub noise_n: f64,
    /// Pressure of a reading, kPa.
    pub noise_kpa: f64,
}

/// A specimen.
#[derive(Clone, Debug, PartialEq)]
pub struct Muscle {
    /// Id.
    pub id: String,
    /// l_rest as recorded, mm.
    pub rest_mm: f64,
    /// l_620 as recorded, mm.
    pub contracted_mm: f64,
    /// True less recorded, mm.
    pub rest_error_mm: f64,
    /// True less recorded, mm.
    pub contracted_error_mm: f64,
    /// Factor on the force less 1.
    pub gain: f64,
}

/// A session.
#[derive(Clone, Debug, PartialEq)]
pub struct SetUp {
    /// Id.
    pub id: String,
    /// Place of the specimen.
    pub muscle: usize,
    /// eps* as recorded.
    pub contraction_rel: f64,
    /// Length as recorded, mm.
    pub length_mm: f64,
    /// Length set less length recorded, mm.
    pub length_error_mm: f64,
    /// Zero of the force, N.
    pub zero_n: f64,
    /// Weights of the functions of its misfit, of unit variance.
    pub weights: Vec<f64>,
    /// Sessions measured before.
    pub place: usize,
    /// Sessions of the same specimen measured before.
    pub own_place: usize,
    /// Levels of the logged columns [`COLUMNS`].
    pub levels: [f64; 3],
}

/// Columns that every campaign logs, and their change within a log.
pub const COLUMNS: [(&str, f64); 3] =
    [("temperature_c", 0.2), ("humidity", 0.0), ("age_days", 0.0)];

/// A campaign before it is measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawn {
    /// Standard deviations.
    pub sizes: Sizes,
    /// The law, but for its misfit.
    pub law: Coefficients,
    /// The misfit.
    pub misfit: Misfit,
    /// Specimens.
    pub muscles: Vec<Muscle>,
    /// Sessions: specimen by specimen, contractions in their order.
    pub setups: Vec<SetUp>,
}

impl Drawn {
    /// Draws a campaign.
    pub fn new(seed: u64, settings: &Settings) -> Self {
        let family = settings.family;
        let sizes = sizes(seed, family, settings.scatter);
        let misfit = Misfit::new(family, seed);
        let (fewest, most) = SPECIMENS;
        let drawn = fewest + family.stream(seed, &["specimens"]).below(most - fewest + 1);
        let muscles = muscles(seed, family, &sizes, settings.specimens.unwrap_or(drawn));
        let setups = setups(seed, family, &sizes, &misfit, &muscles);
        Self {
            sizes,
            law: law(seed, family),
            misfit,
            muscles,
            setups,
        }
    }
}

fn sizes(seed: u64, family: Family, scatter: Scatter) -> Sizes {
    let mut stream = family.stream(seed, &["sizes"]);
    let mut about = |usual: f64| usual * (1.0 + SPREAD * (2.0 * stream.uniform() - 1.0));
    let rig = Sizes {
        gain: about(0.04),
        length_mm: about(0.8),
        rounding_mm: ROUNDING,
        zero_n: about(0.6),
        common: about(0.015),
        session: about(0.02),
        noise_n: about(2.0),
        noise_kpa: 0.3,
    };
    match scatter {
        Scatter::RigLike => rig,
        Scatter::Clean => Sizes {
            gain: 0.02,
            length_mm: 0.0,
            rounding_mm: 0.0,
            zero_n: 0.0,
            common: 0.0,
            session: 0.0,
            ..rig
        },
    }
}

fn law(seed: u64, family: Family) -> Coefficients {
    let published =
        pipeline_mechanics::models::values(&pipeline_mechanics::models::new::PUBLISHED_10);
    let [b1, b2, l_0, _, _, _, c0, c1, c2] = published;
    let mut stream = family.stream(seed, &["law"]);
    let mut near = |x: f64| x * (1.0 + family.law_scatter() * stream.normal());
    Coefficients {
        b1: near(b1),
        b2: near(b2),
        l_0,
        c: [near(c0), near(c1), near(c2)],
    }
}

/// One specimen from each of `n` equal parts of the range of resting lengths, in ratio.
fn muscles(seed: u64, family: Family, sizes: &Sizes, n: usize) -> Vec<Muscle> {
    let (low, high) = family.rest_lengths_mm();
    let (least, most) = family.contractions_620();
    let one = |k: usize| {
        let mut stream = family.stream(seed, &["muscle", &k.to_string()]);
        let part = (k as f64 + 0.2 + 0.6 * stream.uniform()) / n as f64;
        let rest_mm = (low * libm::pow(high / low, part)).round();
        let contraction = least + (most - least) * stream.uniform();
        let contracted_mm = (rest_mm * (1.0 - contraction)).round();
        let mut rounded = || (stream.uniform() - 0.5) * sizes.rounding_mm / ROUNDING;
        Muscle {
            id: format!("r-l{rest_mm:.0}"),
            rest_mm,
            contracted_mm,
            rest_error_mm: rounded(),
            contracted_error_mm: rounded(),
            gain: sizes.gain * stream.normal(),
        }
    };
    (0..n).map(one).collect()
}

fn setups(
    seed: u64,
    family: Family,
    sizes: &Sizes,
    misfit: &Misfit,
    muscles: &[Muscle],
) -> Vec<SetUp> {
    let places = shuffled(seed, family, muscles.len() * CONTRACTIONS.len());
    let of_muscle = |n: usize| n / CONTRACTIONS.len();
    let one = |number: usize| {
        let (k, contraction_rel) = (of_muscle(number), CONTRACTIONS[number % CONTRACTIONS.len()]);
        let muscle = &muscles[k];
        let id = format!("{CAMPAIGN}-{}-c{:02.0}", muscle.id, 100.0 * contraction_rel);
        let length = muscle.rest_mm - contraction_rel * (muscle.rest_mm - muscle.contracted_mm);
        let mut stream = family.stream(seed, &["session", &k.to_string(), &id]);
        let place = places[number];
        let earlier = |j: &usize| of_muscle(*j) == k && places[*j] < place;
        SetUp {
            muscle: k,
            contraction_rel,
            length_mm: (10.0 * length).round() / 10.0,
            length_error_mm: sizes.length_mm * stream.normal(),
            zero_n: sizes.zero_n * stream.normal(),
            weights: (0..misfit.functions()).map(|_| stream.normal()).collect(),
            place,
            own_place: (0..places.len()).filter(earlier).count(),
            levels: levels(seed, family, k, place, &id),
            id,
        }
    };
    (0..places.len()).map(one).collect()
}

/// Temperature, humidity and age of a session.
fn levels(seed: u64, family: Family, muscle: usize, place: usize, id: &str) -> [f64; 3] {
    let mut own = family.stream(seed, &["columns", id]);
    let mut of_muscle = family.stream(seed, &["age", &muscle.to_string()]);
    [
        21.0 + 2.0 * own.normal(),
        45.0 + 8.0 * own.normal(),
        (40.0 + 12.0 * of_muscle.normal()).max(1.0) + place as f64,
    ]
}

/// The numbers 0 to n - 1 in drawn order.
fn shuffled(seed: u64, family: Family, n: usize) -> Vec<usize> {
    let mut stream = family.stream(seed, &["order"]);
    let mut places: Vec<usize> = (0..n).collect();
    for k in (1..n).rev() {
        places.swap(k, stream.below(k + 1));
    }
    places
}
