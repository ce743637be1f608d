//! Every usual mistake is named for what it is, in simulated campaigns, and what is none is not.

use super::mistakes::UNITS;
use super::{Law, recording_errors};
use crate::base::Base;
use crate::data::Data;
use crate::library::{Column, What};
use pipeline_findings::{ErrorKind, RecordingError};

use pipeline_config::FitOptions;
use pipeline_simulate::rig_like::{self, Campaign, DIAMETER_MM, Mistake};

fn simulated(mistake: Option<Mistake>) -> Campaign {
    let settings = rig_like::Settings {
        specimens: Some(4),
        mistake,
        ..rig_like::Settings::default()
    };
    rig_like::campaign(1, &settings)
}

fn found(campaign: &Campaign) -> Vec<RecordingError> {
    let rows: Vec<_> = campaign.rows.iter().collect();
    let base = Base::new(DIAMETER_MM, true, 4, &FitOptions::default());
    recording_errors(DIAMETER_MM, &Law::new(&base), &Data::new(&rows))
}

fn assert_pointed_at(mistake: Mistake, kind: ErrorKind, quantity: Option<&str>) {
    let campaign = simulated(Some(mistake));
    let errors = found(&campaign);
    let group = campaign.truth.mistaken.map(|m| m.group);
    let named: Vec<_> = errors
        .iter()
        .map(|e| (Some(e.group.clone()), e.kind, e.quantity.as_deref()))
        .collect();
    assert_eq!(named, [(group, kind, quantity)], "{errors:?}");
    assert!(
        errors[0]
            .rms_corrected
            .is_some_and(|rms| rms < 0.3 * errors[0].rms)
    );
}

#[test]
fn a_campaign_without_mistakes_has_none() {
    assert_eq!(found(&simulated(None)), []);
}

#[test]
fn swapped_columns_are_swapped_columns_and_no_unit() {
    assert_pointed_at(Mistake::SwappedColumns, ErrorKind::SwappedColumns, None);
}

#[test]
fn swapped_columns_of_a_log_have_the_zero_of_the_load_cell_left() {
    let settings = rig_like::Settings {
        specimens: Some(4),
        scatter: rig_like::Scatter::Clean,
        mistake: Some(Mistake::SwappedColumns),
        ..rig_like::Settings::default()
    };
    let mut campaign = rig_like::campaign(1, &settings);
    let id = campaign.truth.mistaken.clone().unwrap().group;
    for row in campaign.rows.iter_mut().filter(|r| r.session == id) {
        // The force, with what the load cell showed vented.
        row.pressure_kpa += 6.0;
    }
    let errors = found(&campaign);
    assert_eq!(errors.len(), 1, "{errors:?}");
    assert_eq!(errors[0].group, id);
    assert_eq!(errors[0].kind, ErrorKind::SwappedColumns);
    let zero = errors[0].value.unwrap();
    assert!((zero + 6.0).abs() < 1.0, "{zero}");
}

#[test]
fn forces_twenty_times_too_large_are_no_unit() {
    let settings = rig_like::Settings {
        specimens: Some(4),
        scatter: rig_like::Scatter::Clean,
        ..rig_like::Settings::default()
    };
    let mut campaign = rig_like::campaign(1, &settings);
    let id = campaign.rows[0].session.clone();
    for row in campaign.rows.iter_mut().filter(|r| r.session == id) {
        row.force_n *= 20.0;
    }
    let errors = found(&campaign);
    assert_eq!(errors.len(), 1, "{errors:?}");
    assert_eq!(errors[0].kind, ErrorKind::Outlier, "{errors:?}");
}

#[test]
fn a_wrong_sign_is_a_sign() {
    assert_pointed_at(Mistake::Sign, ErrorKind::Sign, Some("force"));
}

#[test]
fn a_set_length_is_one_of_the_session() {
    assert_pointed_at(Mistake::SetLength, ErrorKind::Length, Some("length"));
}

#[test]
fn a_resting_length_is_one_of_the_specimen() {
    assert_pointed_at(Mistake::RestLength, ErrorKind::Length, Some("rest_length"));
}

