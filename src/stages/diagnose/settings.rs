//! What is plausible of a law, a rig and its actuators, each with its reason: scales of priors, length scales, where an actuator goes slack.
//! What decides beside them is in [`pipeline_inference::decisions`].

/// Prior scale of the misfit that all specimens share, share of the force: the law was fitted to such actuators to a few percent. It is one surface,
/// and its prior counts once, however many specimens share it.
pub const COMMON_MISFIT: f64 = 0.02;
/// The same of a law with published coefficients, which was fitted to other actuators: at half of the contraction and 620 kPa five published laws of
/// 10 mm have 0.35 to 0.51 of their force at no contraction (300 mm).
pub const PUBLISHED_MISFIT: f64 = 0.1;
/// Prior scale of the misfit of a session along the pressure, share of the force.
pub const SESSION_MISFIT: f64 = 0.02;
/// Length scale of the session's misfit, kPa: shorter is noise, longer is a gain or an offset of the pressure.
pub const PRESSURE_LENGTH_KPA: f64 = 100.0;
/// Length scale of a stroke's misfit, kPa: what the first filling after the length was set has of its own reaches over most of it.
pub const STROKE_LENGTH_KPA: f64 = 200.0;
/// Correlation length of what the force wanders by within a stroke, as a share of its duration: shorter is noise, longer a zero or a drift.
pub const WANDER_LENGTH: f64 = 0.2;
/// Usual size of that, share of the largest force.
pub const USUAL_WANDER: f64 = 0.005;
/// Usual misfit of a stroke, share of the force.
pub const USUAL_STROKE: f64 = 0.01;
/// Length scale of the common misfit, in eps* and P*: the likelihood of the laboratory's campaigns is largest between 0.45 and 0.6 (10 mm: -3451.9,
/// -3439.4, -3434.8, -3434.5 and -3437.3 at 0.2, 0.3, 0.45, 0.6 and 0.8; 20 mm: -5646.5 to -5636.7 at 0.6; pool:
/// -3802.1 to -3783.2 at 0.6; all with a floor of 0.2 and a prior that counted once a specimen).
pub const SURFACE_LENGTH: f64 = 0.45;
/// Length scale of the size of an effect along its own argument, share of the range of the readings: forms bend over most of it; what varies faster
/// is more often a misfit of the law. In 23 simulated campaigns with a constant zero of the pressure of 45 kPa its size was called
/// different in 7 with 0.3 and in 3 with 0.8; of 24 stiffening frames at 4 limits 18 were seen with 0.5 and 20 with 0.8.
pub const FORM_LENGTH: f64 = 0.8;
/// Length scale of what a dependence on a logged column may be beside the polynomial that is fitted, share of the column's range: the narrowest form that was
/// met is a bump of 7% of relative humidity where 34% were logged. It decides about no column: other terms have to show beside it.
pub const COLUMN_LENGTH: f64 = 0.2;
/// Cosines of that.
pub const COLUMN_COSINES: usize = 9;
/// Floor of the misfit's scale, share of the largest force: friction and the onset of the force are no smaller where the force is small.
pub const MISFIT_FLOOR: f64 = 0.2;
/// Other floors; the one is taken under which the null model is likeliest. A misfit that is a share of the force has none. With a floor that is not
/// there the small forces, which then show no misfit, make that of the large ones seem small, and the search takes what is left for a
/// curve: of 180 simulated campaigns with nothing in them 21 were answered with something under 0.2 alone, 11 with the likeliest. None is
/// larger: a misfit of so many newtons wherever the actuator pulls takes the place of what the law lacks at its onset.
pub const OTHER_FLOORS: [f64; 3] = [0.02, 0.07, 0.4];
/// Standard deviation of a length that was rounded to 1 mm, mm: 1/sqrt(12).
pub const ROUNDING_SD_MM: f64 = 0.29;
/// Standard deviation of 1/b2, c1 and c2 about their published values, as a share of these: refitted to the laboratory's campaigns they are
/// within a third of them. Each is one further reading. Specimens of one resting length tell nothing of another, and two contractions
/// nothing of what a millimetre of the set length does to an actuator that is not contracted; where one specimen was measured, set lengths and
/// shape explain one another.
pub const LAW_SPREAD: f64 = 0.5;
/// The same of a diameter for which nothing is published: from 10 to 40 mm the published c1 is 4.3 to 10.5, c2 0.56 to 2.0.
pub const UNPUBLISHED_LAW_SPREAD: f64 = 1.0;
/// Usual scatter of the gains of specimens: Festo states 10% tolerance, laboratories find 3 to 5%.
pub const USUAL_GAIN: f64 = 0.04;
/// Usual scatter of set lengths, mm.
pub const USUAL_SET_LENGTH_MM: f64 = 1.0;
/// Usual scatter of the zero of the force, N.
pub const USUAL_ZERO_N: f64 = 1.0;
/// Usual scatter of contracted lengths about those noted beside their rounding, share of the resting length: the laboratory's nine specimens of 10 mm, noted
/// with contractions of 0.157 to 0.188 at 620 kPa, have 0.009 about what is noted of them is worth. Proportional to the resting length it is likelier than
/// in mm (by 5.2 in log-likelihood while what is noted was taken as it is).
pub const USUAL_CONTRACTION: f64 = 0.01;
/// Mean and standard deviation of the share of what noted contractions at 620 kPa differ by that is an error of noting: it is between 0 and 1, and nobody
/// knows which.
pub const NOTING_ERROR: (f64, f64) = (0.5, 0.5);
/// Scale of the priors of these scatters, as a multiple of the usual ones: weak, but no scatter takes the place of the law.
pub const LARGEST_SCATTER: f64 = 5.0;
/// Precision of a caliper on the crossmember, mm: what "set lengths known" means where its worth is asked for.
pub const CALIPER_MM: f64 = 0.2;
/// Share of the largest force below which a reading may be of an actuator that is slack.
pub const NEAR_SLACK: f64 = 0.03;
/// Such a reading is taken for slack where the published law is below minus this share of the force at 620 kPa: further than set lengths scatter.
pub const SURELY_SLACK: f64 = 0.1;
/// Width over which the corner between pulling and slack is rounded, and the noise of a reading in it, shares of the largest force: the law has a
/// corner there, actuators have none. On the rig the force creeps up to 10 N of 300 before the corner; with a third of this width readings leave
/// and enter it in turn, and fits do not end.
pub const CORNER_WIDTH: f64 = 0.03;
