//! The readings of a session against a law and the scatter of other actuators.
//!
//! F_i = (1 + u) F(P_i, l_i + d) + z: gain u of the actuator, set length d and zero z of the session, each normal about 0 with the standard
//! deviation that the residual search found among others ([`CampaignFindings::scatter`]; at one length a contracted length that is off shows as a
//! set length that is, by the relative contraction times as much), and a miss with the error that this search had on specimens that it did not
//! know, their own gain and lengths known. The estimates are the mode; far out means many of those standard deviations.
//!
//! Recording errors are looked for by the residual search's own function ([`recording::recording_errors`]), among the readings of the other
//! sessions and beside the effects that it found.

use crate::{Check, NotCompared, Own, Seen, State, others};
use pipeline_base::digest::Digest;
use pipeline_base::row::Row;
use pipeline_base::session::{Kind, Session};
use pipeline_config::FitOptions;
use pipeline_diagnose::base::Base;
use pipeline_diagnose::data::Data;
use pipeline_diagnose::library::What;
use pipeline_diagnose::recording::{self, Law};
use pipeline_diagnose::settings;
use pipeline_effects as effects;
use pipeline_findings::{
    ActsOn, CampaignFindings, EffectFinding, Findings, NotedContractions, RecordingError,
};
use pipeline_fit::equations::cap_length_m;
use pipeline_fit::{is_fitted, is_usable};
use pipeline_mechanics::models::P_620_KPA;
use pipeline_mechanics::models::new;
use pipeline_numerics::cholesky::Cholesky;
use pipeline_numerics::matrix::{Matrix, norm};
use pipeline_numerics::statistics::{median, sd_by_median, sum_of_squares};
use std::collections::{BTreeMap, BTreeSet};

/// What a run knows of other sessions.
#[derive(Debug, Default)]
pub struct Known {
    /// Their readings.
    pub rows: Vec<Row>,
    /// What the residual search found.
    pub findings: Option<Findings>,
    /// Options of the fits.
    pub fit: FitOptions,
    /// Where their raw files are, by contents.
    pub files: BTreeMap<Digest, Vec<RawFile>>,
}

/// A raw file of a session.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RawFile {
    /// The session's id.
    pub session: String,
    /// The file, relative to the session's folder.
    pub file: String,
}

impl Known {
    /// Whether there was no run.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty() && self.findings.is_none()
    }
}

/// A reading with what is expected of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Expected {
    /// Log.
    pub log: String,
    /// Gauge pressure, kPa.
    pub pressure_kpa: f64,
    /// Measured, N.
    pub force_n: f64,
    /// By the law of the others, N.
    pub law_n: f64,
    /// With the session's own gain, set length and zero, N.
    pub own_n: f64,
}

/// What comes of the comparison.
pub(crate) struct Compared {
    pub checks: Vec<Check>,
    pub against: Option<String>,
    pub expected: Vec<Expected>,
    /// How the readings suit others; none of torques, and of diameters that no law is known of.
    pub suit: Option<Suit>,
}

/// How readings suit a law of others.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Suit {
    pub readings: usize,
    /// Gain of the actuator and set length, in standard deviations of others.
    pub deviations: [f64; 2],
    /// What the readings leave open of both, as a share of these standard deviations.
    pub open: [f64; 2],
    /// Standard error of the gain (1 is that of the law) by the readings alone.
    pub gain_se: f64,
    /// What is left beside both and the zero, root mean square, N.
    pub rms_n: f64,
    /// What is usual, N.
    pub usual_n: f64,
}

impl Suit {
    /// Whether there are none, or something of them is far out.
    pub fn is_unusual(&self) -> bool {
        let is_far = self.deviations.iter().any(|d| d.abs() > FAR);
        self.readings == 0 || is_far || self.rms_n > LEFT.0 * self.usual_n
    }

    /// Whether they tell the gain of the actuator well enough to tell a unit or a sign by it.
    pub fn tells_gain(&self) -> bool {
        self.readings > OWN && self.gain_se < TELLS_A_UNIT
    }

