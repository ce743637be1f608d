//! `tested`, `detection_limits`: the candidates of the first step of every search; the smallest size of every effect, and dependence on a column,
//! that a campaign could have shown, and what it cannot show at all.

use super::findings::acts_on;
use crate::described::*;
use crate::input::ReportInput;
use pipeline_findings::{
    CampaignFindings, ColumnLimit, DetectionLimit, NotMeasurable, Tested, WhyNot,
};

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

/// What a row says.
#[derive(Clone, Copy)]
enum Limit<'a> {
    /// How small an effect is seen.
    Effect(&'a DetectionLimit),
    /// How small a dependence on a column is seen.
    Column(&'a ColumnLimit),
    /// Why an effect cannot be seen.
    Not(&'a NotMeasurable),
}

impl<'a> Limit<'a> {
    fn id(self) -> &'a String {
        match self {
            Self::Effect(l) => &l.id,
            Self::Column(l) => &l.column,
            Self::Not(n) => &n.id,
        }
    }

    fn form(self) -> Option<&'a String> {
        match self {
            Self::Effect(l) => Some(&l.form),
            Self::Column(l) => Some(&l.shape),
            Self::Not(n) => n.form.as_ref(),
        }
    }

    fn smallest(self) -> Option<f64> {
        match self {
            Self::Effect(l) => Some(l.smallest),
            Self::Column(l) => l.smallest,
            Self::Not(_) => None,
        }
    }

    fn unit(self) -> Option<&'a String> {
        match self {
            Self::Effect(l) => Some(&l.unit),
            Self::Column(l) => Some(&l.unit),
            Self::Not(_) => None,
        }
    }

    fn share(self) -> Option<f64> {
        match self {
            Self::Effect(l) => Some(l.identifiable_share),
            Self::Column(_) | Self::Not(_) => None,
        }
    }

    fn reason(self) -> Option<&'static str> {
        match self {
            Self::Not(n) => Some(reason(n.reason)),
            Self::Column(l) if l.smallest.is_none() => Some(reason(WhyNot::Bound)),
            Self::Effect(_) | Self::Column(_) => None,
        }
    }

    fn by(self) -> Option<&'a String> {
        match self {
            Self::Not(n) => n.by.as_ref(),
            Self::Effect(_) | Self::Column(_) => None,
        }
    }
}

/// One row an effect or column.
#[rustfmt::skip]
pub fn detection_limits(input: &ReportInput) -> Table {
    let caption = "The smallest size of every effect, and dependence on every column, that would have been detected in 80 of 100 such campaigns";
    Described::<(&CampaignFindings, Limit)>::found("detection_limits", caption)
        .text("id", "Effect", |(_, l)| l.id())
        .flag("is_column", "Column", |(_, l)| matches!(l, Limit::Column(_)))
        .text("form", "Form", |(_, l)| l.form())
        .number("smallest", "Smallest", One, Digits(2), |(_, l)| finite(l.smallest()))
        .text("unit", "Unit", |(_, l)| l.unit())
        .number("identifiable_share", "Identifiable share", One, Decimals(2), |(_, l)| finite(l.share()))
        .text("not_measurable", "Not measurable", |(_, l)| l.reason())
        .text("by", "By", |(_, l)| l.by())
        .note(
            "\\v{Smallest}: of a column the change over its range, of the force in N or as a share of it. \\v{Identifiable share}: what the fitted coefficients leave of the effect's \
             sensitivity. \\v{Not measurable}: absorbed by a coefficient or an effect, no column for it, beyond its physical bounds, or without any change of the predictions.",
        )
        .of_all(input, |found| {
            let effects = found.detection_limits.iter().map(Limit::Effect);
            let columns = found.column_limits.iter().map(Limit::Column);
            let not = found.not_measurable.iter().map(Limit::Not);
            effects.chain(columns).chain(not).collect()
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
