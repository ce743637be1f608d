//! The law of a search.

use super::{Acts, Beside, Held, MixedLaw, Sizes, Slot, What};
use crate::data::Data;
use crate::library::{self, Column, Scope};
use crate::problem::{ForceProblem, component, mean_noted};
use pipeline_effects as effects;
use pipeline_findings::EffectFinding;
use pipeline_fit::Group;
use pipeline_inference::fit::{Fitted, Free, Setting};
use pipeline_inference::heldout::Unseen;
use pipeline_inference::problem::Problem;
use pipeline_inference::system::Variances;
use pipeline_inference::variance::Prior;
use pipeline_numerics::statistics::median;
use std::collections::BTreeSet;

impl MixedLaw {
    /// The law of a model, whose effects are named in `found`, and whose error on unseen specimens is `unseen_n`, N; none where its law is not the new one.
    pub fn of(
        group: &Group,
        problem: &ForceProblem,
        setting: &Setting,
        model: &Fitted,
        found: &[EffectFinding],
        unseen_n: Option<f64>,
    ) -> Option<Self> {
        let cap_length_m = problem.base.cap_length_m()?;
        let (beside, [largest_n, floor_n]) = problem.misfit_beside()?;
        let data = problem.data;
        let unseen = Unseen::new(setting, model);
        let active = |node: &usize| setting.active[*node];
        let of_sessions = data.specimen_of_session();
        let sessions = problem.sessions.iter().zip(&of_sessions);
        let taking_part: BTreeSet<usize> = sessions
            .filter(|(node, _)| active(node))
            .map(|(_, specimen)| *specimen)
            .collect();
        let slot = |free: &Free| match free {
            Free::Coefficient(k) => Slot::Coefficient(*k),
            Free::Value(t, k) => Slot::Value(*t, *k),
        };
        let terms = model.point.terms.iter();
        let (common_mean, root) = unseen.parameters_known();
        Some(Self {
            campaign: group.campaign.clone(),
            diameter_mm: group.diameter_mm,
            campaigns: data.campaigns.clone(),
            specimens: taking_part
                .iter()
                .map(|k| data.specimens[*k].clone())
                .collect(),
            lengths_m: taking_part.iter().map(|k| lengths_of(data, *k)).collect(),
            noted_contraction: mean_noted(&data.noted_contractions()),
            sessions: problem.sessions.iter().filter(|n| active(n)).count(),
            readings: problem.node()[..data.len()]
                .iter()
                .filter(|n| active(n))
                .count(),
            unseen_n,
            cap_length_m,
            shape: problem.base.shape(&data.conditions[0]).0,
            coefficients: model.point.coefficients.clone(),
            terms: terms
                .map(|(t, values)| held(data, &problem.library[*t], values, found))
                .collect(),
            origins: data.origins.clone(),
            largest_n,
            floor_n,
            beside,
            free: model.free.iter().map(slot).collect(),
            common_mean: common_mean.to_vec(),
            root: (0..root.n)
                .flat_map(|i| (0..=i).map(move |j| root.at(i, j)))
                .collect(),
            sd: sizes(problem, unseen.variances(), unseen.shown_by_class()),
        })
    }
}

/// Resting and contracted length of a specimen, m.
fn lengths_of(data: &Data, specimen: usize) -> [f64; 2] {
    let first = data.specimen.iter().position(|k| *k == specimen);
    first.map_or([f64::NAN; 2], |i| {
        let at = &data.conditions[i];
        [at.rest_length_m, at.contracted_length_m]
    })
}

fn held(data: &Data, term: &library::Term, values: &[f64], found: &[EffectFinding]) -> Held {
    let column = |k: usize, is_gain: bool| What::Column {
        name: data.extras[k].name.clone(),
        is_gain,
        scale: data.extras[k].scale,
    };
    let what = match term.what {
        library::What::Effect { effect, form, .. } => What::Effect {
            id: effects::all()[effect].id().to_owned(),
            form: effects::all()[effect].forms()[form].name.to_owned(),
        },
        library::What::Column(Column::Gain(k)) => column(k, true),
        library::What::Column(Column::Offset(k)) => column(k, false),
        library::What::Column(Column::Force) => What::Force,
        library::What::Column(Column::Pressure) => What::Pressure,
    };
    let class = term.id().map_or_else(Vec::new, |id| {
        let finding = found.iter().find(|e| e.id == id);
        finding.map_or_else(|| vec![id.to_owned()], |e| e.class.clone())
    });
    let sessions = term.acts_on.iter().zip(&data.sessions);
    let acts = match term.scope {
        Scope::All => Acts::All,
        Scope::From(_) | Scope::Levels(_) => Acts::Sessions {
            amplitude: sessions.map(|(a, id)| (id.clone(), *a)).collect(),
            later: matches!(term.scope, Scope::From(_)),
        },
    };
    Held {
        what,
        class,
        values: values.to_vec(),
        acts,
    }
}

fn sizes(problem: &ForceProblem, variances: &Variances, (means, noise): (&[f64], &[f64])) -> Sizes {
    let data = problem.data;
    let sd = |c: usize| variances.components[c];
    let declared = data.set_length_sd_mm.iter().copied();
    let declared: Vec<f64> = declared.filter(|sd| sd.is_finite()).collect();
    let all_declared = declared.len() == data.sessions.len();
    let of_declared = &problem.components()[component::DECLARED_LENGTH].scale;
    let declared_is_known = matches!(of_declared.prior, Prior::Fixed(_));
    // One more specimen is measured as the others were.
    let lengths = (0..data.specimens.len()).map(|k| problem.specimen_lengths_sd_mm(k));
    let (rest, contracted): (Vec<f64>, Vec<f64>) = lengths.map(|[r, c]| (r, c)).unzip();
    let all_contracted = (0..data.specimens.len()).all(|k| data.contracted_is_declared(k));
    let campaigns = data.campaigns.len();
    let corner = means.iter().copied().zip(noise.iter().copied());
    let pooled = |c: usize| if campaigns > 1 { sd(c) } else { 0.0 };
    Sizes {
        gain: sd(component::GAIN),
        rest_length_mm: median(&rest) * sd(component::REST_LENGTH),
        contracted_length_mm: median(&contracted) * sd(component::CONTRACTED_LENGTH),
        contraction: if all_contracted {
            0.0
        } else {
            sd(component::CONTRACTION)
        },
        set_length_mm: if all_declared {
            median(&declared) * sd(component::DECLARED_LENGTH)
        } else {
            sd(component::SET_LENGTH)
        },
        set_length_declared: all_declared && declared_is_known,
        declared_factor: sd(component::DECLARED_LENGTH),
        zero_n: sd(component::ZERO),
        session_misfit: sd(component::SESSION_MISFIT),
        stroke_misfit: problem.has_strokes().then(|| sd(component::STROKE_MISFIT)),
        campaign_gain: pooled(component::CAMPAIGN_GAIN),
        campaign_zero_n: pooled(component::CAMPAIGN_ZERO),
        noise_n: noise[..campaigns].to_vec(),
        corner_n: corner.skip(campaigns).take(crate::slack::BANDS).collect(),
    }
}

impl ForceProblem<'_> {
    /// What the common misfit is beside, and largest force and floor of its scale, N; none where the readings are too few for it.
    fn misfit_beside(&self) -> Option<(Beside, [f64; 2])> {
        let beside = self.law_in_misfit()?;
        Some((beside, self.misfit_sizes()))
    }
}
