//! TEMPORARY, deleted when the mixed model replaces the search: its findings as `bpa-findings/2`, with invented numbers where the search
//! has none (scatter, budget, profiles, predictive distribution), so that the pages can be seen.

use super::findings as v1;
use crate::findings as v2;
use std::collections::{BTreeMap, BTreeSet};

/// The findings of the search.
pub fn findings(
    old: &v1::CampaignFindings,
    residuals: Option<&v1::Residuals>,
) -> v2::CampaignFindings {
    let torque = old.kind == "knee-torque";
    let after = errors(&old.after, 0.9);
    let budget = budget(old, &after);
    v2::CampaignFindings {
        campaign: old.campaign.clone(),
        part: old.part.clone(),
        diameter_mm: old.diameter_mm,
        simulated: old.simulated,
        kind: old.kind.clone(),
        base_model: old.base_model.clone(),
        base_refitted: old.base_refitted,
        unit: old.unit.clone(),
        design: v2::Design {
            readings: old.readings,
            readings_outside_domain: 0,
            sessions: old.sessions,
            specimens: old.specimens,
            readings_held_out: old.readings_held_out,
            held_out_by: match (old.held_out_by.as_str(), torque) {
                ("holdout" | "the sessions with the role holdout", _) => v2::HeldOutBy::Holdout,
                (_, true) => v2::HeldOutBy::Actuator,
                _ => v2::HeldOutBy::Specimen,
            },
            doubtful_only: false,
        },
        verdict: match old.verdict {
            v1::Verdict::EffectFound => v2::Verdict::EffectFound,
            v1::Verdict::None => v2::Verdict::None,
            v1::Verdict::Unexplained => v2::Verdict::Unexplained,
        },
        not_assessed: None,
        effects: old.effects.iter().map(|e| effect(e, old)).collect(),
        scatter: scatter(old, residuals),
        misfit: Some(v2::Misfit {
            common: 0.012,
            session: 0.021,
            sensitive: Vec::new(),
        }),
        unexplained: old.unexplained.iter().map(unexplained).collect(),
        recording_errors: old.suspects.iter().map(suspect).collect(),
        before: errors(&old.before, 0.9),
        expected_rmse_heldout: Some(budget.iter().map(|b| b.variance).sum::<f64>().sqrt()),
        after,
        by_unit: old.by_specimen.iter().enumerate().map(unit).collect(),
        budget,
        inside_50: Some(0.53),
        inside_95: Some(0.94),
        pit: vec![0.09, 0.11, 0.1, 0.12, 0.1, 0.09, 0.11, 0.1, 0.09, 0.09],
        noise: Some(old.noise_floor.unwrap_or(0.05 * old.after.rmse_heldout)),
        black_box_rmse_heldout: old.black_box_rmse_heldout,
        tested: tested(old),
        detection_limits: old.detection_limits.iter().map(limit).collect(),
        not_measurable: old.not_measurable.iter().map(not_measurable).collect(),
        aliases: old
            .aliases
            .iter()
            .map(|a| v2::Alias {
                ids: a.ids.clone(),
                cosine: a.cosine,
            })
            .collect(),
        next_measurement: next(old),
        coefficients: old.coefficients.iter().map(coefficient).collect(),
        alternatives: alternatives(old),
    }
}

/// The residuals of the search.
pub fn residuals(old: v1::Residuals) -> v2::Residuals {
    v2::Residuals {
        conditional: old.after.iter().map(|r| 0.4 * r).collect(),
        session: old.session,
        specimen: old.specimen,
        before: old.before,
        after: old.after,
        predicted: old.predicted,
        columns: old.columns,
    }
}

fn finite(x: f64) -> Option<f64> {
    x.is_finite().then_some(x)
}

fn errors(old: &v1::Errors, density: f64) -> v2::Errors {
    let own = old.rmse_heldout_own_strength;
    let after = [("1", 0.8), ("2", 0.65), ("3", 0.55), ("5", 0.45)];
    v2::Errors {
        rmse_train: old.rmse_train,
        rmse_heldout: finite(old.rmse_heldout),
        max_abs_error_heldout: finite(old.max_abs_error_heldout),
        rmse_heldout_calibrated: finite(0.4 * own),
        rmse_heldout_after: after
            .iter()
            .filter(|_| own.is_finite())
            .map(|(k, share)| ((*k).to_owned(), share * own))
            .collect(),
        log_density_heldout: Some(-density - old.rmse_heldout.max(1e-3).ln()),
    }
}

