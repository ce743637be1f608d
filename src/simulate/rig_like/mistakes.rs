//! Mistakes of recording: what a person does with a keyboard or a cable, in one session or for one specimen.

use super::draw::Drawn;
use super::families::Family;
use pipeline_base::row::Row;
use pipeline_mechanics::models::P_620_KPA;

/// A mistake.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Mistake {
    /// Force and pressure of a session are exchanged.
    SwappedColumns,
    /// The force of a session has the wrong sign.
    Sign,
    /// The set length of a session is written down 10 mm off.
    SetLength,
    /// The resting length of a specimen is written down 10 mm off.
    RestLength,
}

/// A mistake that was made.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mistaken {
    /// What.
    pub mistake: Mistake,
    /// Id of the session, or of the specimen where the resting length is wrong.
    pub group: String,
    /// Ids of the sessions concerned.
    pub sessions: Vec<String>,
}

/// A wrong length is off by so much, m.
const WRONG_M: f64 = 0.01;

/// Makes a mistake in the rows.
pub fn make(
    mistake: Mistake,
    family: Family,
    seed: u64,
    drawn: &Drawn,
    rows: &mut [Row],
) -> Mistaken {
    let mut stream = family.stream(seed, &["mistake"]);
    let setup = &drawn.setups[stream.below(drawn.setups.len())];
    let sign = if stream.uniform() < 0.5 { -1.0 } else { 1.0 };
    let whole = mistake == Mistake::RestLength;
    let specimen = &drawn.muscles[setup.muscle].id;
    let concerned = |r: &Row| {
        if whole {
            r.specimen == *specimen
        } else {
            r.session == setup.id
        }
    };
    for row in rows.iter_mut().filter(|r| concerned(r)) {
        match mistake {
            Mistake::SwappedColumns => std::mem::swap(&mut row.force_n, &mut row.pressure_kpa),
            Mistake::Sign => row.force_n = -row.force_n,
            Mistake::SetLength => row.length_m += sign * WRONG_M,
            Mistake::RestLength => row.rest_length_m += sign * WRONG_M,
        }
        normalise(row);
    }
    let own = |s: &&super::SetUp| s.muscle == setup.muscle;
    Mistaken {
        mistake,
        group: if whole { specimen } else { &setup.id }.clone(),
        sessions: if whole {
            let all = drawn.setups.iter().filter(own);
            all.map(|s| s.id.clone()).collect()
        } else {
            vec![setup.id.clone()]
        },
    }
}

/// The dimensionless numbers of what is recorded now.
fn normalise(row: &mut Row) {
    let rest = row.rest_length_m;
    row.contraction = (rest - row.length_m) / rest;
    row.contraction_rel = row.contraction / ((rest - row.contracted_length_m) / rest);
    row.pressure_rel = row.pressure_kpa / P_620_KPA;
}
