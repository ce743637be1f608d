//! The length of the end fittings, as the measured torques have it.
//!
//! l_m = L_MT - 2 l_fit - l_tendon. The knee paper took 25.4 mm for one fitting, found that measured and expected eps* part, and fitted 35.2 mm
//! to the torques of the 48.5 cm flexor, which it then tried on the 45.7 cm one. Here the same is done for every diameter and muscle: fitted to
//! the configuration with most readings and tried on all others, on other knees too; fitted to all; and fitted without each actuator, tried on
//! that. Least squares in N.m, with the law of the knee paper and with that of the force paper.
//!
//! Intervals come from refits without each test, or for a fit to several actuators without each of them (jackknife, Student's t): readings of
//! one test share how the actuator was mounted. With fewer than three there is only the linearised interval, which counts every reading as
//! independent. What else yields (brackets, tendon) goes into the fitted length as well: it is no length that a calliper would find.

use crate::models::ForceModel;
use crate::numerics::distributions::student_t_quantile;
use crate::numerics::dual_problem::DualProblem;
use crate::numerics::fit::{Fit, Options, ParameterState, fit_multi_start};
use crate::numerics::jackknife::{FEWEST_GROUPS, half_width};
use crate::numerics::real::Dual;
use crate::stages::torque::Configuration;
use crate::stages::torque::build::Build;
use crate::stages::torque::curve::laws;
use crate::stages::torque::errors::Size;
use crate::stages::torque::observation::{Observation, observations};
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// The laws of force that are fitted with, and drawn: that of the knee paper, and its successor.
pub const LAWS: [&str; 2] = ["knee_paper", "new_published"];

/// The knee paper's length of a fitting after its fit, m (10 mm actuators).
pub const PAPER_M: f64 = 0.0352;

/// Lengths of a fitting that are looked at, m.
const BOUNDS_M: (f64, f64) = (0.0, 0.1);
/// Where descents begin, m: forces are cut off at zero, so that the sum of squares may have several minima.
const STARTS_M: [f64; 3] = [0.015, 0.0254, 0.045];

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
        for law in laws() {
            if law.diameters().contains(&group.0) {
                let group = Group::new(&group, &members, law, confidence);
                all.extend(group.fits());
            }
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

/// The configurations of one diameter and muscle, under one law.
struct Group<'a> {
    diameter_mm: u32,
    muscle: &'a str,
    law: &'static dyn ForceModel,
    members: Vec<&'a Configuration>,
    /// By member.
    observations: Vec<Vec<Observation<'a>>>,
    confidence: f64,
}

/// A fit, and how long the fittings are without each unit.
struct Estimate {
    fitting_m: f64,
    fit: Fit,
}

impl<'a> Group<'a> {
    fn new(
        (diameter_mm, muscle): &'a (u32, String),
        members: &[&'a (Build, Configuration)],
        law: &'static dyn ForceModel,
        confidence: f64,
    ) -> Self {
        let answered = |o: &Observation| o.torque(law, o.build.setup.fitting_m).is_finite();
        let of = |m: &&'a (Build, Configuration)| {
            let mut all = observations(&m.0, &m.1);
            all.retain(answered);
            all
        };
        Self {
            diameter_mm: *diameter_mm,
            muscle,
            law,
            observations: members.iter().map(of).collect(),
            members: members.iter().map(|m| &m.1).collect(),
            confidence,
        }
    }

    fn fits(&self) -> Vec<FittingFit> {
        let stated = |m: &Configuration| m.fitting_m;
        let mut all = vec![self.judged(Origin::Stated, "", stated, &|_| false)];
        if self.diameter_mm == 10 {
            all.push(self.judged(Origin::Paper, "", |_| PAPER_M, &|_| false));
        }
        let by_readings = self.members.iter().enumerate();
        let largest = by_readings
            .max_by_key(|(k, m)| (m.fitted_points(), std::cmp::Reverse(*k)))
            .filter(|(_, m)| m.fitted_points() > 0);
        if let Some((_, largest)) = largest {
            let (specimen, id) = (largest.specimen.as_str(), largest.id.as_str());
            let fit = self.fit(Origin::Largest, specimen, &|c| c.id == id);
            all.extend(fit);
        }
        let specimens: BTreeSet<&str> = self.members.iter().map(|m| m.specimen.as_str()).collect();
        if specimens.len() > 1 {
            all.extend(self.fit(Origin::All, "", &|_| true));
            for one in specimens {
                all.extend(self.fit(Origin::Without, one, &|c| c.specimen != one));
            }
        }
        all
    }