fn wave(k: usize) -> f64 {
    libm::sin(2.399_963 * (k as f64 + 1.0))
}

fn effect(old: &v1::EffectFinding, all: &v1::CampaignFindings) -> v2::EffectFinding {
    let first = old.parameters.first();
    let size = first.map_or(1.0, |p| p.value);
    let half = first.map_or(0.1, |p| 0.5 * (p.ci_high - p.ci_low));
    let half = if half.is_finite() && half > 0.0 {
        half
    } else {
        0.1 * size.abs().max(1e-6)
    };
    let parameter = |p: &v1::ParameterFinding| v2::Parameter {
        name: p.name.clone(),
        value: p.value,
        ci_low: finite(p.ci_low),
        ci_high: finite(p.ci_high),
        unit: p.unit.clone(),
    };
    let own = |(k, u): (usize, &v1::FoldErrors)| {
        let estimate = v2::Estimate {
            value: size + 1.2 * half * wave(k),
            standard_error: half * (0.7 + 0.2 * wave(k + 7)),
        };
        (u.unit.clone(), estimate)
    };
    v2::EffectFinding {
        id: old.id.clone(),
        class: old.class.clone(),
        acts_on: if old.acts_on.contains(" from ") {
            v2::ActsOn::From
        } else if old.scope == "global" || old.scope.is_empty() {
            v2::ActsOn::All
        } else {
            v2::ActsOn::Levels
        },
        column: (old.scope == "session" || old.scope == "specimen").then(|| old.scope.clone()),
        from: old.acts_on.contains(" from ").then(|| "s07".to_owned()),
        parameters: old.parameters.iter().map(parameter).collect(),
        form: old.form.clone(),
        equation: old.equation.clone(),
        p_familywise: old.p_adjusted.clamp(0.0, 1.0),
        log_likelihood_gain: Some(old.criterion_gain.max(4.0)),
        found_in_folds: old.selected_in_folds,
        negligible: false,
        rms: (old.rmse_before * old.rmse_before - old.rmse_after * old.rmse_after)
            .max(0.0)
            .sqrt(),
        by_specimen: all.by_specimen.iter().enumerate().map(own).collect(),
        profile: (-12..=12)
            .map(|k| {
                let t = f64::from(k) / 4.0;
                (size + t * half / 1.96, -0.5 * t * t * (1.0 + 0.05 * t))
            })
            .collect(),
        free_form: None,
        in_its_place: old
            .class
            .iter()
            .filter(|id| **id != old.id)
            .enumerate()
            .map(|(k, id)| (id.clone(), -0.8 - 1.7 * k as f64))
            .collect(),
        measurement: old.measurement.clone(),
        source: old.source.clone(),
    }
}

fn unexplained(old: &v1::Unexplained) -> v2::Unexplained {
    v2::Unexplained {
        column: old.column.clone(),
        shape: old.shape.clone(),
        p_familywise: old.p_adjusted,
        log_likelihood_gain: Some(11.0),
        share_of_variance: old.share_of_residual,
        curve: old.curve.clone(),
    }
}

fn suspect(old: &v1::Suspect) -> v2::RecordingError {
    let (level, group) = match old.what.split_once(' ') {
        Some(("session", id)) => (v2::Level::Session, id),
        Some(("specimen", id)) => (v2::Level::Specimen, id),
        _ => (v2::Level::Session, old.what.as_str()),
    };
    let length = old.explanation.contains("length");
    v2::RecordingError {
        group: group.to_owned(),
        level,
        kind: match old.error_then_n {
            None => v2::ErrorKind::Outlier,
            Some(_) if length => v2::ErrorKind::Length,
            Some(_) => v2::ErrorKind::SwappedColumns,
        },
        quantity: length.then(|| "length".to_owned()),
        value: length.then_some(-10.0),
        unit: "mm".to_owned(),
        p: Some(1e-6),
        rms: old.error_n,
        rms_corrected: old.error_then_n,
        set_aside: old.set_aside,
    }
}

