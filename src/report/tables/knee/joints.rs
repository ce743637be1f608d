//! `knee_found`, `knee_effects`, `knee_by_hand`: the effects that the loop found about every joint, with their sizes; the errors of every test,
//! rigid and with these; what the measurers of the knee paper reached by hand.

use super::mm;
use crate::described::*;
use crate::tables::findings::size;
use crate::wording::name::{effect_with_form, verdict, verdict_id};
use crate::wording::number::unit;
use pipeline_findings::{CampaignFindings, EffectFinding, Parameter};
use pipeline_torque::CampaignTorque;
use pipeline_torque::diagnose::JointDiagnosis;
use pipeline_torque::diagnose::by_test::TestErrors;
use pipeline_torque::diagnose::measurers::{ByHand, Reached};
use pipeline_torque::errors::Size;

fn joints(campaigns: &[CampaignTorque]) -> impl Iterator<Item = &JointDiagnosis> {
    campaigns.iter().flat_map(|c| &c.diagnoses)
}

type Found<'a> = (&'a CampaignFindings, Option<&'a EffectFinding>);

/// One row an effect, or a joint without any.
#[rustfmt::skip]
pub fn found(campaigns: &[CampaignTorque]) -> Table {
    let estimate = |(_, e): Found| size(e.and_then(|e| e.parameters.first()));
    Described::<Found>::new("knee_found", "Effects found by the loop, joint by joint")
        .text("campaign", "Campaign", |(f, _)| &f.campaign).machines()
        .text("joint", "Joint", |(f, _)| joint(f))
        .count("diameter_mm", "⌀", Mm, |(f, _)| f.diameter_mm)
        .text("verdict", "Verdict", |(f, _)| verdict_id(f.verdict)).machines()
        .text("effect", "Effect", |(_, e)| e.map(|e| &e.id)).machines()
        .text("form", "Form", |(_, e)| e.map(|e| &e.form)).machines()
        .text("found", "Found", |(f, e)| e.map_or_else(|| verdict(f.verdict).to_owned(), |e| effect_with_form(&e.id, &e.form))).people()
        .value("size", "Size", One, estimate)
        .interval("interval", "95% interval", One, estimate)
        .text("unit", "Unit", |(_, e)| Some(&e?.parameters.first()?.unit)).machines()
        .text("unit_words", "Unit", |(_, e)| Some(unit(&e?.parameters.first()?.unit))).people()
        .number("stiffness_n_m", "1/\\v{C}", NPerM, Digits(2), |(_, e)| finite(e.and_then(stiffness)))
        .number("p_familywise", "\\v{p}", One, Digits(2), |(_, e)| finite(e.map(|e| e.p_familywise)))
        .number("log_likelihood_gain", "Gain", One, Decimals(1), |(_, e)| finite(e.and_then(|e| e.log_likelihood_gain))).machines()
        .number("found_in_folds", "In folds", One, Percent(0), |(_, e)| finite(e.and_then(|e| e.found_in_folds))).machines()
        .number("rms_nm", "RMS", Nm, Decimals(2), |(_, e)| finite(e.map(|e| e.rms)))
        .text("class", "Alias set", |(_, e)| e.map(|e| e.class.join(" "))).machines()
        .note("\\v{p}: family-wise probability of so strong a candidate if there were no effect. RMS: of the change that it makes to the torques.")
        .blocks(joints(campaigns).map(|j| rows(&j.findings)))
}

/// One size of an effect: which of how many.
type Sized<'a> = (&'a CampaignFindings, Option<(&'a EffectFinding, usize)>);

/// The same for people: one row a size, so that a shift in two directions has both.
#[rustfmt::skip]
pub fn found_in_print(campaigns: &[CampaignTorque]) -> Table {
    let estimate = |row| size(parameter(row));
    Described::<Sized>::new("knee_found", "Effects found by the loop, joint by joint")
        .text("campaign", "Campaign", |(f, _)| &f.campaign).machines()
        .text("joint", "Joint", |(f, _)| format!("{}, {} mm", joint(f), f.diameter_mm)).once()
        .text("found", "Found", |row| match row.1 {
            None => Some(verdict(row.0.verdict).to_owned()),
            Some(_) => first(row).map(|e| effect_with_form(&e.id, &e.form)),
        })
        .symbol("direction", "", |(_, e)| e.map_or_else(String::new, direction))
        .value("size", "Value", One, estimate)
        .interval("interval", "95% interval", One, estimate)
        .text("unit", "Unit", |row| Some(unit(&parameter(row)?.unit)))
        .number("stiffness_n_m", "1/\\v{C}", NPerM, Digits(2), |row| finite(first(row).and_then(stiffness)))
        .number("p_familywise", "\\v{p}", One, Digits(2), |row| finite(first(row).map(|e| e.p_familywise)))
        .number("rms_nm", "RMS", Nm, Decimals(2), |row| finite(first(row).map(|e| e.rms)))
        .note(
            "\\v{p}: family-wise probability of so strong a candidate if there were no effect. RMS: of the change that it makes to the torques. \\v{x} \
             and \\v{y}: components of a shift, in the frame of the bone that carries the attachment.",
        )
        .blocks(joints(campaigns).map(|j| sizes(&j.findings)))
}

fn parameter<'a>((_, effect): Sized<'a>) -> Option<&'a Parameter> {
    effect.and_then(|(e, k)| e.parameters.get(k))
}

