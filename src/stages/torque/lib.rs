#![warn(missing_docs)]
//! Torque: what every force model says of the torque about a knee, beside what was measured.
//!
//! One campaign at a time. Its sessions are put together by *configuration*: one actuator along one route over one knee, with one tendon and
//! one pair of fittings. The length of the path gives l_m, that and the pressure a force, and the moment arm the torque M = r F (the knee
//! paper's Eqs. 2 to 5 and 10), everything but the actuator taken as rigid.
//!
//! | file | idea |
//! |---|---|
//! | [`build`] | how the actuator of a session is built into a leg |
//! | [`point`] | one reading: geometry, prediction of every model, torque back-calculated from length and arm measured by hand |
//! | [`errors`] | errors of a test and model; how far measured eps* and arm are from the expected ones |
//! | [`curve`] | what is expected over the range of the joint |
//! | [`doubt`] | which tests their owner doubts |
//! | [`diagnose`] | what the rigid leg lacks: the effects of the joint, and the length of the end fittings |
//! | [`tidy`] | all readings as one table |
//! | [`reference`] | what needs no session: both methods for the arm, the linkage, the human muscles beside OpenSim, stress, design |
//!
//! Sessions that their owner excludes, or whose notes say that he doubts them ([`doubt`]), are predicted like all others and shown, and take part in
//! no fit and in no error of what was held out; those with the role `validation` or `holdout` in no fit.

pub mod build;
pub mod curve;
pub mod diagnose;
pub mod doubt;
pub mod errors;
pub mod point;
pub mod reference;
pub mod tidy;

use build::Build;
use curve::Curve;
use diagnose::JointDiagnosis;
use diagnose::fittings::{self, FittingFit};
use errors::{Errors, Hand};
use pipeline_base::row::Row;
use pipeline_base::session::{Role, Session};
use pipeline_config::{DiagnoseOptions, TorqueOptions};
use pipeline_mechanics::models::{ForceModel, published};
use point::Point;
use reference::arms::{Arms, of_leg};
use serde::{Deserialize, Serialize};

/// Raised when results change without a change of this stage's source files.
pub const VERSION: u32 = 2;

/// A session with its normalised rows.
#[derive(Clone, Debug)]
pub struct Measured {
    /// The session.
    pub session: Session,
    /// Its rows.
    pub rows: Vec<Row>,
}

/// What stands of one campaign.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CampaignTorque {
    /// Campaign id.
    pub campaign: String,
    /// Whether its data are simulated.
    pub simulated: bool,
    /// Ids of the published models, in the order of all lists by model.
    pub models: Vec<String>,
    /// The configurations, by diameter, knee, muscle and resting length.
    pub configurations: Vec<Configuration>,
    /// The length of the end fittings.
    pub fits: Vec<FittingFit>,
    /// What the rigid leg lacks, joint by joint.
    pub diagnoses: Vec<JointDiagnosis>,
}

/// One actuator along one route, and everything that was measured of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Configuration {
    /// Name, unique within the campaign: part of file names.
    pub id: String,
    /// "pinned", "biomimetic" or "described".
    pub knee: String,
    /// "flexor" or "extensor".
    pub muscle: String,
    /// Name of the route.
    pub route: String,
    /// Specimen id.
    pub specimen: String,
    /// Nominal diameter, mm.
    pub diameter_mm: u32,
    /// l_rest, m.
    pub rest_length_m: f64,
    /// l_620, m.
    pub contracted_length_m: f64,
    /// l_fit, m, as the set-up states it or as it is assumed.
    pub fitting_m: f64,
    /// l_tendon, m; none where it was not recorded, which is taken as no tendon.
    pub tendon_m: Option<f64>,
    /// What a reader must know of the geometry.
    pub remarks: Vec<String>,
    /// Its sessions.
    pub tests: Vec<Test>,
    /// What is expected over the range of the joint.
    pub curve: Curve,
    /// The leg, and both methods for its moment arm.
    pub arms: Arms,
}

/// One session.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Test {
    /// Session id.
    pub session: String,
    /// Why its owner keeps it out of every fit.
    pub excluded: Option<String>,
    /// What its owner's notes doubt, which keeps it out as well.
    pub doubtful: Option<String>,
    /// The part that it plays in fits, where its owner has decided.
    pub role: Option<Role>,
    /// The owner's remarks.
    pub notes: Option<String>,
    /// Its readings.
    pub points: Vec<Point>,
    /// Errors of every model.
    pub errors: Vec<Errors>,
    /// Measured eps* and arm beside the expected ones.
    pub hand: Hand,
}

impl Test {
    /// Whether the test takes part in fits.
    pub fn is_fitted(&self) -> bool {
        !self.is_left_out() && matches!(self.role, None | Some(Role::Train))
    }

    /// Whether it is shown, and no more: excluded or doubtful.
    pub fn is_left_out(&self) -> bool {
        self.excluded.is_some() || self.doubtful.is_some()
    }

    /// Why it is left out: "excluded: bolt slipped".
    pub fn left_out_because(&self) -> Option<String> {
        let excluded = self.excluded.as_ref().map(|why| format!("excluded: {why}"));
        excluded.or_else(|| Some(format!("doubtful: {}", self.doubtful.as_ref()?)))
    }
}

