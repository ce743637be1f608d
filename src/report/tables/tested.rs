//! `tested`, `detection_limits`: the candidates of the first step of every search; the smallest size of every effect that a campaign could have
//! shown, and what it cannot show at all.

use super::findings::acts_on;
use crate::described::*;
use crate::input::ReportInput;
use pipeline_findings::{CampaignFindings, DetectionLimit, NotMeasurable, Tested, WhyNot};

/// One row a candidate.
#[rustfmt::skip]
pub fn tested(input: &ReportInput) -> Table {
    Described::<(&CampaignFindings, &Tested)>::found("tested", "The candidates of the first step of the search")
        .text("id", "Candidate", |(_, t)| &t.id)
        .flag("is_column", "Column", |(_, t)| t.is_column)
        .text("form", "Form", |(_, t)| &t.form)
        .text("acts_on", "Acts on", |(_, t)| acts_on(t.acts_on))
        .number("log_likelihood_gain", "Gain", One, Decimals(1), |(_, t)| finite(t.log_likelihood_gain))
        .number("amplitude", "Size", One, Digits(2), |(_, t)| finite(t.amplitude))
        .text("unit", "Unit", |(_, t)| &t.unit)
        .number("p_familywise", "\\v{p}", One, Digits(2), |(_, t)| finite(t.p_familywise))
        .note("\\v{Gain}: in log-likelihood, of the linearised candidate added alone to the model without effects; those of an effect found are \
             from a full fit. \\v{Size}: of the linearised candidate. \\v{p}: probability of a candidate as strong as this anywhere.")
        .of_all(input, |found| found.tested.iter().collect())
}

/// What a row says: how small an effect is seen, or why it cannot be.
type Limit<'a> = Result<&'a DetectionLimit, &'a NotMeasurable>;

/// One row an effect.
#[rustfmt::skip]
pub fn detection_limits(input: &ReportInput) -> Table {
    let caption = "The smallest size of every effect that would have been detected in 80 of 100 such campaigns";
    Described::<(&CampaignFindings, Limit)>::found("detection_limits", caption)
        .text("id", "Effect", |(_, l)| l.map_or_else(|n| &n.id, |l| &l.id))
        .text("form", "Form", |(_, l)| l.map_or_else(|n| n.form.as_ref(), |l| Some(&l.form)))
        .number("smallest", "Smallest", One, Digits(2), |(_, l)| finite(l.ok().map(|l| l.smallest)))
        .text("unit", "Unit", |(_, l)| l.ok().map(|l| &l.unit))
        .number("identifiable_share", "Identifiable share", One, Decimals(2), |(_, l)| finite(l.ok().map(|l| l.identifiable_share)))
        .text("not_measurable", "Not measurable", |(_, l)| l.err().map(|n| reason(n.reason)))
        .text("by", "By", |(_, l)| l.err().map(|n| &n.by))
        .note(
            "\\v{Identifiable share}: what the fitted coefficients leave of the effect's sensitivity. \\v{Not measurable}: absorbed by a coefficient or an effect, no column for it, \
             beyond its physical bounds, or without any change of the predictions.",
        )
        .of_all(input, |found| {
            let limits = found.detection_limits.iter().map(Ok);
            limits.chain(found.not_measurable.iter().map(Err)).collect()
        })
}

fn reason(why: WhyNot) -> &'static str {
    match why {
        WhyNot::Absorbed => "absorbed",
        WhyNot::NoColumn => "no_column",
        WhyNot::Bound => "bound",
        WhyNot::NoTrace => "no_trace",
    }
}