    /// How far out they are, as one number to compare descriptions by.
    pub fn off(&self) -> f64 {
        let left = self.rms_n / self.usual_n;
        self.deviations.iter().map(|d| d * d).sum::<f64>() + left * left
    }
}

/// Standard deviations from which somebody should look.
const FAR: f64 = 3.0;
/// What is left, in usual ones, from which somebody should look, and from which the session is of no use.
const LEFT: (f64, f64) = (2.0, 5.0);
/// Share of the standard deviation among others that readings may leave open of what they tell.
const LEFT_OPEN: f64 = 0.5;
/// Numbers that are estimated of a session.
const OWN: usize = 3;
/// Standard error of a gain by which a unit or sign can be told: units of force differ by factors of 4 and more.
const TELLS_A_UNIT: f64 = 0.2;
/// Scatter where no run says any: see [`settings`].
const USUAL_LEFT: f64 = 0.03;
/// Steps to the mode.
const STEPS: usize = 20;
/// Fewest other sessions among which recording errors are looked for.
const FEWEST_SESSIONS: usize = 3;

/// The law of others with their scatter.
struct Population {
    name: String,
    /// b1, b2, c0, c1, c2.
    coefficients: [f64; 5],
    cap_length_m: f64,
    gain_sd: f64,
    length_sd_mm: f64,
    /// What noted contractions are worth.
    noted: Option<NotedContractions>,
    /// Contracted length of an actuator among those that are noted alike, share of its resting length.
    contracted_sd: f64,
    zero_sd_n: f64,
    left_n: f64,
    /// Gain and set length (mm) that other sessions have by this law, in the middle; and how they scatter about it.
    usual: [Usual; 2],
    /// Other sessions of which that was learned; none where they are too few.
    others: usize,
}

/// What is usual among other sessions.
#[derive(Clone, Copy)]
struct Usual {
    middle: f64,
    sd: f64,
}

/// Holds the readings against what is known.
pub(crate) fn compared(session: &Session, rows: &[Row], known: &Known) -> Compared {
    let has_logs = session.logs.iter().any(|l| !l.is_zero);
    let not = |why, suit| Compared {
        checks: vec![Check {
            log: None,
            state: match why {
                NotCompared::NoReadings if has_logs => State::Bad,
                _ => State::Fine,
            },
            seen: Seen::NotCompared { why },
        }],
        against: None,
        expected: Vec::new(),
        suit,
    };
    if session.kind == Kind::KneeTorque {
        return not(NotCompared::Torque, None);
    }
    let rows: Vec<&Row> = rows.iter().filter(|r| is_readable(r)).collect();
    if rows.is_empty() {
        return not(NotCompared::NoReadings, Some(Suit::default()));
    }
    let Some(population) = population(session, &rows, known) else {
        return not(NotCompared::NoLaw, None);
    };
    let (own, suit) = population.suit(&rows);
    let expected: Vec<Expected> = rows
        .iter()
        .map(|r| Expected {
            log: r.log.clone(),
            pressure_kpa: r.pressure_kpa,
            force_n: r.force_n,
            law_n: population.force(r, [0.0; 3]),
            own_n: population.force(r, own),
        })
        .collect();
    let mut checks = population.checks(own, &suit);
    let mistakes = mistakes(session, &rows, known);
    checks.extend(mistakes.into_iter().map(|error| Check {
        log: None,
        state: State::Bad,
        seen: Seen::Mistake { error },
    }));
    Compared {
        checks,
        against: Some(population.name),
        expected,
        suit: Some(suit),
    }
}

/// How the readings of a session suit others; none where there are none, or no law.
pub(crate) fn suit(session: &Session, rows: &[Row], known: &Known) -> Option<Suit> {
    let rows: Vec<&Row> = rows.iter().filter(|r| is_readable(r)).collect();
    let population = population(session, &rows, known)?;
    Some(population.suit(&rows).1)
}

/// Measured forces and what the published law has for them.
pub(crate) struct ByLaw {
    pub diameter_mm: u32,
    /// Measured, and by the law, N.
    pub forces: Vec<(f64, f64)>,
    /// F_620 of the resting length, N.
    pub largest_n: f64,
}

