//! Campaigns on which the residual search is tried: what was put in, and the truth file that does it.
//!
//! Every campaign has 24 sessions, six specimens at four contractions, of which nothing in its `session.toml` tells the effect; two more
//! specimens are held out, so that the error can be compared with that of the generating model. Strengths scatter by 2%, the
//! zero of the force channel wanders and is declared by zero logs, sensors are noisy and quantised.

use super::truth::{Truth, read_truth};

/// How large an effect is put in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Size {
    /// Seen at a second look.
    Medium,
    /// Seen at once.
    Large,
}

/// One kind of trial.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    /// Id of the effect, or what else the campaign is to show.
    pub id: &'static str,
    /// A word for the variant.
    pub form: &'static str,
    /// How it is measured.
    pub design: Design,
    /// The `[[effect]]` table at either size, the number written `{}`; empty for none.
    pub effect: &'static str,
    /// The number, medium and large.
    pub sizes: [f64; 2],
}

/// How the campaign is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Design {
    /// Logs over time on the 10 mm rig, each a staircase up and down.
    Staircase,
    /// Points up and down, each held and read three times.
    Dwell,
    /// Points read in passing, at three rates.
    Ramp,
    /// Points by hand, one direction.
    ByHand,
}

const fn case(
    id: &'static str,
    form: &'static str,
    design: Design,
    effect: &'static str,
    sizes: [f64; 2],
) -> Case {
    Case {
        id,
        form,
        design,
        effect,
        sizes,
    }
}

use Design::{ByHand, Dwell, Ramp, Staircase};

/// One effect, in the plain form of the library.
pub const SINGLE: &[Case] = &[
    case(
        "force_zero_offset",
        "constant",
        Staircase,
        "id = \"force_zero_offset\"\nzero_n = {}",
        [4.0, 10.0],
    ),
    case(
        "force_zero_offset",
        "each session",
        ByHand,
        "id = \"force_zero_offset\"\nsd = {}\nper = \"session\"",
        [4.0, 10.0],
    ),
    case(
        "force_gain",
        "from a session on",
        Staircase,
        "id = \"force_gain\"\ngain = {}\nfrom_session = 12",
        [1.05, 1.12],
    ),
    case(
        "force_gain",
        "each session",
        Staircase,
        "id = \"force_gain\"\ngain = 1\nsd = {}\nper = \"session\"",
        [0.04, 0.1],
    ),
    case(
        "force_drift",
        "linear",
        Staircase,
        "id = \"force_drift\"\nn_per_s = {}",
        [0.2, 0.5],
    ),
    case(
        "force_drift",
        "campaign",
        Staircase,
        "id = \"force_drift\"\nform = \"campaign\"\nn_per_session = {}",
        [0.4, 1.0],
    ),
    case(
        "pressure_zero_offset",
        "constant",
        Staircase,
        "id = \"pressure_zero_offset\"\nzero_kpa = {}",
        [8.0, 20.0],
    ),
    case(
        "pressure_gain",
        "from a session on",
        Staircase,
        "id = \"pressure_gain\"\ngain = {}\nfrom_session = 12",
        [1.04, 1.1],
    ),
    case(
        "temperature",
        "linear",
        Staircase,
        "id = \"temperature\"\nk_per_c = {}",
        [-0.005, -0.012],
    ),
    case(
        "length_offset",
        "constant",
        Staircase,
        "id = \"length_offset\"\noffset_mm = {}",
        [1.0, 3.0],
    ),
    case(
        "length_offset",
        "one specimen",
        Staircase,
        "id = \"length_offset\"\noffset_mm = {}\nspecimen = \"t-l257\"",
        [2.0, 5.0],
    ),
    case(
        "series_compliance",
        "linear",
        Staircase,
        "id = \"series_compliance\"\nc_um_per_n = {}",
        [4.0, 10.0],
    ),
    case(
        "misalignment",
        "from a session on",
        Staircase,
        "id = \"misalignment\"\nangle_deg = {}\nfrom_session = 12",
        [15.0, 25.0],
    ),
    case(
        "bladder_threshold",
        "sharp",
        Staircase,
        "id = \"bladder_threshold\"\nthreshold_kpa = {}",
        [12.0, 30.0],
    ),
    case(
        "hysteresis",
        "constant",
        Staircase,
        "id = \"hysteresis\"\nhalf_width_n = {}",
        [2.0, 6.0],
    ),
    case(
        "creep",
        "logarithm",
        Dwell,
        "id = \"creep\"\nk = {}",
        [-0.006, -0.015],
    ),
    case(
        "conditioning",
        "exponential",
        Staircase,
        "id = \"conditioning\"\nk = {}",
        [0.08, 0.2],
    ),
    case(
        "rate_dependence",
        "linear",
        Ramp,
        "id = \"rate_dependence\"\nn_s_per_kpa = {}",
        [0.05, 0.15],
    ),
    case(
        "specimen_variation",
        "normal",
        Staircase,
        "id = \"specimen_variation\"\nsd = {}\nper = \"specimen\"",
        [0.08, 0.15],
    ),
];