fn unit((k, old): (usize, &v1::FoldErrors)) -> v2::UnitErrors {
    let of = |rmse: f64| v2::Errors {
        rmse_train: 0.9 * rmse,
        rmse_heldout: finite(rmse),
        max_abs_error_heldout: finite(2.7 * rmse),
        rmse_heldout_calibrated: finite(0.4 * rmse),
        rmse_heldout_after: [("1", 0.8), ("2", 0.65), ("3", 0.55), ("5", 0.45)]
            .iter()
            .map(|(n, share)| ((*n).to_owned(), share * rmse))
            .collect(),
        log_density_heldout: Some(-1.0 - rmse.max(1e-3).ln()),
    };
    v2::UnitErrors {
        unit: old.unit.clone(),
        readings: old.readings,
        before: of(old.before),
        after: of(old.after),
        realised_over_expected: Some(1.0 + 0.6 * wave(k)),
        inside_95: Some(0.95 - 0.04 * wave(k).abs()),
        found: old
            .chosen
            .iter()
            .filter_map(|c| c.split(' ').next().map(str::to_owned))
            .collect(),
    }
}

fn limit(old: &v1::DetectionLimit) -> v2::DetectionLimit {
    v2::DetectionLimit {
        id: old.id.clone(),
        form: old.form.clone(),
        smallest: old.smallest,
        unit: old.unit.clone(),
        identifiable_share: old.visible,
    }
}

fn not_measurable(old: &v1::NotMeasurable) -> v2::NotMeasurable {
    let lacks = old.why.strip_prefix("the campaign lacks ");
    v2::NotMeasurable {
        id: old.id.clone(),
        form: None,
        reason: if lacks.is_some() {
            v2::WhyNot::NoColumn
        } else {
            v2::WhyNot::Absorbed
        },
        by: Some(lacks.unwrap_or("b2").to_owned()),
    }
}

fn coefficient(old: &v1::CoefficientChange) -> v2::CoefficientChange {
    v2::CoefficientChange {
        name: old.name.clone(),
        unit: old.unit.clone(),
        before: old.before,
        after: old.after,
        standard_error: (old.ci_high - old.ci_low) / 3.92,
        published: old.published,
        at_bound: false,
    }
}

fn tested(old: &v1::CampaignFindings) -> Vec<v2::Tested> {
    let found = old.effects.iter().map(|e| v2::Tested {
        id: e.id.clone(),
        is_column: false,
        form: e.form.clone(),
        acts_on: v2::ActsOn::All,
        log_likelihood_gain: e.criterion_gain.max(4.0),
        amplitude: e.parameters.first().map(|p| p.value),
        unit: e
            .parameters
            .first()
            .map_or_else(String::new, |p| p.unit.clone()),
        p_familywise: e.p_adjusted,
    });
    let columns = old.questions.iter().map(|q| v2::Tested {
        id: q.column.clone(),
        is_column: true,
        form: "smooth".to_owned(),
        acts_on: v2::ActsOn::All,
        log_likelihood_gain: 6.0 * q.share,
        amplitude: None,
        unit: "1".to_owned(),
        p_familywise: q.p_adjusted,
    });
    let rejected = old.rejected.iter().enumerate().map(|(k, r)| v2::Tested {
        id: r.id.clone(),
        is_column: r.form.is_none(),
        form: r.form.clone().unwrap_or_else(|| "smooth".to_owned()),
        acts_on: v2::ActsOn::All,
        log_likelihood_gain: 8.0 * r.share,
        amplitude: r.form.is_some().then_some(0.7 + k as f64),
        unit: "1".to_owned(),
        p_familywise: (0.2 + 0.1 * k as f64).min(1.0),
    });
    let mut all: Vec<v2::Tested> = found.chain(columns).chain(rejected).collect();
    let mut seen = BTreeSet::new();
    all.retain(|t| seen.insert((t.id.clone(), t.form.clone())));
    all.sort_by(|a, b| b.log_likelihood_gain.total_cmp(&a.log_likelihood_gain));
    all
}

fn budget(old: &v1::CampaignFindings, after: &v2::Errors) -> Vec<v2::BudgetEntry> {
    let total = after.rmse_heldout.unwrap_or(after.rmse_train);
    let shares: &[(&str, f64)] = if old.kind == "knee-torque" {
        &[
            ("mounting", 0.5),
            ("actuator_gain", 0.2),
            ("session_misfit", 0.13),
            ("estimation", 0.12),
            ("noise", 0.05),
        ]
    } else {
        &[
            ("set_length", 0.58),
            ("specimen_gain", 0.14),
            ("session_misfit", 0.11),
            ("estimation", 0.08),
            ("specimen_lengths", 0.05),
            ("noise", 0.03),
            ("force_zero", 0.01),
        ]
    };
    let entry = |(source, share): &(&str, f64)| {
        let variance = share * 0.8 * total * total;
        v2::BudgetEntry {
            source: (*source).to_owned(),
            variance,
            rmse: variance.sqrt(),
            unit: old.unit.clone(),
        }
    };
    shares.iter().map(entry).collect()
}

