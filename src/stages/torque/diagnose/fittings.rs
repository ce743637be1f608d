//! The length of the end fittings, as the measured torques have it: a query of the engine.
//!
//! l_m = L_MT - 2 l_fit - l_tendon. The knee paper took 25.4 mm for one fitting, found that measured and expected eps* part, and fitted 35.2 mm
//! to the torques of the 48.5 cm flexor, which it then tried on the 45.7 cm one. Here the same is asked of every diameter and muscle: fitted to
//! the configuration with most readings and tried on all others, on other knees too; fitted to all; and fitted without each actuator, tried on
//! that; with the law of the knee paper and with that of the force paper.
//!
//! Half of a `length_offset` that all tests share is the length of one fitting. As in the paper it is fitted by plain least squares, with nothing
//! else in the model: what brackets and tendon yield goes into the fitted length as well, and it is no length that a calliper would find. What the
//! mixed model says of the length is among the findings. The interval is that of the jackknife by actuator or by test.

use super::Group;
use super::data::Reading;
use super::library::What;
use super::problem::TorqueProblem;
use super::terms::{ALL, SIZES, place};
use crate::Configuration;
use crate::build::Build;
use crate::errors::Size;
use pipeline_config::FitOptions;
use pipeline_diagnose::base::Base;
use pipeline_inference::fit::Setting;
use pipeline_mechanics::models::published;
use pipeline_numerics::distributions::student_t_quantile;
use pipeline_numerics::jackknife::{FEWEST_GROUPS, half_width};
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// The laws of force that are fitted with, and drawn: that of the knee paper, and its successor.
pub const LAWS: [&str; 2] = ["knee_paper", "new_published"];

/// The knee paper's length of a fitting after its fit, m (10 mm actuators).
pub const PAPER_M: f64 = 0.0352;

/// Lengths of a fitting that are looked at, m.
const BOUNDS_M: (f64, f64) = (0.0, 0.1);
/// The length from which offsets are counted, m: that of the knee paper before its fit.
const BEFORE_M: f64 = 0.0254;

/// Where a length of the fittings comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Origin {
    /// Stated by the sessions, or assumed.
    Stated,
    /// The knee paper's fit.
    Paper,
    /// Fitted to the configuration with most readings.
    Largest,
    /// Fitted to all.
    All,
    /// Fitted without one actuator.
    Without,
}

/// A length of the fittings, and how it does.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FittingFit {
    /// Nominal diameter, mm.
    pub diameter_mm: u32,
    /// "flexor" or "extensor".
    pub muscle: String,
    /// Id of the law of force.
    pub law: String,
    /// Where it comes from.
    pub origin: Origin,
    /// The specimen that was fitted to, or left out; empty for the others.
    pub specimen: String,
    /// Length of one fitting, m.
    pub fitting_m: f64,
    /// Its interval, m; none for a length that was not fitted.
    pub interval_m: Option<(f64, f64)>,
    /// How the interval was made.
    pub interval_by: String,
    /// What is wrong with the fit; empty if nothing.
    pub state: String,
    /// Errors on each configuration.
    pub on: Vec<On>,
    /// Errors on everything that was fitted; none where nothing was.
    pub fitted: Option<Size>,
    /// Errors on everything that was not.
    pub held_out: Option<Size>,
}

/// Errors on one configuration.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct On {
    /// Its name.
    pub configuration: String,
    /// Whether it was fitted.
    pub fitted: bool,
    /// Its errors.
    pub size: Size,
}

/// Every fit of a campaign, by diameter and muscle.
pub fn fits(found: &[(Build, Configuration)], confidence: f64) -> Vec<FittingFit> {
    let key = |c: &Configuration| (c.diameter_mm, c.muscle.clone());
    // In the order of the configurations: flexors first.
    let mut groups: Vec<(u32, String)> = found.iter().map(|(_, c)| key(c)).collect();
    groups.dedup();
    let mut all = Vec::new();
    for group in groups {
        let members: Vec<&(Build, Configuration)> =
            found.iter().filter(|(_, c)| key(c) == group).collect();
        for id in LAWS {
            let Some(law) = base(id, group.0) else {
                continue;
            };
            // One length for all: what sessions state differently is not asked for.
            let alike: Vec<(Build, Configuration)> = members
                .iter()
                .map(|(build, configuration)| {
                    let mut build = build.clone();
                    build.setup.fitting_m = BEFORE_M;
                    (build, configuration.clone())
                })
                .collect();
            let fits = Fits {
                diameter_mm: group.0,
                muscle: &group.1,
                law: id,
                group: Group::new(alike.iter().collect(), &law),
                stated: members.iter().map(|(_, c)| c.fitting_m).collect(),
                confidence,
            };
            all.extend(fits.all());
        }
    }
    all
}