/// The same effects in forms that differ from the library's.
pub const OTHER_FORMS: &[Case] = &[
    case(
        "force_zero_offset",
        "wandering",
        Staircase,
        "id = \"force_zero_offset\"\nform = \"wandering\"\nzero_n = {}",
        [4.0, 10.0],
    ),
    case(
        "force_gain",
        "curved",
        Staircase,
        "id = \"force_gain\"\nform = \"curved\"\ngain = {}\nfrom_session = 12",
        [1.05, 1.12],
    ),
    case(
        "force_drift",
        "saturating",
        Staircase,
        "id = \"force_drift\"\nform = \"saturating\"\nn_per_s = {}",
        [0.3, 0.8],
    ),
    case(
        "pressure_zero_offset",
        "gained",
        Staircase,
        "id = \"pressure_zero_offset\"\nform = \"gained\"\nzero_kpa = {}",
        [8.0, 20.0],
    ),
    case(
        "pressure_gain",
        "curved",
        Staircase,
        "id = \"pressure_gain\"\nform = \"curved\"\ngain = {}\nfrom_session = 12",
        [1.04, 1.1],
    ),
    case(
        "temperature",
        "quadratic",
        Staircase,
        "id = \"temperature\"\nform = \"quadratic\"\nk_per_c = {}",
        [-0.005, -0.012],
    ),
    case(
        "length_offset",
        "growing",
        Staircase,
        "id = \"length_offset\"\nform = \"growing\"\noffset_mm = {}",
        [1.0, 3.0],
    ),
    case(
        "series_compliance",
        "stiffening",
        Staircase,
        "id = \"series_compliance\"\nform = \"stiffening\"\nc_um_per_n = {}",
        [6.0, 12.0],
    ),
    case(
        "misalignment",
        "turning",
        Staircase,
        "id = \"misalignment\"\nform = \"turning\"\nangle_deg = {}\nfrom_session = 12",
        [15.0, 25.0],
    ),
    case(
        "bladder_threshold",
        "smooth",
        Staircase,
        "id = \"bladder_threshold\"\nform = \"smooth\"\nthreshold_kpa = {}",
        [12.0, 30.0],
    ),
    case(
        "hysteresis",
        "proportional",
        Staircase,
        "id = \"hysteresis\"\nform = \"proportional\"\nhalf_width_n_per_kpa = {}",
        [0.008, 0.02],
    ),
    case(
        "hysteresis",
        "play",
        Staircase,
        "id = \"hysteresis\"\nform = \"play\"\nhalf_width_kpa = {}",
        [5.0, 12.0],
    ),
    case(
        "creep",
        "stretched",
        Dwell,
        "id = \"creep\"\nform = \"stretched\"\nk = {}",
        [-0.03, -0.08],
    ),
    case(
        "conditioning",
        "power",
        Staircase,
        "id = \"conditioning\"\nform = \"power\"\nk = {}",
        [0.08, 0.2],
    ),
    case(
        "rate_dependence",
        "square_root",
        Ramp,
        "id = \"rate_dependence\"\nform = \"square_root\"\nn_s_per_kpa = {}",
        [0.05, 0.15],
    ),
    case(
        "rate_dependence",
        "saturating",
        Ramp,
        "id = \"rate_dependence\"\nform = \"saturating\"\nn_s_per_kpa = {}",
        [0.05, 0.15],
    ),
    case(
        "specimen_variation",
        "two_batch",
        Staircase,
        "id = \"specimen_variation\"\nform = \"two_batch\"\nsd = {}\nper = \"specimen\"",
        [0.08, 0.15],
    ),
];

