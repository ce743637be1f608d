//! What is plausible of a joint and its tests, each with its reason; the scatter of gains and the misfit of one set-up are those of the
//! isometric loop ([`pipeline_diagnose::settings`]). What decides beside them is in [`pipeline_inference::decisions`].

/// Usual scatter of how tests are mounted, mm: a tape measure on a leg.
pub const USUAL_MOUNTING_MM: f64 = 1.0;
/// Scale of the prior of that scatter, mm: a leg with one test or two has no scatter to show, and what all its tests share is no accident.
pub const LARGEST_MOUNTING_MM: f64 = 3.0;
/// Scale of the prior of the scatter of gains: the tolerance that the maker states. A knee cannot tell a gain from other factors well, and would take
/// for it whatever acts like one.
pub const LARGEST_GAIN: f64 = 0.1;
/// Usual scatter of the zero of the torque, share of the largest torque.
pub const USUAL_ZERO: f64 = 0.01;
/// Usual bias of a test's hand-measured lengths and arms, mm, and the scale of its prior: where the clamp begins, and to what the arm is drawn,
/// is judged anew in each test. With a weaker prior a bias that all tests share, which is what attachments elsewhere than drawn look like,
/// would pass for so many accidents.
pub const USUAL_BIAS_MM: f64 = 3.0;
/// Prior scale of the misfit that all tests of a joint share along angle and pressure, share of the torque: a law that holds to 2% at a force, times an arm of some 60 mm that
/// is drawn to 3 mm. At 3% the laboratory's extensors get two effects more, and the 40 cm actuator is predicted at 5.9 instead of 1.3 N.m.
pub const COMMON_MISFIT: f64 = 0.05;
/// What the coefficients c0, c1 and c2 of the published law are off by, relative, one standard deviation: what a fit to a dozen actuators does not know
/// of them. Taken as exact, errors of 2% are answered with a zero of the pressure or a threshold, in 6 of 8 joints of a generator of others. With 5,
/// 10 and 10% (refits to single campaigns of the laboratory are off by 7 to 15% in c0, and by up to a third in the others) effects of moderate size
/// are no longer seen, and the laboratory's extensors are predicted at 1.5 instead of 1.2 N.m.
pub const LAW_SD: [f64; 3] = [0.02, 0.05, 0.05];
/// Length scale of both, rad (30 degrees): shorter is noise, longer is a gain.
pub const ANGLE_LENGTH_RAD: f64 = 0.5;
/// Floor of the misfit's scale, share of the largest torque.
pub const MISFIT_FLOOR: f64 = 0.05;
/// Noise of hand-measured lengths where nobody declares it, mm.
pub const LENGTH_SD_MM: f64 = 5.0;
/// The same of hand-measured arms, mm.
pub const ARM_SD_MM: f64 = 7.0;
/// Fewest hand-measured values from which their noise is estimated; with fewer, or where it is declared, it is taken as known.
pub const FEWEST_FOR_NOISE: usize = 10;
/// Share of the largest torque below which a reading may be of an actuator that is slack, where the rigid leg would not pull, or where the noise is so
/// large; and the noise of a reading that may or may not be, which says no more than that.
pub const NEAR_SLACK: f64 = 0.1;
/// In standard deviations of the torques: the size below which one may be of a slack actuator. Where the rigid leg would pull, the deviations are those
/// of neighbouring readings, because an offset of the length makes actuators slack of which the drawing says that they pull; where it would push, those
/// of actuators that are surely slack. A reading of noise that is taken for one of an actuator that pushes bends the whole law: with noise of 0.25 N.m
/// and 3% of the largest torque as the bound, an offset of the length of 17 to 26 mm was answered with another effect in 8 of 8 simulated joints.
pub const SLACK_DEVIATIONS: f64 = 3.0;
