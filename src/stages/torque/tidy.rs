//! The readings of all campaigns as one tidy table, units in the names of the columns.

use super::point::{Expected, Point};
use super::{CampaignTorque, Configuration, Test};
use pipeline_base::columns::{
    ANGLE, MOMENT_ARM, MUSCLE_LENGTH, PRESSURE, TORQUE, derived, unit_in,
};
use pipeline_base::frame::{Frame, Values};
use pipeline_mechanics::models::published;
use std::collections::BTreeMap;

/// A reading with everything that it belongs to.
struct Reading<'a> {
    campaign: &'a CampaignTorque,
    configuration: &'a Configuration,
    test: &'a Test,
    point: &'a Point,
}

/// One row a reading: measured, expected, and the torque of every model from the geometry and from what was measured by hand.
pub fn frame<'a>(campaigns: impl Iterator<Item = &'a CampaignTorque>) -> Frame {
    let all = readings(campaigns);
    let mut frame = measured(&all);
    for (name, torques) in predicted(&all).into_iter().chain(of_searches(&all)) {
        frame = frame.with(&name, Values::Number(torques));
    }
    let units: Vec<(String, String)> = frame
        .columns
        .iter()
        .filter_map(|(name, _)| Some((name.clone(), unit_in(name)?.to_owned())))
        .collect();
    frame.with_units(units)
}

/// All readings, in the order of the campaigns, configurations and tests.
fn readings<'a>(campaigns: impl Iterator<Item = &'a CampaignTorque>) -> Vec<Reading<'a>> {
    let mut all = Vec::new();
    for campaign in campaigns {
        for configuration in &campaign.configurations {
            for test in &configuration.tests {
                all.extend(test.points.iter().map(|point| Reading {
                    campaign,
                    configuration,
                    test,
                    point,
                }));
            }
        }
    }
    all
}

/// What belongs to each reading, what was measured, and what the geometry says of it.
fn measured(all: &[Reading]) -> Frame {
    let texts = |f: for<'r> fn(&'r Reading) -> &'r str| {
        Values::Text(all.iter().map(|r| Some(f(r).to_owned())).collect())
    };
    let integers =
        |f: fn(&Reading) -> i64| Values::Integer(all.iter().map(|r| Some(f(r))).collect());
    let numbers = |f: fn(&Point) -> Option<f64>| {
        let value = |r: &Reading| f(r.point).unwrap_or(f64::NAN);
        Values::Number(all.iter().map(value).collect())
    };
    let expected = |f: fn(&Expected) -> f64| {
        let value = |r: &Reading| r.point.expected.as_ref().map_or(f64::NAN, f);
        Values::Number(all.iter().map(value).collect())
    };
    Frame::default()
        .with(derived::SESSION, texts(|r| &r.test.session))
        .with(derived::CAMPAIGN, texts(|r| &r.campaign.campaign))
        .with("configuration", texts(|r| &r.configuration.id))
        .with(derived::SPECIMEN, texts(|r| &r.configuration.specimen))
        .with("knee", texts(|r| &r.configuration.knee))
        .with("muscle", texts(|r| &r.configuration.muscle))
        .with(derived::LOG, texts(|r| &r.point.log))
        .with(derived::ROW, integers(|r| r.point.row))
        .with(
            "excluded",
            integers(|r| i64::from(r.test.excluded.is_some())),
        )
        .with(
            "doubtful",
            integers(|r| i64::from(r.test.doubtful.is_some())),
        )
        .with("fitted", integers(|r| i64::from(r.test.is_fitted())))
        .with("simulated", integers(|r| i64::from(r.campaign.simulated)))
        .with(ANGLE, numbers(|p| Some(p.angle_rad)))
        .with(PRESSURE, numbers(|p| Some(p.pressure_kpa)))
        .with(TORQUE, numbers(|p| Some(p.torque_nm)))
        .with(MUSCLE_LENGTH, numbers(|p| p.by_hand.length_m))
        .with(MOMENT_ARM, numbers(|p| p.by_hand.arm_m))
        .with(
            derived::MUSCLE_LENGTH_SD,
            numbers(|p| p.by_hand.length_sd_m),
        )
        .with(derived::MOMENT_ARM_SD, numbers(|p| p.by_hand.arm_sd_m))
        .with(
            derived::CONTRACTION_REL,
            numbers(|p| p.by_hand.contraction_rel),
        )
        .with("expected_path_length_m", expected(|e| e.path_length_m))
        .with("expected_length_m", expected(|e| e.length_m))
        .with("expected_contraction_rel", expected(|e| e.contraction_rel))
        .with("expected_arm_m", expected(|e| e.arm_m))
        .with("projected_arm_m", expected(|e| e.projected_arm_m))
}

/// The torque of every published model, N.m, from the geometry and from what was measured by hand, by column; NaN where there is none.
fn predicted(all: &[Reading]) -> Vec<(String, Vec<f64>)> {
    let column = |f: &dyn Fn(&Point) -> Option<f64>| {
        let value = |r: &Reading| f(r.point).unwrap_or(f64::NAN);
        all.iter().map(value).collect()
    };
    let models = published();
    let both = models.iter().enumerate().flat_map(|(k, model)| {
        let id = model.id();
        [
            (
                format!("{id}_{TORQUE}"),
                column(&|p| p.predicted[k].torque_nm),
            ),
            (
                format!("{id}_by_hand_{TORQUE}"),
                column(&|p| p.back_calculated[k]),
            ),
        ]
    });
    both.collect()
}

/// What the residual search of each joint expects of its readings, N.m, by column: without effects, with them, after each in turn, with the
/// values of actuator and test, and where the actuator took no part; NaN where it has not asked.
fn of_searches(all: &[Reading]) -> BTreeMap<String, Vec<f64>> {
    let key = |r: &Reading| (r.test.session.clone(), r.point.log.clone(), r.point.row);
    let places: BTreeMap<(String, String, i64), usize> =
        all.iter().enumerate().map(|(k, r)| (key(r), k)).collect();
    let mut columns: BTreeMap<String, Vec<f64>> = BTreeMap::new();
    let mut campaigns: Vec<&CampaignTorque> = all.iter().map(|r| r.campaign).collect();
    campaigns.dedup_by_key(|c| &c.campaign);
    for residuals in campaigns
        .iter()
        .flat_map(|c| &c.diagnoses)
        .map(|d| &d.residuals)
    {
        let keys = residuals
            .session
            .iter()
            .zip(&residuals.log)
            .zip(&residuals.row);
        let own: Vec<Option<usize>> = keys
            .map(|((session, log), row)| places.get(&(session.clone(), log.clone(), *row)).copied())
            .collect();
        let mut put = |name: &str, left: &[f64]| {
            let blank = || vec![f64::NAN; all.len()];
            let column = columns
                .entry(format!("loop_{name}_{TORQUE}"))
                .or_insert_with(blank);
            for (place, left) in own.iter().zip(left) {
                if let Some(k) = place {
                    column[*k] = all[*k].point.torque_nm - left;
                }
            }
        };
        put("before", &residuals.before);
        put("after", &residuals.after);
        put("conditional", &residuals.conditional);
        if residuals.unseen.iter().any(|left| left.is_finite()) {
            put("unseen_before", &residuals.unseen_before);
            put("unseen", &residuals.unseen);
        }
        for (k, (_, left)) in residuals.steps.iter().enumerate() {
            put(&format!("after_{}", k + 1), left);
        }
    }
    columns
}