/// What is found in a clean campaign of six specimens of which contracted lengths are noted longer by these shares of the resting length; and what the
/// one specimen has that stands out, with how much longer it is noted, mm.
fn noted_longer(seed: u64, shares: [f64; 6], one: usize) -> (Vec<RecordingError>, String, f64) {
    let settings = rig_like::Settings {
        specimens: Some(6),
        scatter: rig_like::Scatter::Clean,
        ..rig_like::Settings::default()
    };
    let mut campaign = rig_like::campaign(seed, &settings);
    let mut specimens: Vec<String> = Vec::new();
    let mut longer_mm = 0.0;
    for row in &mut campaign.rows {
        if !specimens.contains(&row.specimen) {
            specimens.push(row.specimen.clone());
        }
        let place = specimens.iter().position(|s| *s == row.specimen).unwrap();
        let longer_m = shares[place] * row.rest_length_m;
        row.contracted_length_m += longer_m;
        if place == one {
            longer_mm = 1e3 * longer_m;
        }
    }
    (found(&campaign), specimens.swap_remove(one), longer_mm)
}

/// Beside others that are noted rightly, and beside others that are not, which makes noted lengths worth little.
#[test]
fn the_size_of_a_contracted_length_noted_wrongly_is_that_of_the_mistake() {
    let wrongly = [0.02, -0.01, 0.015, -0.02, -0.012, 0.007];
    for (seed, others, one, share) in [
        (1, [0.0; 6], 0, 0.09),
        (1, wrongly, 3, -0.14),
        (7, wrongly, 3, -0.14),
        (7, wrongly, 4, -0.13),
    ] {
        let mut shares = others;
        shares[one] = share;
        let (errors, id, longer_mm) = noted_longer(seed, shares, one);
        assert_eq!(errors.len(), 1, "{errors:?}");
        let quantity = errors[0].quantity.as_deref();
        assert_eq!(
            (&errors[0].group, quantity),
            (&id, Some("contracted_length"))
        );
        let value = errors[0].value.unwrap();
        assert!(
            (value / -longer_mm - 1.0).abs() < 0.3,
            "{value} {longer_mm}"
        );
    }
}

#[test]
fn pounds_are_a_unit_of_the_force() {
    let mut campaign = simulated(None);
    // Without contraction the force goes nearly with the pressure: that could as well be in other units.
    let contracted = campaign.rows.iter().find(|r| r.session.ends_with("c25"));
    let id = contracted.unwrap().session.clone();
    for row in campaign.rows.iter_mut().filter(|r| r.session == id) {
        row.force_n /= UNITS[0];
    }
    let errors = found(&campaign);
    assert_eq!(errors.len(), 1, "{errors:?}");
    assert_eq!((&errors[0].group, errors[0].kind), (&id, ErrorKind::Unit));
    assert_eq!(errors[0].value, Some(UNITS[0]));
}

#[test]
fn a_specimen_in_pounds_that_carries_the_fit_is_set_aside_and_no_other() {
    for times in [UNITS[0], 1.0 / UNITS[0]] {
        let mut campaign = simulated(None);
        let id = campaign.rows[0].specimen.clone();
        for row in campaign.rows.iter_mut().filter(|r| r.specimen == id) {
            row.force_n *= times;
        }
        let errors = found(&campaign);
        assert_eq!(errors.len(), 1, "{errors:?}");
        let named = (&errors[0].group, errors[0].kind, errors[0].value);
        assert_eq!(named, (&id, ErrorKind::Unit, Some(1.0 / times)));
    }
}

#[test]
fn sessions_of_an_extreme_column_are_no_mistake_beside_a_law_that_has_it() {
    let mut campaign = simulated(None);
    // One session is twice as humid as the others are at most; humidity lowers all forces in proportion.
    let id = campaign.rows[0].session.clone();
    for (k, row) in campaign.rows.iter_mut().enumerate() {
        let humidity = if row.session == id {
            2.0
        } else {
            (k % 7) as f64 / 6.0
        };
        row.extras.insert("moisture".to_owned(), humidity);
        row.force_n *= 1.0 - 0.3 * humidity;
    }
    let rows: Vec<_> = campaign.rows.iter().collect();
    let data = Data::new(&rows);
    let base = Base::new(DIAMETER_MM, true, 4, &FitOptions::default());
    let judged = |law: &Law| recording_errors(DIAMETER_MM, law, &data);
    let bare = judged(&Law::new(&base));
    assert!(bare.iter().any(|e| e.group == id), "{bare:?}");
    let place = data.extras.iter().position(|e| e.name == "moisture");
    let column = What::Column(Column::Gain(place.unwrap()));
    assert_eq!(judged(&Law::new(&base).with(column, &[0.0, 0.0])), []);
}
