/* Force of a braided pneumatic actuator: bpa_model.h says of which, where from, and in which box. C99, no dependencies but libm. */
#include "bpa_model.h"

#include <math.h>

/* The law; the head of bpa_model.h has it under the names of the paper.
   F = F0 max(0, S), F0 = (f0 + b1 atan(b2 (l_rest - l_0))) (1 + k1 (l_rest - l_mid) + k2 l_mid (1 - l_mid/l_rest)),
   S = s0 + s1 exp(-s2 u) + v (s3 exp(-(s4 u + s5 u^2)) + s6) */
static const double F0 = @F0@, B1 = @B1@, B2 = @B2@, L_0 = @L_0@;
static const double K1 = @K1@, K2 = @K2@, L_MID = @L_MID@;
static const double S0 = @S0@, S1 = @S1@, S2 = @S2@, S3 = @S3@, S4 = @S4@, S5 = @S5@, S6 = @S6@;
/* Contraction at u = 1; 0: the muscle's own, (l_rest - l_620)/l_rest. */
static const double EPS_MAX = @EPS_MAX@;
/* v = P'/P_REF, P' = max(0, P - P1) - P2 (1 - exp(-P/P2)). */
static const double P_REF = @P_REF@, P1 = @P1@, P2 = @P2@;
/* The law is used up to u = END; what force is left there fades out over FADE. */
static const double END = @END@, FADE = @FADE@;
/* Width of the box's edges; S up to which the muscle is slack. */
static const double EDGE = @EDGE@, SLACK = @SLACK@;

static double clamped(double x, double low, double high)
{
    return x < low ? low : x > high ? high : x;
}

static int within(double x, double low, double high)
{
    return x >= low - EDGE && x <= high + EDGE;
}

static double stroke(double rest, double contracted)
{
    return EPS_MAX > 0.0 ? rest * EPS_MAX : rest - contracted;
}

/* F0 of the law. */
static double largest_of_law(double rest)
{
    double scale = 1.0 + K1 * (rest - L_MID) + K2 * L_MID * (1.0 - L_MID / rest);
    return (F0 + B1 * atan(B2 * (rest - L_0))) * scale;
}

/* F0, continued beyond the box. */
static double largest(double rest)
{
    double length = rest < BPA_REST_LENGTH_MAX_M ? rest : BPA_REST_LENGTH_MAX_M;
    double there = largest_of_law(length);
    double at_edge = largest_of_law(length > BPA_REST_LENGTH_MIN_M ? length : BPA_REST_LENGTH_MIN_M);
    double smaller = there < at_edge ? there : at_edge;
    return smaller > 0.0 ? smaller : 0.0;
}

/* Whether the arguments describe a muscle. */
static int is_muscle(double rest, double contracted, double length, double pressure)
{
    return isfinite(rest) && isfinite(contracted) && isfinite(length) && isfinite(pressure)
        && rest > 0.0 && contracted > 0.0 && stroke(rest, contracted) > 0.0;
}

static void evaluate(double rest, double contracted, double length, double pressure,
                     double *force, double *by_length, double *by_pressure)
{
    double span, u, at, p, v, by_kpa, relaxing, pressing, surface, fade, top;

    *force = *by_length = *by_pressure = NAN;
    if (!is_muscle(rest, contracted, length, pressure))
        return;
    *force = *by_length = *by_pressure = 0.0;

    span = stroke(rest, contracted);
    u = (rest - length) / span;
    at = clamped(u, BPA_CONTRACTION_REL_MIN, END);

    p = clamped(pressure, 0.0, BPA_PRESSURE_MAX_KPA);
    v = p - P1;
    by_kpa = 1.0;
    if (v < 0.0) {
        v = 0.0;
        by_kpa = 0.0;
    }
    if (P2 > 0.0) {
        double left = exp(-p / P2);
        v -= P2 * (1.0 - left);
        by_kpa -= left;
    }
    v /= P_REF;
    by_kpa /= P_REF;

    relaxing = S1 * exp(-S2 * at);
    pressing = S3 * exp(-(S4 * at + S5 * at * at));
    surface = S0 + relaxing + v * (pressing + S6);
    fade = u > END ? 1.0 - (u - END) / FADE : 1.0;
    if (surface <= SLACK || fade <= 0.0)
        return;

    top = largest(rest);
    *force = top * surface * fade;
    if (within(pressure, 0.0, BPA_PRESSURE_MAX_KPA))
        *by_pressure = top * fade * (pressing + S6) * by_kpa;
    if (u > END + EDGE)
        *by_length = top * surface / (FADE * span);
    else if (u >= BPA_CONTRACTION_REL_MIN - EDGE)
        *by_length = top * (S2 * relaxing + v * pressing * (S4 + 2.0 * S5 * at)) / span;
}

double bpa_force(double rest_length_m, double contracted_length_m, double length_m, double pressure_kpa)
{
    double force, by_length, by_pressure;
    evaluate(rest_length_m, contracted_length_m, length_m, pressure_kpa, &force, &by_length, &by_pressure);
    return force;
}

void bpa_force_gradient(double rest_length_m, double contracted_length_m, double length_m, double pressure_kpa,
                        double *dforce_dlength_n_per_m, double *dforce_dpressure_n_per_kpa)
{
    double force;
    evaluate(rest_length_m, contracted_length_m, length_m, pressure_kpa, &force, dforce_dlength_n_per_m,
             dforce_dpressure_n_per_kpa);
}

int bpa_domain(double rest_length_m, double contracted_length_m, double length_m, double pressure_kpa)
{
    double span;
    if (!is_muscle(rest_length_m, contracted_length_m, length_m, pressure_kpa))
        return 0;
    span = stroke(rest_length_m, contracted_length_m);
    return within(rest_length_m, BPA_REST_LENGTH_MIN_M, BPA_REST_LENGTH_MAX_M)
        && within((rest_length_m - contracted_length_m) / rest_length_m, BPA_CONTRACTION_620_MIN, BPA_CONTRACTION_620_MAX)
        && within((rest_length_m - length_m) / span, BPA_CONTRACTION_REL_MIN, BPA_CONTRACTION_REL_MAX)
        && within(pressure_kpa, BPA_PRESSURE_MIN_KPA, BPA_PRESSURE_MAX_KPA);
}