/// The lengths that the curves of a configuration are drawn with, one for each of [`LAWS`]: those fitted to the largest configuration of
/// its diameter and muscle.
pub fn chosen(fits: &[FittingFit], configuration: &Configuration) -> Vec<f64> {
    let of = |law: &&str| {
        let fit = fits.iter().find(|f| {
            f.origin == Origin::Largest
                && f.law == **law
                && f.state.is_empty()
                && f.diameter_mm == configuration.diameter_mm
                && f.muscle == configuration.muscle
        })?;
        Some(fit.fitting_m)
    };
    let found: Vec<f64> = LAWS.iter().filter_map(of).collect();
    if found.len() == LAWS.len() {
        found
    } else {
        Vec::new()
    }
}

/// The law of an id for a diameter, if it has one.
fn base(id: &str, diameter_mm: u32) -> Option<Base> {
    let all = published();
    let law = all.iter().find(|m| m.id() == id)?;
    law.diameters().contains(&diameter_mm).then_some(())?;
    match id {
        "new_published" => Some(Base::new(diameter_mm, false, 1, &FitOptions::default())),
        other => Base::published(other, false),
    }
}

/// The configurations of one diameter and muscle, under one law.
struct Fits<'a> {
    diameter_mm: u32,
    muscle: &'a str,
    law: &'a str,
    /// All of them with fittings of [`BEFORE_M`].
    group: Group<'a>,
    /// The lengths that they state, m.
    stated: Vec<f64>,
    confidence: f64,
}

