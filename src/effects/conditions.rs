//! What is known of one reading, as far as an effect may depend on it.

/// Contraction about which friction sets in. On the laboratory's rig loops of 8 N at contractions of 4% and more have less than 1 N at none; nothing
/// was measured between.
const SLIDES_FROM: f64 = 0.01;

/// A quantity that not every campaign has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Need {
    /// Whether the actuator was being filled or vented.
    Direction,
    /// Fillings of a set length after its first.
    LaterFillings,
    /// Time in the log.
    LogTime,
    /// Time of the session in the campaign.
    CampaignTime,
    /// Time since the last step of pressure or length.
    SinceStep,
    /// Rate of the pressure.
    Rate,
    /// Temperature.
    Temperature,
    /// Cycles that the specimen has done.
    Cycles,
    /// More than one resting length.
    RestLengths,
    /// A base law whose dependence on the resting length is not fitted: a fitted one is all that a handful of resting lengths can tell.
    LengthLaw,
    /// Zeros of the force channel, of which some stand out from the others.
    Zeros,
}

impl Need {
    /// All.
    pub const ALL: [Need; 11] = [
        Need::Direction,
        Need::LaterFillings,
        Need::LogTime,
        Need::CampaignTime,
        Need::SinceStep,
        Need::Rate,
        Need::Temperature,
        Need::Cycles,
        Need::RestLengths,
        Need::LengthLaw,
        Need::Zeros,
    ];

    /// Name in files.
    pub fn id(self) -> &'static str {
        match self {
            Need::Direction => "direction",
            Need::LaterFillings => "later_fillings",
            Need::LogTime => "log_time",
            Need::CampaignTime => "campaign_time",
            Need::SinceStep => "since_step",
            Need::Rate => "pressure_rate",
            Need::Temperature => "temperature",
            Need::Cycles => "cycles",
            Need::RestLengths => "rest_lengths",
            Need::LengthLaw => "length_law",
            Need::Zeros => "zeros",
        }
    }

    /// What a campaign lacks without it.
    pub fn text(self) -> &'static str {
        match self {
            Need::Direction => "readings both while filling and while venting",
            Need::LaterFillings => "a second filling at one set length",
            Need::LogTime => "the time within a log",
            Need::CampaignTime => "the order of the sessions in time (dates)",
            Need::SinceStep => "different times since the last step",
            Need::Rate => "different rates of the pressure",
            Need::Temperature => "a temperature column that varies",
            Need::Cycles => "the number of cycles of each specimen",
            Need::RestLengths => "more than one resting length",
            Need::LengthLaw => "a base law without a fitted dependence on the resting length",
            Need::Zeros => "zeros of the force channel that stand out from the others",
        }
    }
}

/// Along what the size of an effect may change: the quantity in which its equation could be bent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Argument {
    /// The force, as predicted.
    Force,
    /// The pressure.
    Pressure,
    /// (l_rest - l)/l_rest.
    Contraction,
    /// The resting length.
    RestLength,
    /// Time since the last step of pressure or length.
    SinceStep,
    /// Time in the log.
    LogTime,
    /// Place of the session in time.
    CampaignTime,
    /// Cycles done.
    Cycles,
    /// Temperature less the campaign's mean.
    Temperature,
    /// Rate of the pressure.
    Rate,
}

