//! `findings`: what every campaign's model lacks, one row a parameter of an effect, a column without a name, or a campaign without either.

use crate::described::*;
use crate::input::ReportInput;
use crate::wording::name;
use crate::wording::number::cells;
use pipeline_findings::{ActsOn, CampaignFindings, EffectFinding, Parameter, Unexplained};

/// What stands in the place of an effect where none of the library explains the dependence on a column.
const UNEXPLAINED: &str = "unexplained";

/// What a row says.
#[derive(Clone, Copy)]
enum Found<'a> {
    Effect(&'a EffectFinding, &'a Parameter),
    Unexplained(&'a Unexplained),
    Nothing,
}

/// All campaigns.
#[rustfmt::skip]
pub fn findings(input: &ReportInput) -> Table {
    Described::<(&CampaignFindings, Found)>::found("findings", "What the model of every campaign lacks")
        .text("verdict", "Verdict", |(found, _)| name::verdict_id(found.verdict)).machines()
        .text("effect", "Effect", |(_, f)| f.effect().map(|e| e.id.as_str()).or(f.unexplained().map(|_| UNEXPLAINED)))
        .text("class", "Alias set", |(_, f)| f.effect().map(|e| e.class.join(" "))).machines()
        .text("form", "Form", |(_, f)| f.effect().map(|e| &e.form)).machines()
        .text("acts_on", "Acts on", |(_, f)| f.effect().map(|e| acts_on(e.acts_on))).machines()
        .text("column", "Column", |(_, f)| f.effect().map_or_else(|| Some(&f.unexplained()?.column), |e| e.column.as_ref()))
        .text("from", "From", |(_, f)| f.effect().map(|e| &e.from)).machines()
        .text("parameter", "Parameter", |(_, f)| f.parameter().map(|p| &p.name))
        .value("value", "Value", One, |(_, f)| size(f.parameter()))
        .interval("ci", "95%", One, |(_, f)| size(f.parameter()))
        .text("unit", "Unit", |(_, f)| f.parameter().map(|p| &p.unit))
        .number("p_familywise", "\\v{p}", One, Digits(2), |(_, f)| f.either(|e| Some(e.p_familywise), |u| Some(u.p_familywise)))
        .number("log_likelihood_gain", "Gain", One, Decimals(1), |(_, f)| f.either(|e| e.log_likelihood_gain, |u| u.log_likelihood_gain))
        .number("p_form", "\\v{p} (form)", One, Digits(2), |(_, f)| finite(f.effect().and_then(|e| Some(e.free_form.as_ref()?.p))))
        .number("found_in_folds", "In folds", One, Percent(0), |(_, f)| finite(f.effect().and_then(|e| e.found_in_folds)))
        .flag("negligible", "Negligible", |(_, f)| f.effect().map(|e| e.negligible)).machines()
        .number("rms", "RMS", One, Digits(3), |(_, f)| finite(f.effect().map(|e| e.rms)))
        .number("share_of_variance", "Share", One, Decimals(3), |(_, f)| finite(f.unexplained().map(|u| u.share_of_variance))).machines()
        .note(
            "\\v{p}: probability of a candidate as strong as this anywhere. \\v{Gain}: in marginal log-likelihood, with variances \
             re-estimated. \\v{p} (form): probability of as large a \
             change of the size with the effect's own argument, where one size is enough. \\v{In folds}: share of the held-out searches that also \
             find it. \\v{RMS}: of what it does to the readings, in the unit of the errors. \\v{unexplained}: a dependence on a column for which \
             the library has no effect.",
        )
        .of_all(input, rows)
}

fn rows(found: &CampaignFindings) -> Vec<Found<'_>> {
    let effects = found.effects.iter();
    let effects = effects.flat_map(|e| e.parameters.iter().map(move |p| Found::Effect(e, p)));
    let unexplained = found.unexplained.iter().map(Found::Unexplained);
    let all: Vec<Found> = effects.chain(unexplained).collect();
    if all.is_empty() {
        vec![Found::Nothing]
    } else {
        all
    }
}

impl<'a> Found<'a> {
    fn effect(self) -> Option<&'a EffectFinding> {
        match self {
            Found::Effect(effect, _) => Some(effect),
            Found::Unexplained(_) | Found::Nothing => None,
        }
    }

    fn parameter(self) -> Option<&'a Parameter> {
        match self {
            Found::Effect(_, parameter) => Some(parameter),
            Found::Unexplained(_) | Found::Nothing => None,
        }
    }

    fn unexplained(self) -> Option<&'a Unexplained> {
        match self {
            Found::Unexplained(unexplained) => Some(unexplained),
            Found::Effect(..) | Found::Nothing => None,
        }
    }

    /// A number that effects and columns without a name both have.
    fn either(
        self,
        effect: fn(&EffectFinding) -> Option<f64>,
        unexplained: fn(&Unexplained) -> Option<f64>,
    ) -> Option<f64> {
        let of_effect = self.effect().map(effect);
        finite(of_effect.or(self.unexplained().map(unexplained)).flatten())
    }
}

/// On what an effect acts, in data files.
pub(super) fn acts_on(acts_on: ActsOn) -> &'static str {
    match acts_on {
        ActsOn::All => "all",
        ActsOn::Levels => "levels",
        ActsOn::From => "from",
    }
}

/// Value and interval of a parameter; empty where there is none.
pub(super) fn size(parameter: Option<&Parameter>) -> [Cell; 2] {
    parameter.map_or([Cell::Empty, Cell::Empty], |p| {
        cells(p.value, p.ci_low, p.ci_high)
    })
}