impl Configuration {
    /// The number of readings that take part in fits.
    pub fn fitted_points(&self) -> usize {
        let fitted = self.tests.iter().filter(|t| t.is_fitted());
        fitted.map(|t| t.points.len()).sum()
    }

    /// The joint that it is of, beside its diameter: "pinned knee, flexor".
    pub fn joint(&self) -> String {
        format!("{} knee, {}", self.knee, self.muscle)
    }

    /// "pinned knee, flexor, 10 mm, 485 mm, tendon 35 mm".
    pub fn title(&self) -> String {
        let tendon = match self.tendon_m {
            Some(tendon) if tendon > 0.0 => format!(", tendon {:.0} mm", 1e3 * tendon),
            _ => String::new(),
        };
        format!(
            "{} knee, {}, {} mm, {:.0} mm{tendon}",
            self.knee,
            self.muscle,
            self.diameter_mm,
            1e3 * self.rest_length_m
        )
    }
}

/// Everything of one campaign; `measured` are its torque sessions, by id.
pub fn torque(
    campaign: &str,
    measured: &[Measured],
    options: &TorqueOptions,
    search: &DiagnoseOptions,
    confidence: f64,
) -> CampaignTorque {
    let models = published();
    let mut found: Vec<(Build, Configuration)> = Vec::new();
    for one in measured {
        let Ok(build) = Build::of(&one.session, options) else {
            // The description of the leg was checked when the session was found.
            continue;
        };
        let test = test(&build, one, &models, options);
        let fresh = configuration(&build, &one.session);
        let same =
            |(b, c): &&mut (Build, Configuration)| *b == build && c.specimen == fresh.specimen;
        if let Some((_, known)) = found.iter_mut().find(same) {
            known.tests.push(test);
            continue;
        }
        // Legs may be described differently in files of one name.
        let taken = |id: &String| found.iter().any(|(_, c)| c.id == *id);
        let others = (2..).map(|n| format!("{}-{n}", fresh.id));
        let mut names = std::iter::once(fresh.id.clone()).chain(others);
        let id = names.find(|id| !taken(id)).unwrap_or_default();
        let tests = vec![test];
        found.push((build, Configuration { id, tests, ..fresh }));
    }
    found.sort_by(|(_, a), (_, b)| {
        let key = |c: &Configuration| (c.diameter_mm, c.muscle == "extensor", c.knee != "pinned");
        key(a)
            .cmp(&key(b))
            .then(b.rest_length_m.total_cmp(&a.rest_length_m))
            .then(a.id.cmp(&b.id))
    });
    let fits = fittings::fits(&found, confidence);
    for (build, configuration) in &mut found {
        let fitted = fittings::chosen(&fits, configuration);
        configuration.curve = curve::curve(build, configuration, fitted);
    }
    let simulated = measured.iter().any(|m| m.session.is_simulated());
    let diagnoses = diagnose::diagnose(campaign, simulated, &found, search);
    CampaignTorque {
        campaign: campaign.to_owned(),
        simulated,
        models: models.iter().map(|m| m.id().to_owned()).collect(),
        configurations: found.into_iter().map(|(_, c)| c).collect(),
        fits,
        diagnoses,
    }
}

fn test(
    build: &Build,
    measured: &Measured,
    models: &[&dyn ForceModel],
    options: &TorqueOptions,
) -> Test {
    let session = &measured.session;
    let rows = measured.rows.iter();
    let points: Vec<Point> = rows.map(|r| point::point(build, r, models)).collect();
    Test {
        session: session.id.clone(),
        excluded: session.exclude.clone(),
        doubtful: doubt::of(
            session.notes.as_deref().unwrap_or_default(),
            &options.doubtful_words,
        ),
        role: session.role,
        notes: session.notes.clone(),
        errors: errors::of_models(&points, models, build.setup.diameter_mm),
        hand: errors::by_hand(&points),
        points,
    }
}

/// The configuration of a session, without its tests.
fn configuration(build: &Build, session: &Session) -> Configuration {
    let (specimen, setup) = (&session.specimen, &build.setup);
    let joint = session.joint.as_ref();
    let tendon = joint.and_then(|j| j.tendon_m);
    let in_mm = |x: f64| (1e3 * x).round();
    let mut id = format!("{}-{}-{}", build.knee.name, build.route, specimen.id);
    if setup.tendon_m > 0.0 {
        id += &format!("-tendon{}", in_mm(setup.tendon_m));
    }
    if joint.is_some_and(|j| j.fitting_m.is_some()) {
        id += &format!("-fitting{}", in_mm(setup.fitting_m));
    }
    if let Some(own) = joint.and_then(|j| j.description.as_ref()) {
        id += &format!("-{}", own.file.trim_end_matches(".toml"));
    }
    Configuration {
        id: pipeline_base::names::file_name(&id.replace('/', "-")),
        knee: build.knee.name.clone(),
        muscle: joint.map_or_else(String::new, |j| j.muscle.clone()),
        route: build.route.clone(),
        specimen: specimen.id.clone(),
        diameter_mm: specimen.diameter_mm as u32,
        rest_length_m: specimen.rest_length_m,
        contracted_length_m: specimen.contracted_length_m,
        fitting_m: setup.fitting_m,
        tendon_m: tendon,
        remarks: build.remarks.clone(),
        tests: Vec::new(),
        curve: Curve::default(),
        arms: of_leg(&build.knee.name, &build.leg()),
    }
}
