//! What an effect is about a joint, where a torque shows it. Operators are written where torques are searched, in
//! `stages::torque::diagnose::operator`: there the force balances everything that yields to it at an angle.

use super::Place;

/// One equation of an effect about a joint.
#[derive(Clone, Copy, Debug)]
pub struct JointForm {
    /// A word for it.
    pub name: &'static str,
    /// What it is called, where the effect's title and its name would not say it.
    pub title: Option<&'static str>,
    /// Where in the chain.
    pub place: Place,
    /// The equation, as plain text.
    pub equation: &'static str,
    /// Symbols of its sizes, all 0 where the effect is absent.
    pub symbols: &'static [&'static str],
    /// Unit of the sizes.
    pub unit: &'static str,
    /// Physically possible sizes.
    pub bounds: (f64, f64),
    /// Up to which size such parts were measured, or are specified: what is larger has probably more in it than its name says.
    pub usual: f64,
    /// What must be there for it to mean anything.
    pub needs: Option<JointNeed>,
    /// Effects without an operator about a joint that would show as it does.
    pub stands_for: &'static [StandsFor],
    /// What would measure it apart from the torque.
    pub measurement: &'static str,
    /// Where it is described.
    pub source: &'static str,
}

impl JointForm {
    /// Ids of the effects without an operator about a joint that would show as it does at this size.
    pub fn stands_for(&self, size: f64) -> impl Iterator<Item = &'static str> {
        let shows = move |s: &&StandsFor| !s.where_negative || size < 0.0;
        self.stands_for.iter().filter(shows).map(|s| s.id)
    }
}

/// An effect that would show as another one does.
#[derive(Clone, Copy, Debug)]
pub struct StandsFor {
    /// Its id.
    pub id: &'static str,
    /// Whether it does so only where the size of the other one is negative.
    pub where_negative: bool,
}

/// What an effect needs of a joint or of its readings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JointNeed {
    /// Readings after the joint turned either way.
    BothSenses,
    /// The foot of the bracket at the origin.
    OriginBracket,
    /// The foot of the bracket at the insertion.
    InsertionBracket,
    /// A route that lies on the knee at some angles.
    Contact,
}

impl JointNeed {
    /// The quantity that is missing without it, as findings name it; none for a property of the route.
    pub fn column(self) -> Option<&'static str> {
        match self {
            JointNeed::BothSenses => Some("sense_of_motion"),
            JointNeed::OriginBracket => Some("origin_bracket_foot"),
            JointNeed::InsertionBracket => Some("insertion_bracket_foot"),
            JointNeed::Contact => None,
        }
    }
}