impl Fits<'_> {
    fn all(&self) -> Vec<FittingFit> {
        let members = || self.group.members.iter().map(|m| &m.1);
        let nothing = |_: &Configuration| false;
        let mut all = vec![self.judged(Origin::Stated, "", &|k| self.stated[k], &nothing)];
        if self.diameter_mm == 10 {
            all.push(self.judged(Origin::Paper, "", &|_| PAPER_M, &nothing));
        }
        let largest = members()
            .enumerate()
            .max_by_key(|(k, m)| (m.fitted_points(), std::cmp::Reverse(*k)));
        if let Some((_, largest)) = largest.filter(|(_, m)| m.fitted_points() > 0) {
            all.extend(self.fit(Origin::Largest, &largest.specimen, &|c| c.id == largest.id));
        }
        let specimens: BTreeSet<&str> = members().map(|m| m.specimen.as_str()).collect();
        if specimens.len() > 1 {
            all.extend(self.fit(Origin::All, "", &|_| true));
            for one in specimens {
                all.extend(self.fit(Origin::Without, one, &|c| c.specimen != one));
            }
        }
        all
    }

    /// The configuration of a test, by its number.
    fn configuration_of(&self, test: usize) -> Option<usize> {
        let session = self.group.sessions[test];
        let has = |m: &(Build, Configuration)| m.1.tests.iter().any(|t| t.session == session);
        self.group.members.iter().position(|m| has(m))
    }

    fn fit(
        &self,
        origin: Origin,
        specimen: &str,
        takes: &dyn Fn(&Configuration) -> bool,
    ) -> Option<FittingFit> {
        let taken = |t: usize| {
            let of = self.configuration_of(t).map(|k| &self.group.members[k].1);
            self.group.fitted[t] && of.is_some_and(takes)
        };
        let data = self.group.data(&taken).as_published();
        if data.readings.len() < 2 {
            return None;
        }
        let offset = ALL.iter().position(|f| f.first == place::LENGTH)?;
        let library = [What::Effect(offset)];
        let problem = TorqueProblem::least_squares(&data, &library);
        let length = LeastSquares::new(&Setting::new(&problem))?;
        let value = length.fitting_m;
        let mut fit = self.judged(origin, specimen, &|_| value, takes);
        if value <= BOUNDS_M.0 {
            fit.state = "at its lower bound".to_owned();
        } else if value >= BOUNDS_M.1 {
            fit.state = "at its upper bound".to_owned();
        }
        (fit.interval_m, fit.interval_by) = self.interval(origin, &problem, &length);
        Some(fit)
    }

    /// The interval of a fit, and how it was made.
    fn interval(
        &self,
        origin: Origin,
        problem: &TorqueProblem,
        length: &LeastSquares,
    ) -> (Option<(f64, f64)>, String) {
        let by_actuator = (&problem.actuators, "actuator");
        let by_test = (&problem.tests, "test");
        let ways = match origin {
            Origin::Largest => vec![by_test],
            _ => vec![by_actuator, by_test],
        };
        let value = length.fitting_m;
        for (nodes, name) in ways {
            let nodes: Vec<usize> = nodes.iter().flatten().copied().collect();
            if nodes.len() < FEWEST_GROUPS {
                continue;
            }
            let without = |node: &usize| {
                let rest = LeastSquares::new(&Setting::new(problem).without(*node));
                rest.map_or(f64::NAN, |l| l.fitting_m)
            };
            let refits: Vec<f64> = nodes.iter().map(without).collect();
            if let Some(half) = half_width(value, &refits, self.confidence) {
                let ends = (value - half, value + half);
                return (Some(ends), format!("jackknife by {name}"));
            }
        }
        let freedom = problem.row.len() as f64 - 1.0;
        let t = student_t_quantile(0.5 + 0.5 * self.confidence, freedom);
        let half = t * length.standard_error_m;
        let ends = half.is_finite().then_some((value - half, value + half));
        (ends, "linearised".to_owned())
    }

    /// The errors with a length of the fittings in m, by configuration.
    fn judged(
        &self,
        origin: Origin,
        specimen: &str,
        length_m: &dyn Fn(usize) -> f64,
        takes: &dyn Fn(&Configuration) -> bool,
    ) -> FittingFit {
        let (mut fitted, mut held_out, mut on) = (Vec::new(), Vec::new(), Vec::new());
        for (k, (_, configuration)) in self.group.members.iter().enumerate() {
            let takes = takes(configuration);
            let mut sizes = [0.0; SIZES];
            sizes[place::LENGTH] = 2e3 * (length_m(k) - BEFORE_M);
            let looked_at = |r: &&Reading| {
                let test = configuration
                    .tests
                    .iter()
                    .find(|t| t.session == self.group.sessions[r.test]);
                test.is_some_and(|t| !t.is_left_out() && (!takes || t.is_fitted()))
            };
            let pair = |r: &Reading| Some((r.torque_nm, r.shown(&sizes)?.torque));
            let pairs: Vec<(f64, f64)> = self
                .group
                .all
                .iter()
                .filter(looked_at)
                .filter_map(pair)
                .collect();
            on.extend(Size::new(&pairs).map(|size| On {
                configuration: configuration.id.clone(),
                fitted: takes,
                size,
            }));
            let sum = if takes { &mut fitted } else { &mut held_out };
            sum.extend(pairs);
        }
        FittingFit {
            diameter_mm: self.diameter_mm,
            muscle: self.muscle.to_owned(),
            law: self.law.to_owned(),
            origin,
            specimen: specimen.to_owned(),
            fitting_m: length_m(0),
            interval_m: None,
            interval_by: String::new(),
            state: String::new(),
            on,
            fitted: Size::new(&fitted),
            held_out: Size::new(&held_out),
        }
    }
}

/// A length of one fitting by least squares.
pub(super) struct LeastSquares {
    pub(super) fitting_m: f64,
    /// NaN where the length stands at its bound.
    pub(super) standard_error_m: f64,
}

impl LeastSquares {
    /// Fitted to the active tests; none where they do not show it.
    pub(super) fn new(setting: &Setting) -> Option<Self> {
        let mut from = setting.problem.start();
        from.terms.push((0, vec![0.0]));
        let fitted = setting.fit(&from, &setting.fresh()[..1]);
        let offset_mm = fitted.values(0)?[0];
        // At its bound, or where every actuator is slack, it has no error.
        let covariance = fitted.covariance(&fitted.variances);
        let variance = fitted.place(0, 0).map(|k| covariance.at(k, k));
        let variance = variance.filter(|v| *v > 0.0).unwrap_or(f64::NAN);
        let fitting_m = BEFORE_M + 0.5e-3 * offset_mm;
        fitting_m.is_finite().then_some(Self {
            fitting_m,
            standard_error_m: 0.5e-3 * variance.sqrt(),
        })
    }
}