/// The readings beside the published law; none where there are none, or no law of the diameter.
pub(crate) fn by_law(rows: &[&Row], known: &Known) -> Option<ByLaw> {
    let rows: Vec<&Row> = rows.iter().copied().filter(|r| is_readable(r)).collect();
    let first = rows.first()?;
    let diameter_mm = diameter_mm(first);
    let cap_length_m = cap_length_m(diameter_mm, &known.fit);
    let law = Population::published(first, cap_length_m)?;
    let [b1, b2, ..] = law.coefficients;
    let forces = rows.iter().map(|r| (r.force_n, law.force(r, [0.0; 3])));
    Some(ByLaw {
        diameter_mm,
        forces: forces.collect(),
        largest_n: new::f620(b1, b2, cap_length_m, first.rest_length_m),
    })
}

/// A session may be looked at that its owner has left out of fits.
fn is_readable(row: &Row) -> bool {
    let included = Row {
        excluded: false,
        ..row.clone()
    };
    is_usable(&included) && row.length_m.is_finite()
}

fn diameter_mm(row: &Row) -> u32 {
    row.diameter_mm.round() as u32
}

/// The law and scatter of others of the diameter: of the session's campaign, else of the pool, else of the campaign with most specimens; else the
/// published law with usual scatter. Measured actuators are not compared with simulated ones.
fn population(session: &Session, rows: &[&Row], known: &Known) -> Option<Population> {
    let first = rows.first()?;
    let diameter_mm = diameter_mm(first);
    let cap = cap_length_m(diameter_mm, &known.fit);
    let found = found(session, diameter_mm, known)
        .filter(|c| c.part.is_none())
        .filter_map(|c| Some((c, Population::of(c, 1e3 * first.rest_length_m, cap)?)))
        .max_by_key(|(c, _)| (c.campaign == session.campaign, c.design.specimens));
    let population = match found {
        Some((_, population)) => population,
        None => Population::published(first, cap)?,
    };
    Some(population.among(rows, &alike(session, first, known)))
}

/// Mean of eps* of a session's readings: what a set length is off by, for each millimetre that the contracted length is.
fn mean_relative_contraction(rows: &[&Row]) -> f64 {
    let of = |r: &&Row| (r.rest_length_m - r.length_m) / (r.rest_length_m - r.contracted_length_m);
    rows.iter().map(of).sum::<f64>() / rows.len() as f64
}

/// What was found of forces of the diameter: of simulated actuators for a simulated session, of measured ones for any other.
fn found<'k>(
    session: &Session,
    diameter_mm: u32,
    known: &'k Known,
) -> impl Iterator<Item = &'k CampaignFindings> {
    let simulated = session.is_simulated();
    let campaigns = known.findings.iter().flat_map(|f| &f.campaigns);
    campaigns
        .filter(move |c| c.diameter_mm == diameter_mm && c.unit == "N" && c.simulated == simulated)
}

/// The readings of other sessions that the session is compared with: of its campaign, or where these are few of its diameter.
fn alike<'r>(session: &Session, first: &Row, known: &'r Known) -> Vec<&'r Row> {
    let diameter_mm = diameter_mm(first);
    let simulated = session.is_simulated();
    let of_diameter = |r: &&Row| {
        let same = self::diameter_mm(r) == diameter_mm && r.simulated == simulated;
        same && is_usable(r) && is_fitted(r)
    };
    let all: Vec<&Row> = others(&known.rows, session).filter(of_diameter).collect();
    let of_campaign = all.iter().filter(|r| r.campaign == session.campaign);
    let of_campaign: Vec<&Row> = of_campaign.copied().collect();
    if by_session(&of_campaign).len() >= FEWEST_SESSIONS {
        of_campaign
    } else {
        all
    }
}

fn by_session<'r>(rows: &[&'r Row]) -> BTreeMap<&'r str, Vec<&'r Row>> {
    let mut sessions: BTreeMap<&str, Vec<&Row>> = BTreeMap::new();
    for row in rows {
        sessions.entry(&row.session).or_default().push(row);
    }
    sessions
}

