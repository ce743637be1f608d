@HEADER@
"""Force of a braided pneumatic actuator, for scalars and NumPy arrays of any shapes that broadcast.

bpa_force(rest_length_m, contracted_length_m, length_m, pressure_kpa) in N, tension positive; bpa_force_gradient: its derivatives by
the length (N/m) and the pressure (N/kPa); bpa_domain: whether a state is in the box of the model.
"""

import numpy as np

DIAMETER_MM = @DIAMETER_MM@

# The box of the model; the head of this file says whose it is.
REST_LENGTH_M = (@REST_MIN@, @REST_MAX@)
CONTRACTION_620 = (@FREE_MIN@, @FREE_MAX@)
CONTRACTION_REL = (@U_MIN@, @U_MAX@)
PRESSURE_KPA = (@P_MIN@, @P_MAX@)

# The law; the head of this file has it under the names of the paper.
# F = F0 max(0, S), F0 = (f0 + b1 atan(b2 (l_rest - l_0))) (1 + k1 (l_rest - l_mid) + k2 l_mid (1 - l_mid/l_rest)),
# S = s0 + s1 exp(-s2 u) + v (s3 exp(-(s4 u + s5 u^2)) + s6)
F0, B1, B2, L_0 = @F0@, @B1@, @B2@, @L_0@
K1, K2, L_MID = @K1@, @K2@, @L_MID@
S0, S1, S2, S3, S4, S5, S6 = @S0@, @S1@, @S2@, @S3@, @S4@, @S5@, @S6@
# Contraction at u = 1; 0: the muscle's own, (l_rest - l_620)/l_rest.
EPS_MAX = @EPS_MAX@
# v = P'/P_REF, P' = max(0, P - P1) - P2 (1 - exp(-P/P2)).
P_REF, P1, P2 = @P_REF@, @P1@, @P2@
# The law is used up to u = END; what force is left there fades out over FADE.
END, FADE = @END@, @FADE@
# Width of the box's edges; S up to which the muscle is slack.
EDGE, SLACK = @EDGE@, @SLACK@


def bpa_force(rest_length_m, contracted_length_m, length_m, pressure_kpa):
    """Force in N; NaN for arguments that describe no muscle."""
    return _evaluate(rest_length_m, contracted_length_m, length_m, pressure_kpa)[0]


def bpa_force_gradient(rest_length_m, contracted_length_m, length_m, pressure_kpa):
    """Derivatives of the force: by the length in N/m, by the pressure in N/kPa."""
    return _evaluate(rest_length_m, contracted_length_m, length_m, pressure_kpa)[1:]


def bpa_domain(rest_length_m, contracted_length_m, length_m, pressure_kpa):
    """True inside the box, False outside, where the force is a bounded continuation."""
    rest, contracted, length, pressure = _arrays(rest_length_m, contracted_length_m, length_m, pressure_kpa)
    muscle = _is_muscle(rest, contracted, length, pressure)
    with np.errstate(all="ignore"):
        inside = (
            muscle
            & _within(rest, REST_LENGTH_M)
            & _within((rest - contracted) / rest, CONTRACTION_620)
            & _within((rest - length) / _stroke(rest, contracted), CONTRACTION_REL)
            & _within(pressure, PRESSURE_KPA)
        )
    return bool(inside) if inside.ndim == 0 else inside


def _arrays(*arguments):
    return np.broadcast_arrays(*(np.asarray(a, dtype=float) for a in arguments))


def _within(x, box):
    return (x >= box[0] - EDGE) & (x <= box[1] + EDGE)


def _stroke(rest, contracted):
    return rest * EPS_MAX if EPS_MAX > 0.0 else rest - contracted


def _is_muscle(rest, contracted, length, pressure):
    finite = np.isfinite(rest) & np.isfinite(contracted) & np.isfinite(length) & np.isfinite(pressure)
    return finite & (rest > 0.0) & (contracted > 0.0) & (_stroke(rest, contracted) > 0.0)


def _largest_of_law(rest):
    scale = 1.0 + K1 * (rest - L_MID) + K2 * L_MID * (1.0 - L_MID / rest)
    return (F0 + B1 * np.arctan(B2 * (rest - L_0))) * scale


def _largest(rest):
    """F0, continued beyond the box."""
    length = np.minimum(rest, REST_LENGTH_M[1])
    at_edge = _largest_of_law(np.maximum(length, REST_LENGTH_M[0]))
    return np.maximum(np.minimum(_largest_of_law(length), at_edge), 0.0)


def _evaluate(*arguments):
    rest, contracted, length, pressure = _arrays(*arguments)
    muscle = _is_muscle(rest, contracted, length, pressure)
    with np.errstate(all="ignore"):
        stroke = _stroke(rest, contracted)
        u = (rest - length) / stroke
        at = np.minimum(np.maximum(u, CONTRACTION_REL[0]), END)

        p = np.minimum(np.maximum(pressure, 0.0), PRESSURE_KPA[1])
        v = np.where(p - P1 < 0.0, 0.0, p - P1)
        by_kpa = np.where(p - P1 < 0.0, 0.0, 1.0)
        if P2 > 0.0:
            left = np.exp(-p / P2)
            v = v - P2 * (1.0 - left)
            by_kpa = by_kpa - left
        v = v / P_REF
        by_kpa = by_kpa / P_REF

        relaxing = S1 * np.exp(-S2 * at)
        pressing = S3 * np.exp(-(S4 * at + S5 * at * at))
        surface = S0 + relaxing + v * (pressing + S6)
        fade = np.where(u > END, 1.0 - (u - END) / FADE, 1.0)
        pulls = (surface > SLACK) & (fade > 0.0)

        top = _largest(rest)
        force = top * surface * fade
        by_pressure = np.where(_within(pressure, (0.0, PRESSURE_KPA[1])), top * fade * (pressing + S6) * by_kpa, 0.0)
        falling = top * (S2 * relaxing + v * pressing * (S4 + 2.0 * S5 * at)) / stroke
        by_length = np.where(u >= CONTRACTION_REL[0] - EDGE, falling, 0.0)
        by_length = np.where(u > END + EDGE, top * surface / (FADE * stroke), by_length)
    answers = (np.where(muscle, np.where(pulls, a, 0.0), np.nan) for a in (force, by_length, by_pressure))
    return tuple(float(a) if a.ndim == 0 else a for a in answers)