/// The effect, in the row of its first size.
fn first<'a>((_, effect): Sized<'a>) -> Option<&'a EffectFinding> {
    effect.and_then(|(e, k)| (k == 0).then_some(e))
}

/// Which of several sizes this is; nothing for an effect with one.
fn direction((effect, k): (&EffectFinding, usize)) -> String {
    let name = effect.parameters.get(k).map(|p| p.name.replace('_', "\\_"));
    let name = name.filter(|_| effect.parameters.len() > 1);
    name.map_or_else(String::new, |name| format!("\\v{{{name}}}"))
}

fn sizes(found: &CampaignFindings) -> Vec<Sized<'_>> {
    let mut sizes = Vec::new();
    for (found, effect) in rows(found) {
        let count = effect.map_or(1, |e| e.parameters.len().max(1));
        sizes.extend((0..count).map(|k| (found, effect.map(|e| (e, k)))));
    }
    sizes
}

fn joint(found: &CampaignFindings) -> &str {
    found.part.as_deref().unwrap_or_default()
}

fn rows(found: &CampaignFindings) -> Vec<Found<'_>> {
    if found.effects.is_empty() {
        return vec![(found, None)];
    }
    found.effects.iter().map(|e| (found, Some(e))).collect()
}

/// Of a compliance in um/N its stiffness in N/m; of others none.
fn stiffness(effect: &EffectFinding) -> Option<f64> {
    let compliance = effect.parameters.first().filter(|p| p.unit == "um/N");
    compliance.map(|p| 1e6 / p.value)
}

type OfTest<'a> = (&'a CampaignFindings, &'a TestErrors);
type SizeOf = fn(&TestErrors) -> Option<Size>;
type Statistic = fn(&Size) -> Option<f64>;

/// By what a test is predicted: name in files, heading, statistics that people see.
const PREDICTED: [(&str, &str, &[&str], SizeOf); 4] = [
    ("rigid", "rigid", &["rmse_nm", "fvu", "max_nm"], |t| {
        t.before
    }),
    ("fitted", "loop", &["rmse_nm", "fvu", "max_nm"], |t| t.after),
    ("held_out", "held out", &["rmse_nm", "max_nm"], |t| {
        t.held_out
    }),
    ("from_largest", "largest", &[], |t| t.from_largest),
];
/// Statistics: name in files, decimals. Their units stand in the headings over several columns.
const STATISTICS: [(&str, usize, Statistic); 3] = [
    ("rmse_nm", 2, |s| Some(s.rmse)),
    ("fvu", 3, |s| s.fvu),
    ("max_nm", 2, |s| Some(s.max_abs)),
];