impl Argument {
    /// Name in files.
    pub fn id(self) -> &'static str {
        match self {
            Argument::Force => "force_n",
            Argument::Pressure => "pressure_kpa",
            Argument::Contraction => "contraction",
            Argument::RestLength => "rest_length_m",
            Argument::SinceStep => "since_step_s",
            Argument::LogTime => "time_s",
            Argument::CampaignTime => "session_order",
            Argument::Cycles => "cycles",
            Argument::Temperature => "temperature_less_mean",
            Argument::Rate => "pressure_rate",
        }
    }

    /// Unit.
    pub fn unit(self) -> &'static str {
        match self {
            Argument::Force => "N",
            Argument::Pressure => "kPa",
            Argument::RestLength => "m",
            Argument::SinceStep | Argument::LogTime => "s",
            Argument::Temperature => "K",
            Argument::Rate => "kPa/s",
            Argument::Contraction | Argument::CampaignTime | Argument::Cycles => "1",
        }
    }

    /// Its value at a reading with this force.
    pub fn of(self, at: &Conditions, force_n: f64) -> f64 {
        match self {
            Argument::Force => force_n,
            Argument::Pressure => at.pressure_kpa,
            Argument::Contraction => (at.rest_length_m - at.length_m) / at.rest_length_m,
            Argument::RestLength => at.rest_length_m,
            Argument::SinceStep => at.since_step_s,
            Argument::LogTime => at.log_time_s,
            Argument::CampaignTime => at.campaign_time,
            Argument::Cycles => at.cycles,
            Argument::Temperature => at.temperature_c,
            Argument::Rate => at.rate_kpa_per_s,
        }
    }

    /// The scale on which effects change evenly along it: times and cycles run over decades, from 0.
    pub fn scaled(self, x: f64) -> f64 {
        match self {
            Argument::SinceStep | Argument::Cycles => libm::log1p(x.max(0.0)),
            _ => x,
        }
    }

    /// Back from [`Self::scaled`].
    pub fn unscaled(self, x: f64) -> f64 {
        match self {
            Argument::SinceStep | Argument::Cycles => libm::expm1(x),
            _ => x,
        }
    }
}

/// One reading. A quantity that is not known is 0, so that its effects leave no trace.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conditions {
    /// Gauge pressure as read, kPa.
    pub pressure_kpa: f64,
    /// Length as set, m.
    pub length_m: f64,
    /// l_rest, m.
    pub rest_length_m: f64,
    /// l_620, m.
    pub contracted_length_m: f64,
    /// Uninflated inner diameter, mm.
    pub diameter_mm: f64,
    /// Middle of the campaign's resting lengths, m.
    pub middle_rest_length_m: f64,
    /// +1 filling, -1 venting, 0 unknown.
    pub direction: f64,
    /// +1 after a rise of the pressure in the log, -1 after a fall, 0 where it has not moved yet or nobody knows: a reading that begins a filling of
    /// a vented actuator has not been filled.
    pub moved: f64,
    /// Highest pressure of the log, kPa.
    pub highest_kpa: f64,
    /// Whether this is the first filling since the length was set.
    pub first_filling: bool,
    /// Time in the log, s.
    pub log_time_s: f64,
    /// Place of the session in time, from 0 for the campaign's first to 1 for its last.
    pub campaign_time: f64,
    /// Time since the last step of pressure or length, s.
    pub since_step_s: f64,
    /// Rate of the pressure, kPa/s.
    pub rate_kpa_per_s: f64,
    /// Temperature less the campaign's mean, degrees.
    pub temperature_c: f64,
    /// Cycles before this reading.
    pub cycles: f64,
    /// Zero of the force channel that was taken off, less the median of the campaign's sessions, N.
    pub zero_force_n: f64,
    /// Whether it is known that the actuator pulls by more than friction does: what a model says of the tension then limits no friction.
    pub pulls: bool,
}

impl Conditions {
    /// A set point without a history.
    pub fn at(
        rest_length_m: f64,
        contracted_length_m: f64,
        length_m: f64,
        pressure_kpa: f64,
    ) -> Self {
        Self {
            pressure_kpa,
            length_m,
            rest_length_m,
            contracted_length_m,
            diameter_mm: f64::NAN,
            middle_rest_length_m: rest_length_m,
            direction: 0.0,
            moved: 0.0,
            highest_kpa: pressure_kpa,
            first_filling: false,
            log_time_s: 0.0,
            campaign_time: 0.0,
            since_step_s: 0.0,
            rate_kpa_per_s: 0.0,
            temperature_c: 0.0,
            cycles: 0.0,
            zero_force_n: 0.0,
            pulls: false,
        }
    }

    /// How far the braid slides over the bladder between slack and this reading, from 0 at resting length to 1 where it is shortened: there is no
    /// friction between parts that do not move against each other.
    pub fn sliding(&self) -> f64 {
        let x = (self.rest_length_m - self.length_m) / self.rest_length_m / SLIDES_FROM;
        x * x / (x * x + 1.0)
    }
}
