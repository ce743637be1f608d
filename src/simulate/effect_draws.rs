//! The sizes of a campaign's effects: where each acts, and what was drawn.

use super::draw::DrawnSession;
use super::effect_places::Place;
use super::effect_tables::{EffectTruth, Scatter};
use super::effects::Per;
use super::truth::{Run, Truth};
use pipeline_base::random::Stream;
use serde::Serialize;

/// One effect of a campaign.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DrawnEffect {
    /// Id of the effect.
    pub id: &'static str,
    /// Name of its form.
    pub form: &'static str,
    /// Key of its size, unit included.
    pub size: &'static str,
    /// Size for each session and run, in their order in the truth; none where it does not act.
    pub values: Vec<Vec<Option<f64>>>,
}

/// The effects of a truth file with their sizes.
pub fn effects(truth: &Truth, sessions: &[DrawnSession]) -> Vec<DrawnEffect> {
    let numbered = truth.effects.iter().enumerate().map(|(k, effect)| {
        let earlier = truth.effects[..k].iter().filter(|e| e.id == effect.id);
        (effect, earlier.count())
    });
    let drawn = numbered.map(|(effect, ordinal)| {
        let of_session = |session: &DrawnSession| {
            let acts = acts(truth, &effect.place, session);
            let size = |run: &Run| acts.then(|| size(truth, effect, ordinal, session, *run));
            truth.runs.iter().map(size).collect()
        };
        DrawnEffect {
            id: effect.id,
            form: effect.form,
            size: effect.form().parameters[0].key,
            values: sessions.iter().map(of_session).collect(),
        }
    });
    drawn.collect()
}

fn acts(truth: &Truth, place: &Place, session: &DrawnSession) -> bool {
    let specimen = &truth.specimens[session.specimen].id;
    let own_id = &session.id[truth.campaign.len() + 1..];
    place.specimen.as_ref().is_none_or(|s| s == specimen)
        && place.session.as_ref().is_none_or(|s| s == own_id)
        && place.from_session.is_none_or(|n| session.place + 1 >= n)
}

/// The size in one log: drawn from a stream of the effect and of whatever shares the size, so that an effect more leaves the
/// others as they were.
fn size(
    truth: &Truth,
    effect: &EffectTruth,
    ordinal: usize,
    session: &DrawnSession,
    run: Run,
) -> f64 {
    let mean = effect.numbers()[0];
    let Some(Scatter { sd, per }) = effect.scatter else {
        return mean;
    };
    let (ordinal, number) = (ordinal.to_string(), run.number.to_string());
    let mut path = vec!["effect", effect.id, &ordinal];
    match per {
        Per::Session => path.push(&session.id),
        Per::Specimen => path.push(&truth.specimens[session.specimen].id),
        Per::Log => path.extend([session.id.as_str(), &number]),
    }
    let normal = Stream::new(truth.seed, &path).normal();
    let form = effect.form();
    let deviation = if form.two_batches {
        normal.signum()
    } else {
        normal
    };
    let size = form.parameters[0];
    (mean + sd * deviation).clamp(size.low, size.high)
}