impl Population {
    /// The published law of a diameter with typical scatter.
    fn published(first: &Row, cap_length_m: f64) -> Option<Self> {
        let coefficients = new::published(diameter_mm(first), new::SYMBOLS)?;
        let [b1, b2, ..] = coefficients;
        let sds = [settings::USUAL_GAIN, settings::USUAL_SET_LENGTH_MM];
        Some(Self {
            name: "the published law, with typical scatter".to_owned(),
            coefficients,
            cap_length_m,
            gain_sd: sds[0],
            length_sd_mm: sds[1],
            noted: None,
            contracted_sd: settings::USUAL_CONTRACTION,
            zero_sd_n: settings::USUAL_ZERO_N,
            left_n: USUAL_LEFT * new::f620(b1, b2, cap_length_m, first.rest_length_m),
            usual: sds.map(|sd| Usual { middle: 0.0, sd }),
            others: 0,
        })
    }

    /// With what other sessions have by this law: those of one campaign may all be stronger than the law has it, or longer.
    fn among(mut self, own: &[&Row], others: &[&Row]) -> Self {
        let [gain, length, _] = self.sds(own);
        self.usual = [gain, length].map(|sd| Usual { middle: 0.0, sd });
        let sessions = by_session(others);
        if sessions.len() < FEWEST_SESSIONS {
            return self;
        }
        self.others = sessions.len();
        let own: Vec<[f64; 3]> = sessions.values().map(|rows| self.mode(rows).0).collect();
        let expected: Vec<[f64; 3]> = sessions.values().map(|rows| self.sds(rows)).collect();
        for (k, usual) in self.usual.iter_mut().enumerate() {
            let values: Vec<f64> = own.iter().map(|x| x[k]).collect();
            usual.middle = median(&values);
            // Each by what is expected of it: a contracted length that is off shows most in a session that is shortened most.
            let off = values.iter().zip(&expected);
            let off: Vec<f64> = off
                .map(|(x, sds)| (x - usual.middle).abs() / sds[k])
                .collect();
            usual.sd *= sd_by_median(&off).max(1.0);
        }
        self
    }

    /// What the search says of a campaign; none where it has no law of this kind, or held nothing out.
    fn of(found: &CampaignFindings, rest_length_mm: f64, cap_length_m: f64) -> Option<Self> {
        let coefficient = |name: &str| {
            let mut all = found.coefficients.iter();
            all.find(|c| c.name == name).map(|c| c.before)
        };
        let gain_sd = found.scatter_sd("specimen_variation")?;
        let length_sd_mm = found.scatter_sd("length_offset")?;
        Some(Self {
            name: format!("the null model of {} (without effects)", found.campaign),
            coefficients: [
                coefficient("b1")?,
                1.0 / coefficient("1/b2")?,
                coefficient("c0")?,
                coefficient("c1")?,
                coefficient("c2")?,
            ],
            cap_length_m,
            gain_sd,
            length_sd_mm,
            noted: found.noted_contractions,
            contracted_sd: found.contracted_sd_mm(rest_length_mm) / rest_length_mm,
            usual: [gain_sd, length_sd_mm].map(|sd| Usual { middle: 0.0, sd }),
            others: 0,
            zero_sd_n: found.scatter_sd("force_zero_offset")?,
            left_n: found.before.rmse_heldout_calibrated?,
        })
    }

    /// What an actuator contracts by at 620 kPa, m: as declared, or as others are of whom the same was noted.
    fn stroke_m(&self, row: &Row) -> f64 {
        let noted = row.rest_length_m - row.contracted_length_m;
        match &self.noted {
            Some(others) if !row.contracted_length_sd_m.is_finite() => {
                row.rest_length_m * others.taken(noted / row.rest_length_m)
            }
            _ => noted,
        }
    }

    /// The force with a gain, a set length (mm longer than noted) and a zero.
    fn force(&self, row: &Row, [gain, longer_mm, zero]: [f64; 3]) -> f64 {
        let [b1, b2, c0, c1, c2] = self.coefficients;
        let stroke = self.stroke_m(row);
        let contraction_rel = (row.rest_length_m - row.length_m - 1e-3 * longer_mm) / stroke;
        let f620 = new::f620(b1, b2, self.cap_length_m, row.rest_length_m);
        let pressure_rel = row.pressure_kpa / P_620_KPA;
        (1.0 + gain) * new::force([c0, c1, c2], f620, contraction_rel, pressure_rel) + zero
    }

