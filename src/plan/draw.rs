//! Readings of a planned campaign as it would give them.
//!
//! F = (1 + u) F(P, l + d) (1 + m_c(eps*, P) + m_s(P)) + z + e: the published law, gain u and true contracted length of the specimen, set length d
//! and zero z of the session, misfits as sums of waves with random phases, noise e. A slack actuator gives 0 and noise.

use crate::design::Plan;
use pipeline_base::random::Stream;
use pipeline_base::row::Row;
use pipeline_base::session::{Kind, Phase};
use pipeline_config::FitOptions;
use pipeline_fit::equations::cap_length_m;
use pipeline_mechanics::models::{P_620_KPA, new};
use std::f64::consts::TAU;

/// Waves of a misfit.
const WAVES: usize = 4;
/// Wavelengths of misfits along the pressure, kPa.
const WAVELENGTHS_KPA: (f64, f64) = (250.0, 1200.0);
/// Along eps*.
const WAVELENGTHS_REL: (f64, f64) = (0.5, 2.0);
/// Time from reading to reading, s.
const STEP_S: f64 = 20.0;
/// Id of the campaign.
pub const CAMPAIGN: &str = "plan";

/// A smooth random function of variance 1.
struct Waves(Vec<[f64; 4]>);

impl Waves {
    fn new(stream: &mut Stream, along_contraction: bool) -> Self {
        let mut wave = || {
            let mut between = |(low, high): (f64, f64)| low + (high - low) * stream.uniform();
            let per_kpa = TAU / between(WAVELENGTHS_KPA);
            let per_rel = TAU / between(WAVELENGTHS_REL);
            let phase = TAU * stream.uniform();
            let size = stream.normal();
            [
                per_kpa,
                if along_contraction { per_rel } else { 0.0 },
                phase,
                size,
            ]
        };
        Self((0..WAVES).map(|_| wave()).collect())
    }

    fn at(&self, pressure_kpa: f64, contraction_rel: f64) -> f64 {
        let scale = (2.0 / WAVES as f64).sqrt();
        let of = |[per_kpa, per_rel, phase, size]: &[f64; 4]| {
            size * libm::cos(per_kpa * pressure_kpa + per_rel * contraction_rel + phase)
        };
        scale * self.0.iter().map(of).sum::<f64>()
    }
}

/// The readings of one draw.
///
/// # Panics
/// Nothing is published of the diameter: [`crate::design::read`] refuses that.
pub fn rows(plan: &Plan, seed: u64) -> Vec<Row> {
    let [b1, b2, c0, c1, c2] =
        new::published(plan.diameter_mm, new::SYMBOLS).expect("a diameter with a law");
    let cap = cap_length_m(plan.diameter_mm, &FitOptions::default());
    let sizes = &plan.scatter;
    let mut rows = Vec::with_capacity(plan.readings());
    let common = Waves::new(&mut Stream::new(seed, &["common"]), true);
    for rest_mm in &plan.rest_lengths_mm {
        let specimen = format!("l{rest_mm}");
        let rest = 1e-3 * rest_mm;
        let stroke = rest * plan.contraction_620;
        let f620 = new::f620(b1, b2, cap, rest);
        let gain = 1.0 + sizes.gain * Stream::new(seed, &["gain", &specimen]).normal();
        let contracted_sd_m = plan.contracted_sd_m(rest);
        let longer_at_620_m =
            contracted_sd_m * Stream::new(seed, &["contracted", &specimen]).normal();
        let true_stroke = stroke - longer_at_620_m;
        for contraction in &plan.contractions {
            let session = format!("{specimen}-c{:02}", 100.0 * contraction);
            let mut stream = Stream::new(seed, &["session", &session]);
            let longer_mm = sizes.length_mm * stream.normal();
            let zero = sizes.zero_n * stream.normal();
            let own = Waves::new(&mut stream, false);
            let length_m = rest - contraction * stroke;
            let set_rel = (contraction * stroke - 1e-3 * longer_mm) / true_stroke;
            for run in 0..plan.runs {
                for (k, (pressure_kpa, phase)) in set_points(plan).into_iter().enumerate() {
                    let pressure_rel = pressure_kpa / P_620_KPA;
                    let law = new::force([c0, c1, c2], f620, set_rel, pressure_rel);
                    let misfit = sizes.common_misfit * common.at(pressure_kpa, set_rel)
                        + sizes.session_misfit * own.at(pressure_kpa, 0.0);
                    let noise = sizes.noise_n * stream.normal();
                    rows.push(Row {
                        session: session.clone(),
                        campaign: CAMPAIGN.to_owned(),
                        specimen: specimen.clone(),
                        kind: Kind::Isometric,
                        simulated: true,
                        log: format!("run{}.csv", run + 1),
                        run: Some(run as i64 + 1),
                        first_row: 1 + k as i64,
                        last_row: 1 + k as i64,
                        phase: Some(phase),
                        samples: 1,
                        diameter_mm: f64::from(plan.diameter_mm),
                        rest_length_m: rest,
                        contracted_length_m: rest - stroke,
                        contracted_length_sd_m: plan
                            .declared_contracted_mm
                            .map_or(f64::NAN, |_| contracted_sd_m),
                        length_sd_m: plan.declared_length_mm.map_or(f64::NAN, |sd| 1e-3 * sd),
                        time_s: STEP_S * k as f64,
                        pressure_kpa,
                        force_n: gain * law * (1.0 + misfit) + zero + noise,
                        length_m,
                        contraction: contraction * plan.contraction_620,
                        contraction_rel: *contraction,
                        pressure_rel,
                        ..Row::blank()
                    });
                }
            }
        }
    }
    rows
}

/// The set points of one log: filling, then venting if that is planned.
fn set_points(plan: &Plan) -> Vec<(f64, Phase)> {
    let up = plan.pressures_kpa.iter().map(|p| (*p, Phase::Pressurizing));
    let down = plan.pressures_kpa.iter().rev();
    let down = down.map(|p| (*p, Phase::Depressurizing));
    if plan.venting {
        up.chain(down).collect()
    } else {
        up.collect()
    }
}