/// One row a test.
#[rustfmt::skip]
pub fn effects(campaigns: &[CampaignTorque]) -> Table {
    let mut table = Described::<OfTest>::new("knee_effects", "Errors of torque, rigid and with the effects that the loop found")
        .text("campaign", "Campaign", |(f, _)| &f.campaign).machines()
        .text("joint", "Joint", |(f, _)| joint(f)).machines()
        .count("diameter_mm", "⌀", Mm, |(f, _)| f.diameter_mm).machines()
        .text("session", "Test", |(_, t)| &t.session)
        .text("specimen", "Specimen", |(_, t)| &t.specimen).machines()
        .flag("takes_part", "In fits", |(_, t)| t.fitted)
        .flag("in_largest", "In largest", |(_, t)| t.in_largest).machines()
        .text("verdict", "Verdict", |(f, _)| verdict_id(f.verdict)).machines()
        .count("n", "\\v{n}", One, |(_, t)| t.before.map(|s| s.n));
    for (statistic, decimals, of) in STATISTICS {
        for (id, heading, shown, size) in PREDICTED {
            table = table.number(&format!("{id}_{statistic}"), heading, One, Decimals(decimals), move |(_, t)| size(t).as_ref().and_then(of));
            table = if shown.contains(&statistic) { table } else { table.machines() };
        }
    }
    table
        .number("own_offset_mm", "offset", Mm, Decimals(1), |(_, t)| t.own_offset_mm)
        .number("own_rmse_nm", "RMSE", Nm, Decimals(2), |(_, t)| t.with_own_offset.map(|s| s.rmse))
        .number("arm_rigid_mm", "Δ\\v{r} rigid", Mm, Decimals(1), |(_, t)| t.arm_before_m.map(mm)).machines()
        .number("arm_fitted_mm", "Δ\\v{r} after", Mm, Decimals(1), |(_, t)| t.arm_after_m.map(mm)).machines()
        .span("RMSE (N m)", "rigid_rmse_nm", "held_out_rmse_nm")
        .span("FVU", "rigid_fvu", "fitted_fvu")
        .span("Largest error (N m)", "rigid_max_nm", "held_out_max_nm")
        .span("Its own", "own_offset_mm", "own_rmse_nm")
        .note(
            "Held out: effects and sizes found without the actuator (none with one actuator). Its own: by how much the length of the test differs from what was fitted \
             to all, and the error with that, a lower bound for any value common to all tests. FVU: share of the variance that is not explained. \
             Tests without a yes are used in no fit; where every test of a joint is marked as doubtful, these are fitted here by themselves, and \
             in no other fit.",
        )
        .blocks(joints(campaigns).map(|j| j.tests.iter().map(|t| (&j.findings, t))))
}

type OfActuator<'a> = (&'a CampaignFindings, &'a ByHand);
type ReachedBy = fn(&ByHand) -> Option<Reached>;

/// Whose error: name in files, heading.
const BY: [(&str, &str, ReachedBy); 5] = [
    ("their_rigid", "rigid", |b| b.their_rigid),
    ("theirs", "by hand", |b| Some(b.theirs)),
    ("rigid", "rigid", |b| b.rigid),
    ("after", "loop", |b| b.after),
    ("held_out", "loop, held out", |b| b.held_out),
];

/// One row an actuator of the measurers.
#[rustfmt::skip]
pub fn by_hand(campaigns: &[CampaignTorque]) -> Table {
    let mut table = Described::<OfActuator>::new("knee_by_hand", "What the measurers reached by hand, and the loop on actuators of the same length")
        .text("campaign", "Campaign", |(f, _)| &f.campaign).machines()
        .text("joint", "Joint", |(f, _)| joint(f))
        .count("diameter_mm", "⌀", Mm, |(f, _)| f.diameter_mm)
        .text("actuator", "Actuator", |(_, b)| &b.name)
        .text("part", "By them", |(_, b)| &b.part);
    for (id, heading, of) in BY {
        if id == "rigid" {
            table = table.count("n", "\\v{n}", One, |(_, b)| b.readings);
        }
        table = table
            .number(&format!("{id}_rmse_nm"), heading, One, Decimals(2), move |(_, b)| of(b).map(|r| r.rmse_nm))
            .number(&format!("{id}_max_nm"), "max.", One, Decimals(2), move |(_, b)| of(b).map(|r| r.max_nm));
    }
    table
        .span("Measurers (N m)", "their_rigid_rmse_nm", "theirs_max_nm")
        .span("Here (N m)", "n", "held_out_max_nm")
        .note(
            "RMSE and largest size of the error. The measurers fitted by hand over years, with their own law of force and tests that they do not \
             name, so the errors of their rigid leg differ from these. Here every test of the actuator that is not excluded counts; held out means \
             that neither effects nor sizes are based on the actuator.",
        )
        .rows(joints(campaigns).flat_map(|j| j.by_hand.iter().map(|b| (&j.findings, b))))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wording::tests::example;

    #[test]
    fn a_shift_in_two_directions_has_two_rows() {
        let mut found = example();
        found.effects.truncate(1);
        let effect = &mut found.effects[0];
        let mut x = effect.parameters[0].clone();
        x.name = "x".to_owned();
        let y = Parameter {
            name: "y".to_owned(),
            ..x.clone()
        };
        effect.parameters = vec![x, y];
        let rows = sizes(&found);
        let directions: Vec<String> = rows
            .iter()
            .map(|r| r.1.map_or_else(String::new, direction))
            .collect();
        assert_eq!(directions, ["\\v{x}", "\\v{y}"]);
        assert!(first(rows[0]).is_some() && first(rows[1]).is_none());
        found.effects.clear();
        assert_eq!(sizes(&found).len(), 1);
    }
}
