//! What the stages work on. Which units there are follows from the `session.toml`s and the options alone, before anything has been read.

use pipeline_base::session::{Kind, Session};
use pipeline_config::Config;
use pipeline_fit as fit;
use pipeline_fit::Group;
use pipeline_formats::discover::Discovery;
use std::collections::BTreeSet;

/// A kind of unit; those of one kind are worked on side by side, one kind after the other in this order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Scope {
    /// One session.
    Session,
    /// The isometric sessions of a campaign and diameter, or of a diameter over all measured campaigns.
    Group,
    /// The sessions of a campaign in which torque was measured.
    TorqueCampaign,
    /// The shipped knees, which need no session: there where anybody has measured torque.
    ShippedKnees,
}

/// One thing that a stage works on.
#[derive(Clone, Debug)]
pub struct Unit {
    /// As people name it.
    pub name: String,
    /// Its sessions, as places in [`Discovery::sessions`]; of the shipped knees, the torque session because of which they are needed.
    pub sessions: Vec<usize>,
    /// Which rows, if it is a group.
    pub group: Option<Group>,
}

impl Scope {
    /// All of them, in order.
    pub const ALL: [Scope; 4] = [
        Scope::Session,
        Scope::Group,
        Scope::TorqueCampaign,
        Scope::ShippedKnees,
    ];

    /// The units, in order.
    pub fn units(self, discovery: &Discovery, config: &Config) -> Vec<Unit> {
        match self {
            Scope::Session => sessions(discovery),
            Scope::Group => groups(discovery, config),
            Scope::TorqueCampaign => torque_campaigns(discovery),
            Scope::ShippedKnees => shipped_knees(discovery).into_iter().collect(),
        }
    }
}

fn sessions(discovery: &Discovery) -> Vec<Unit> {
    let sessions = discovery.sessions.iter().enumerate();
    let unit = |(k, located): (usize, &pipeline_formats::discover::Located)| Unit {
        name: located.session.id.clone(),
        sessions: vec![k],
        group: None,
    };
    sessions.map(unit).collect()
}

fn groups(discovery: &Discovery, config: &Config) -> Vec<Unit> {
    let diameter_mm = |s: &Session| s.specimen.diameter_mm.round() as u32;
    let sessions = discovery.sessions.iter().map(|l| &l.session);
    let isometric = sessions.filter(|s| s.kind == Kind::Isometric);
    let members: Vec<(String, u32, bool)> = isometric
        .map(|s| (s.campaign.clone(), diameter_mm(s), s.is_simulated()))
        .collect();
    let unit = |group: Group| {
        let belongs = |s: &Session| {
            s.kind == Kind::Isometric && group.takes_in(&s.campaign, s.specimen.diameter_mm)
        };
        Unit {
            name: format!("{} {} mm", group.campaign, group.diameter_mm),
            sessions: places(discovery, belongs),
            group: Some(group),
        }
    };
    let groups = fit::groups(&members, config.fit.pool).into_iter();
    groups.map(unit).collect()
}

fn torque_campaigns(discovery: &Discovery) -> Vec<Unit> {
    let sessions = discovery.sessions.iter().map(|l| &l.session);
    let torque = sessions.filter(|s| s.kind == Kind::KneeTorque);
    let campaigns: BTreeSet<&str> = torque.map(|s| s.campaign.as_str()).collect();
    let unit = |campaign: &str| {
        let belongs = |s: &Session| s.kind == Kind::KneeTorque && s.campaign == campaign;
        Unit {
            name: campaign.to_owned(),
            sessions: places(discovery, belongs),
            group: None,
        }
    };
    campaigns.into_iter().map(unit).collect()
}

fn shipped_knees(discovery: &Discovery) -> Option<Unit> {
    let first = torque_campaigns(discovery).into_iter().next()?;
    Some(Unit {
        name: "shipped knees".to_owned(),
        sessions: first.sessions[..1].to_vec(),
        group: None,
    })
}

fn places(discovery: &Discovery, belongs: impl Fn(&Session) -> bool) -> Vec<usize> {
    let sessions = discovery.sessions.iter().enumerate();
    let members = sessions.filter(|(_, located)| belongs(&located.session));
    members.map(|(k, _)| k).collect()
}