    /// Gain, set length and zero at the mode, and how the readings suit.
    fn suit(&self, rows: &[&Row]) -> ([f64; 3], Suit) {
        let (own, open) = self.mode(rows);
        let left = rows.iter().map(|r| r.force_n - self.force(r, own));
        let left: Vec<f64> = left.collect();
        let suit = Suit {
            readings: rows.len(),
            deviations: [0, 1].map(|k| (own[k] - self.usual[k].middle) / self.usual[k].sd),
            open: [open[0], open[1]],
            gain_se: self.sds(rows)[0] / (1.0 / (open[0] * open[0]) - 1.0).max(0.0).sqrt(),
            rms_n: (sum_of_squares(&left) / left.len() as f64).sqrt(),
            usual_n: self.left_n,
        };
        (own, suit)
    }

    /// The checks of what is the session's own, and of what is left.
    fn checks(&self, own: [f64; 3], suit: &Suit) -> Vec<Check> {
        let state = |deviations: f64| {
            if deviations.abs() > FAR {
                State::Look
            } else {
                State::Fine
            }
        };
        let gain = Seen::Gain {
            value: own[0] - self.usual[0].middle,
            sd: self.usual[0].sd,
            by_law: own[0],
            others: self.others,
        };
        let length = Seen::SetLength {
            value_mm: own[1] - self.usual[1].middle,
            sd_mm: self.usual[1].sd,
            by_law_mm: own[1],
            others: self.others,
        };
        let seen = [(gain, Own::SpecimenGain), (length, Own::SetLength)];
        let of_session = seen.into_iter().enumerate();
        let mut checks: Vec<Check> = of_session
            .map(|(k, (seen, quantity))| Check {
                log: None,
                state: state(suit.deviations[k]),
                seen: if suit.open[k] < LEFT_OPEN || suit.deviations[k].abs() > FAR {
                    seen
                } else {
                    Seen::NotTold { quantity }
                },
            })
            .collect();
        checks.push(Check {
            log: None,
            state: match suit.rms_n / suit.usual_n {
                l if l > LEFT.1 => State::Bad,
                l if l > LEFT.0 => State::Look,
                _ => State::Fine,
            },
            seen: Seen::Misfit {
                rms_n: suit.rms_n,
                usual_n: suit.usual_n,
            },
        });
        checks
    }

    /// The standard deviations of gain, set length and zero of a session. Its contracted length is known as well as declared, or as others are.
    fn sds(&self, rows: &[&Row]) -> [f64; 3] {
        let contracted_m = |r: &Row| match r.contracted_length_sd_m {
            declared if declared.is_finite() => declared,
            _ => {
                let noted = (r.rest_length_m - r.contracted_length_m) / r.rest_length_m;
                let of_noting =
                    |others: &NotedContractions| others.error_sd * (noted - others.mean);
                let of_noting = self.noted.as_ref().map_or(0.0, of_noting);
                r.rest_length_m * norm(&[self.contracted_sd, of_noting])
            }
        };
        let contracted_mm = rows.first().map_or(0.0, |r| 1e3 * contracted_m(r));
        let of_contracted = mean_relative_contraction(rows) * contracted_mm;
        let length_mm = norm(&[self.length_sd_mm, of_contracted]);
        [self.gain_sd, length_mm, self.zero_sd_n].map(|sd| sd.max(1e-6))
    }

    /// The normal matrix with the prior, and the right side, at a gain, set length and zero.
    fn normal(&self, rows: &[&Row], x: [f64; 3]) -> (Matrix, [f64; 3]) {
        const SMALL: [f64; 3] = [1e-4, 1e-2, 1e-2];
        let mut normal = Matrix::zeros(3, 3);
        let mut right = [0.0; 3];
        for row in rows {
            let at = self.force(row, x);
            let slope: [f64; 3] = std::array::from_fn(|k| {
                let mut y = x;
                y[k] += SMALL[k];
                (self.force(row, y) - at) / SMALL[k] / self.left_n
            });
            let miss = (row.force_n - at) / self.left_n;
            for k in 0..3 {
                right[k] += slope[k] * miss;
                for l in 0..3 {
                    normal.column_mut(l)[k] += slope[k] * slope[l];
                }
            }
        }
        for (k, sd) in self.sds(rows).into_iter().enumerate() {
            normal.column_mut(k)[k] += 1.0 / (sd * sd);
            right[k] -= x[k] / (sd * sd);
        }
        (normal, right)
    }

