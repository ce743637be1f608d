@HEADER@
#ifndef BPA_MODEL_H
#define BPA_MODEL_H

#ifdef __cplusplus
extern "C" {
#endif

/* The box of the model; the head of this file says whose it is. */
#define BPA_DIAMETER_MM @DIAMETER_MM@
#define BPA_REST_LENGTH_MIN_M @REST_MIN@
#define BPA_REST_LENGTH_MAX_M @REST_MAX@
#define BPA_CONTRACTION_620_MIN @FREE_MIN@
#define BPA_CONTRACTION_620_MAX @FREE_MAX@
#define BPA_CONTRACTION_REL_MIN @U_MIN@
#define BPA_CONTRACTION_REL_MAX @U_MAX@
#define BPA_PRESSURE_MIN_KPA @P_MIN@
#define BPA_PRESSURE_MAX_KPA @P_MAX@

/* Force in N, tension positive. Lengths in m, gauge pressure in kPa. NaN for arguments that describe no muscle. */
double bpa_force(double rest_length_m, double contracted_length_m, double length_m, double pressure_kpa);

/* Derivatives of the force: by the length in N/m, by the pressure in N/kPa. */
void bpa_force_gradient(double rest_length_m, double contracted_length_m, double length_m, double pressure_kpa,
                        double *dforce_dlength_n_per_m, double *dforce_dpressure_n_per_kpa);

/* 1 inside the box, 0 outside, where the force is a bounded continuation. */
int bpa_domain(double rest_length_m, double contracted_length_m, double length_m, double pressure_kpa);

#ifdef __cplusplus
}
#endif

#endif
