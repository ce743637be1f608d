//! Campaigns that scatter as a laboratory's rig does, as rows in memory: specimens of different gain, lengths that are set and recorded
//! with an error, a force zero of each session's own, and a law that is not exactly the model's. What the loop is designed on and judged on.
//!
//! | file | idea |
//! |---|---|
//! | [`families`] | two independent sets of constants: one to design with, one for the table that is published |
//! | [`draw`] | specimens and sessions, with everything that nobody wrote down |
//! | [`misfit`] | the smooth part of the law that the model lacks |
//! | [`schedule`] | set points and when they are read |
//! | [`forward`] | the force of a reading, given how specimen and session depart from what is recorded |
//! | [`rows`] | the readings, and their rows as the stage normalize gives them |
//! | [`mistakes`] | recording errors |
//! | [`generating`] | what the generating model says: log density of each specimen, errors, how strongly an effect shows |
//!
//! Effects are those of [`super::effects`], in any of their forms, with equations of their own: none of an effect is shared with the search. The law
//! is shared: both call [`pipeline_mechanics::models::new`] (force paper, Eqs. 5 to 9), here with other coefficients and a misfit.

pub mod draw;
pub mod families;
pub mod forward;
pub mod generating;
pub mod misfit;
pub mod mistakes;
pub mod rows;
pub mod schedule;
#[cfg(test)]
mod tests;

pub use draw::{Drawn, Muscle, SetUp, Sizes};
pub use families::Family;
pub use generating::Generating;
pub use mistakes::{Mistake, Mistaken};
pub use schedule::Pace;

use pipeline_base::group::Group;
use pipeline_base::row::Row;

/// Name of every campaign.
pub const CAMPAIGN: &str = "rig-like";
/// Uninflated inner diameter, mm.
pub const DIAMETER_MM: u32 = 10;

/// How much everything scatters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Scatter {
    /// As on the laboratory's rig: see [`draw`].
    RigLike,
    /// Specimens 2% apart and noise; every length is as recorded, the law is the model's.
    Clean,
}

/// An effect that is put in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Put {
    /// Id in [`super::effects`].
    pub id: &'static str,
    /// Name of the form; "" is the plain operator.
    pub form: &'static str,
    /// Its size in the unit of the form's first parameter (a gain is 1 + what it adds).
    pub size: f64,
    /// The form's other numbers, in their order; its defaults where the list ends.
    pub others: &'static [f64],
    /// It acts on the sessions from this part of the campaign on, in the order of time: 0 for all.
    pub from: f64,
}

/// What is simulated.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Which constants.
    pub family: Family,
    /// How much everything scatters.
    pub scatter: Scatter,
    /// Number of specimens; drawn from 4 to 8 where none is given.
    pub specimens: Option<usize>,
    /// How set points are read.
    pub pace: Pace,
    /// Effects.
    pub effects: Vec<Put>,
    /// A recording error.
    pub mistake: Option<Mistake>,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            family: Family::Design,
            scatter: Scatter::RigLike,
            specimens: None,
            pace: Pace::Staircase,
            effects: Vec::new(),
            mistake: None,
        }
    }
}

/// A campaign and what is not written down in it.
#[derive(Clone, Debug)]
pub struct Campaign {
    /// The rows, as the stage normalize gives them.
    pub rows: Vec<Row>,
    /// Everything else.
    pub truth: Truth,
}

/// What is not written down in the rows.
#[derive(Clone, Debug)]
pub struct Truth {
    /// What was asked for.
    pub settings: Settings,
    /// Specimens, sessions and sizes as drawn.
    pub drawn: Drawn,
    /// The reading behind each row, before any mistake of recording.
    pub readings: Vec<rows::Taken>,
    /// The recording error, if any.
    pub mistaken: Option<Mistaken>,
}

/// Measures a campaign. Equal seeds have equal specimens, scatter and noise, whatever effects are put in.
///
/// # Panics
/// If an effect or form is not in [`super::effects`]: they are constants of the caller.
pub fn campaign(seed: u64, settings: &Settings) -> Campaign {
    let drawn = Drawn::new(seed, settings);
    let readings = rows::measure(seed, settings, &drawn);
    let mut rows = rows::rows(seed, settings, &drawn, &readings);
    let mistaken = settings
        .mistake
        .map(|m| mistakes::make(m, settings.family, seed, &drawn, &mut rows));
    let truth = Truth {
        settings: settings.clone(),
        drawn,
        readings,
        mistaken,
    };
    Campaign { rows, truth }
}

/// The group that the stage diagnose is given with the rows.
pub fn group() -> Group {
    Group {
        campaign: CAMPAIGN.to_owned(),
        diameter_mm: DIAMETER_MM,
        members: vec![CAMPAIGN.to_owned()],
        simulated: true,
    }
}