    /// Gain, set length and zero at the mode, by Gauss-Newton steps that are halved until the penalised sum of squares falls; and the standard
    /// deviation of each given the readings, as a share of that among others.
    fn mode(&self, rows: &[&Row]) -> ([f64; 3], [f64; 3]) {
        let sds = self.sds(rows);
        let value = |x: [f64; 3]| {
            let misses = rows
                .iter()
                .map(|r| (r.force_n - self.force(r, x)) / self.left_n);
            let own = x.iter().zip(sds).map(|(x, sd)| (x / sd) * (x / sd));
            misses.map(|m| m * m).sum::<f64>() + own.sum::<f64>()
        };
        let mut x = [0.0; 3];
        let mut here = value(x);
        for _ in 0..STEPS {
            let (normal, right) = self.normal(rows, x);
            let step = Cholesky::new(&normal).solve(&right);
            let mut length = 1.0;
            let next = loop {
                let y: [f64; 3] = std::array::from_fn(|k| x[k] + length * step[k]);
                if value(y) < here || length < 1e-3 {
                    break y;
                }
                length *= 0.5;
            };
            let there = value(next);
            if here - there < 1e-6 {
                break;
            }
            (x, here) = (next, there);
        }
        let factor = Cholesky::new(&self.normal(rows, x).0);
        let open = std::array::from_fn(|k| {
            let mut unit = [0.0; 3];
            unit[k] = 1.0;
            factor.solve(&unit)[k].max(0.0).sqrt() / sds[k]
        });
        (x, open)
    }
}

/// What of the session looks mistaken among the others of its campaign, or where these are few of its diameter.
fn mistakes(session: &Session, own: &[&Row], known: &Known) -> Vec<RecordingError> {
    let Some(first) = own.first() else {
        return Vec::new();
    };
    let diameter_mm = diameter_mm(first);
    let mut rows = alike(session, first, known);
    if by_session(&rows).len() < FEWEST_SESSIONS {
        return Vec::new();
    }
    rows.extend(own);
    let lengths: BTreeSet<u64> = rows.iter().map(|r| r.rest_length_m.to_bits()).collect();
    let base = Base::new(diameter_mm, true, lengths.len(), &known.fit);
    let found = found(session, diameter_mm, known);
    let found = found.max_by_key(|c| (c.campaign == session.campaign, c.design.specimens));
    let effects = found.iter().flat_map(|c| &c.effects);
    let law = effects
        .filter_map(effect)
        .fold(Law::new(&base), |law, (what, values)| {
            law.with(what, &values)
        });
    let data = Data::new(&rows).beside(&base);
    let mut errors = recording::recording_errors(diameter_mm, &law, &data);
    let specimen = &first.specimen;
    errors.retain(|e| {
        e.group == session.id || e.group == *specimen || e.group.ends_with(&format!(" {specimen}"))
    });
    errors
}

/// An effect on all readings as a term, with its amplitude and shape.
fn effect(found: &EffectFinding) -> Option<(What, Vec<f64>)> {
    if found.acts_on != ActsOn::All {
        return None;
    }
    let effect = effects::index(&found.id)?;
    let forms = effects::all()[effect].forms();
    let form = forms.iter().position(|f| f.name == found.form)?;
    let absent = forms[form].amplitude.absent;
    let mut values = found.parameters.iter().map(|p| p.value);
    let amplitude = values.next()? - absent;
    let shape = forms[form].shape.and(values.next());
    let what = What::Effect {
        effect,
        form,
        shape: shape.unwrap_or(f64::NAN),
    };
    Some((what, [amplitude].into_iter().chain(shape).collect()))
}
