//! What is known of one reading, as far as an effect may depend on it.

/// A quantity that not every campaign has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Need {
    /// Whether the actuator was being filled or vented.
    Direction,
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
    /// Zeros of the force channel, of which some stand out from the others.
    Zeros,
}

impl Need {
    /// What a campaign lacks without it.
    pub fn words(self) -> &'static str {
        match self {
            Need::Direction => "the direction of the pressure (filling and venting)",
            Need::LogTime => "the time within a log",
            Need::CampaignTime => "the order of the sessions in time (dates)",
            Need::SinceStep => "different times since the last step",
            Need::Rate => "different rates of the pressure",
            Need::Temperature => "a temperature column that varies",
            Need::Cycles => "the number of cycles of each specimen",
            Need::RestLengths => "more than one resting length",
            Need::Zeros => "zeros of the force channel that stand out from the others",
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
            log_time_s: 0.0,
            campaign_time: 0.0,
            since_step_s: 0.0,
            rate_kpa_per_s: 0.0,
            temperature_c: 0.0,
            cycles: 0.0,
            zero_force_n: 0.0,
        }
    }
}