fn scatter(old: &v1::CampaignFindings, residuals: Option<&v1::Residuals>) -> Vec<v2::Scatter> {
    let units: BTreeSet<String> = old.by_specimen.iter().map(|u| u.unit.clone()).collect();
    let specimens: BTreeSet<String> =
        residuals.map_or_else(|| units.clone(), |r| r.specimen.iter().cloned().collect());
    let sessions: BTreeSet<String> =
        residuals.map_or_else(|| units.clone(), |r| r.session.iter().cloned().collect());
    let torque = old.kind == "knee-torque";
    let (session, specimen) = if torque {
        (v2::Level::Test, v2::Level::Actuator)
    } else {
        (v2::Level::Session, v2::Level::Specimen)
    };
    let one =
        |id: &str, level, sd: f64, unit: &str, groups: &BTreeSet<String>, declared: Option<f64>| {
            let values: BTreeMap<String, f64> = groups
                .iter()
                .enumerate()
                .map(|(k, g)| (g.clone(), 1.2 * sd * wave(k)))
                .collect();
            v2::Scatter {
                id: id.to_owned(),
                level,
                sd,
                ci_low: declared.is_none().then_some(0.7 * sd),
                ci_high: declared.is_none().then_some(1.5 * sd),
                unit: unit.to_owned(),
                declared,
                declared_contradicted: false,
                log_likelihood_gain: declared.is_none().then_some(87.0),
                values,
            }
        };
    let mut all = vec![
        one(
            "length_offset",
            session,
            if torque { 4.0 } else { 0.9 },
            "mm",
            &sessions,
            None,
        ),
        one("specimen_variation", specimen, 0.042, "1", &specimens, None),
    ];
    if !torque {
        all.push(one("force_zero_offset", session, 0.6, "N", &sessions, None));
        all.push(one(
            "rest_length",
            specimen,
            0.29,
            "mm",
            &specimens,
            Some(0.29),
        ));
        all.push(one(
            "contracted_length",
            specimen,
            0.29,
            "mm",
            &specimens,
            Some(0.29),
        ));
    }
    all
}

fn next(old: &v1::CampaignFindings) -> Vec<v2::NextMeasurement> {
    let total = old.after.rmse_heldout;
    let mut list = vec![
        v2::NextMeasurement {
            kind: v2::NextKind::Precision,
            separates: vec!["set_length".to_owned()],
            at: BTreeMap::from([("sd_mm".to_owned(), 0.2)]),
            worth: Some(0.4 * total),
            unit: old.unit.clone(),
        },
        v2::NextMeasurement {
            kind: v2::NextKind::Specimens,
            separates: Vec::new(),
            at: BTreeMap::from([("specimens".to_owned(), 4.0)]),
            worth: Some(0.06 * total),
            unit: old.unit.clone(),
        },
    ];
    let pairs = old.effects.iter().filter(|e| e.class.len() > 1);
    list.extend(pairs.map(|e| v2::NextMeasurement {
        kind: v2::NextKind::Separate,
        separates: e.class.clone(),
        at: BTreeMap::from([
            ("pressure_kpa".to_owned(), 120.0),
            ("contraction_rel".to_owned(), 0.4),
        ]),
        worth: Some(14.2),
        unit: "1".to_owned(),
    }));
    list
}

fn alternatives(old: &v1::CampaignFindings) -> Vec<v2::Alternative> {
    let parts: [&[&str]; 4] = [
        &[],
        &["length_law"],
        &["series_compliance"],
        &["length_law", "series_compliance"],
    ];
    let entry = |(k, r): (usize, &v1::Reading)| v2::Alternative {
        parts: parts[k % 4].iter().map(|p| (*p).to_owned()).collect(),
        parameters: r.parameters,
        log_likelihood: if k == 0 { 0.0 } else { 14.0 + 3.5 * k as f64 },
        rmse_heldout: finite(r.errors.rmse_heldout),
        log_density_heldout: Some(-3.9 + 0.01 * k as f64),
        numbers: if parts[k % 4].contains(&"series_compliance") {
            vec![v2::Parameter {
                name: "C".to_owned(),
                value: 8.9,
                ci_low: Some(6.1),
                ci_high: Some(11.4),
                unit: "um/N".to_owned(),
            }]
        } else {
            Vec::new()
        },
    };
    old.readings_of_the_base
        .iter()
        .enumerate()
        .map(entry)
        .collect()
}