    /// The observations that a fit may use, of the configurations that it takes.
    fn taken(&self, takes: &dyn Fn(&Configuration) -> bool) -> Vec<Observation<'a>> {
        let all = self.observations.iter().flatten();
        let fitted = all.filter(|o| o.test.is_fitted() && takes(o.configuration));
        fitted.copied().collect()
    }

    fn fit(
        &self,
        origin: Origin,
        specimen: &str,
        takes: &dyn Fn(&Configuration) -> bool,
    ) -> Option<FittingFit> {
        let taken = self.taken(takes);
        let estimate = self.estimate(&taken)?;
        let value = estimate.fitting_m;
        let mut fit = self.judged(origin, specimen, |_| value, takes);
        fit.state = match estimate.fit.states[0] {
            ParameterState::AtLowerBound => "at its lower bound".to_owned(),
            ParameterState::AtUpperBound => "at its upper bound".to_owned(),
            ParameterState::NotIdentified => "not identified".to_owned(),
            ParameterState::Ok | ParameterState::Unmoved => String::new(),
        };
        (fit.interval_m, fit.interval_by) = self.interval(origin, &taken, &estimate);
        Some(fit)
    }

    fn estimate(&self, taken: &[Observation]) -> Option<Estimate> {
        let measured: Vec<f64> = taken.iter().map(|o| o.torque_nm).collect();
        let model = |k: usize, p: &[Dual<1>; 1]| taken[k].torque(self.law, p[0]);
        let problem = DualProblem::new(&measured, model);
        let options = Options {
            bounds: Some(vec![BOUNDS_M]),
            ..Options::default()
        };
        let fit = fit_multi_start(&problem, &STARTS_M.map(|s| vec![s]), &options)?;
        let fitting_m = fit.parameters[0];
        let usable = taken.len() > 1 && fit.sse.is_finite();
        usable.then_some(Estimate { fitting_m, fit })
    }

    /// The interval of a fit, and how it was made.
    fn interval(
        &self,
        origin: Origin,
        taken: &[Observation],
        estimate: &Estimate,
    ) -> (Option<(f64, f64)>, String) {
        type Unit = for<'o> fn(&Observation<'o>) -> &'o str;
        let by_specimen: (Unit, &str) = (|o| &o.configuration.specimen, "actuator");
        let by_test: (Unit, &str) = (|o| &o.test.session, "test");
        let ways = match origin {
            Origin::Largest => vec![by_test],
            _ => vec![by_specimen, by_test],
        };
        let value = estimate.fitting_m;
        for (unit, name) in ways {
            let units: BTreeSet<&str> = taken.iter().map(unit).collect();
            if units.len() < FEWEST_GROUPS {
                continue;
            }
            let refit = |without: &&str| {
                let others = taken.iter().filter(|o| unit(o) != *without);
                let others: Vec<Observation> = others.copied().collect();
                self.estimate(&others).map_or(f64::NAN, |e| e.fitting_m)
            };
            let refits: Vec<f64> = units.iter().map(refit).collect();
            if let Some(half) = half_width(value, &refits, self.confidence) {
                let ends = (value - half, value + half);
                return (Some(ends), format!("jackknife by {name}"));
            }
        }
        let freedom = taken.len() as f64 - 1.0;
        let t = student_t_quantile(0.5 + 0.5 * self.confidence, freedom);
        let half = t * estimate.fit.standard_errors()[0];
        let ends = half.is_finite().then_some((value - half, value + half));
        (ends, "linearised".to_owned())
    }

    /// The errors with a length of the fittings, by configuration.
    fn judged(
        &self,
        origin: Origin,
        specimen: &str,
        length_m: impl Fn(&Configuration) -> f64,
        takes: &dyn Fn(&Configuration) -> bool,
    ) -> FittingFit {
        let (mut fitted, mut held_out, mut on) = (Vec::new(), Vec::new(), Vec::new());
        for (configuration, observations) in self.members.iter().zip(&self.observations) {
            let takes = takes(configuration);
            let looked_at = observations.iter().filter(|o| !takes || o.test.is_fitted());
            let predicted = |o: &Observation| o.torque(self.law, length_m(configuration));
            let pairs: Vec<(f64, f64)> = looked_at.map(|o| (o.torque_nm, predicted(o))).collect();
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
            law: self.law.id().to_owned(),
            origin,
            specimen: specimen.to_owned(),
            fitting_m: self.members.first().map_or(f64::NAN, |m| length_m(m)),
            interval_m: None,
            interval_by: String::new(),
            state: String::new(),
            on,
            fitted: Size::new(&fitted),
            held_out: Size::new(&held_out),
        }
    }
}
