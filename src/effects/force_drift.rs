//! The load cell's zero drifts, within a log or along the campaign.

use super::{Argument, Conditions, Effect, Form, Link, Need, Parameter, Place, Subject};
use pipeline_numerics::real::Real;

/// Its id.
pub const ID: &str = "force_drift";

/// F_meas = F + d t.
pub struct ForceDrift;

const FORMS: &[Form] = &[
    Form {
        name: "within a log",
        place: Place::Sensor,
        equation: "F_meas = F + d t, t time in the log",
        amplitude: Parameter {
            name: "d",
            unit: "N/s",
            absent: 0.0,
            bounds: (-100.0, 100.0),
        },
        shape: None,
        needs: &[Need::LogTime],
    },
    Form {
        name: "along the campaign",
        place: Place::Sensor,
        equation: "F_meas = F + D t, t from 0 for the first session to 1 for the last",
        amplitude: Parameter {
            name: "D",
            unit: "N",
            absent: 0.0,
            bounds: (-500.0, 500.0),
        },
        shape: None,
        needs: &[Need::CampaignTime],
    },
];

impl Effect for ForceDrift {
    fn id(&self) -> &'static str {
        ID
    }
    fn title(&self) -> &'static str {
        "drift of the load cell"
    }
    fn subject(&self) -> Subject {
        Subject::Rig
    }
    fn forms(&self) -> &'static [Form] {
        FORMS
    }
    fn measurement(&self) -> &'static str {
        "log the unloaded load cell for as long as a run takes, and again at the end of the day"
    }
    fn source(&self) -> &'static str {
        "JCGM 200:2012, 4.21 (instrumental drift)"
    }
    fn argument(&self, form: usize) -> Option<Argument> {
        Some(match form {
            0 => Argument::LogTime,
            _ => Argument::CampaignTime,
        })
    }
}

/// The operator.
pub fn apply<R: Real>(form: usize, [d, _]: [R; 2], at: &Conditions, link: &mut Link<R>) {
    let time = if form == 0 {
        at.log_time_s
    } else {
        at.campaign_time
    };
    link.force = link.force + d * time;
}
