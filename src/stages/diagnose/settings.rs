//! The numbers on which decisions rest, each with its reason. There are no others.

/// Prior scale of the misfit that all specimens share, share of the force: the law was fitted to such actuators to a few percent.
pub const COMMON_MISFIT: f64 = 0.02;
/// Prior scale of the misfit of a session along the pressure, share of the force.
pub const SESSION_MISFIT: f64 = 0.02;
/// Length scale of the session's misfit, kPa: shorter is noise, longer is a gain or an offset of the pressure.
pub const PRESSURE_LENGTH_KPA: f64 = 100.0;
/// Length scale of the common misfit, in eps* and P*.
pub const SURFACE_LENGTH: f64 = 0.6;
/// Floor of the misfit's scale, share of the largest force: a law is not infinitely exact where the force is small.
pub const MISFIT_FLOOR: f64 = 0.05;
/// Standard deviation of a length that was rounded to 1 mm, mm: 1/sqrt(12).
pub const ROUNDING_SD_MM: f64 = 0.29;
/// A change of the force, as a share of its root mean square, at which an effect that enters nonlinearly is looked at again.
pub const LARGE_CHANGE: f64 = 0.08;
/// Cosine above which two amplitudes of one effect show alike.
pub const SAME_DIRECTION: f64 = 0.98;