/// Effects outside the library: the id is the column that the search has to name.
pub const OUTSIDE: &[Case] = &[
    case(
        "humidity",
        "gain",
        Staircase,
        "id = \"humidity\"\nform = \"gain\"\nk_per_percent = {}",
        [0.002, 0.005],
    ),
    case(
        "humidity",
        "offset",
        Staircase,
        "id = \"humidity\"\nform = \"offset\"\nn_per_percent = {}",
        [0.3, 0.8],
    ),
    case(
        "age_days",
        "gain",
        Staircase,
        "id = \"age\"\nform = \"gain\"\nk_per_day = {}",
        [-0.002, -0.005],
    ),
    case(
        "force_n",
        "quadratic",
        Staircase,
        "id = \"sensor_curvature\"\nform = \"quadratic\"\nq = {}",
        [0.08, 0.2],
    ),
    case(
        "force_n",
        "cubic",
        Staircase,
        "id = \"sensor_curvature\"\nform = \"cubic\"\nq = {}",
        [0.1, 0.25],
    ),
];

/// No effect.
pub const NULL: Case = case("none", "", Staircase, "", [0.0, 0.0]);

impl Case {
    /// The `[[effect]]` table at a size.
    pub fn table(&self, size: Size) -> String {
        if self.effect.is_empty() {
            return String::new();
        }
        let number = self.sizes[size as usize];
        format!(
            "[[effect]]\n{}\n",
            self.effect.replace("{}", &number.to_string())
        )
    }

    /// The number at a size.
    pub fn number(&self, size: Size) -> f64 {
        self.sizes[size as usize]
    }
}

/// A campaign with these effect tables.
///
/// # Panics
/// If the tables are no truth file's; they are constants of this program.
pub fn truth(design: Design, effects: &str, seed: u64) -> Truth {
    let text = text(design, effects, seed);
    match read_truth("trial", &text) {
        Ok(truth) => truth,
        Err(mistakes) => {
            let list: Vec<String> = mistakes.iter().map(ToString::to_string).collect();
            panic!("a trial's truth is wrong: {}\n{text}", list.join("\n"))
        }
    }
}

fn text(design: Design, effects: &str, seed: u64) -> String {
    let measured = match design {
        Design::Staircase => "sampling = \"timeseries\"\nruns = [1, 2, 3]\n",
        Design::Dwell => {
            "sampling = \"points\"\nruns = [1, 2]\npressures_kpa = [50, 100, 200, 300, 400, 500, 620]\ndirections = \"up-down\"\n\
             dwell_s = [2, 20, 120]\n"
        }
        Design::Ramp => {
            "sampling = \"points\"\nruns = [1, 2, 3]\npressures_kpa = [50, 100, 200, 300, 400, 500, 600]\ndirections = \"up-down\"\n\
             ramp_kpa_per_s = [5, 20, 60]\n"
        }
        Design::ByHand => {
            "sampling = \"points\"\nruns = [1, 2, 3]\npressures_kpa = [50, 100, 150, 200, 250, 300, 350, 400, 450, 500, 550, 600]\n"
        }
    };
    let lengths = [
        (112, 0.161, ""),
        (152, 0.163, ""),
        (182, 0.165, ""),
        (257, 0.172, ""),
        (361, 0.175, ""),
        (455, 0.167, ""),
        (135, 0.162, "holdout"),
        (300, 0.171, "holdout"),
    ];
    let specimens: String = lengths
        .iter()
        .map(|(l, eps, role)| {
            let role = if role.is_empty() { String::new() } else { format!("role = \"{role}\"\n") };
            format!("[[specimen]]\nid = \"t-l{l}\"\nrest_length_mm = {l}\ncontraction_max = {eps}\n{role}\n")
        })
        .collect();
    format!(
        "schema = \"bpa-truth/1\"\ncampaign = \"trial\"\nseed = {seed}\ndiameter_mm = 10\ncoefficients = \"published\"\n\
         contractions = [0, 0.25, 0.5, 0.75]\norder = \"shuffled\"\nfirst_date = \"2026-01-05\"\ndays_between = 1\n{measured}\n{specimens}\n\
         [[column]]\nname = \"temperature_c\"\nmean = 21\nsd_session = 2\ndrift = 0.2\nsd_row = 0.05\n\n\
         [[column]]\nname = \"humidity\"\nmean = 45\nsd_session = 8\nsd_row = 0.3\n\n\
         [[column]]\nname = \"age_days\"\nmean = 30\nsd_specimen = 12\nper_session = 1\n\n{effects}"
    )
}
