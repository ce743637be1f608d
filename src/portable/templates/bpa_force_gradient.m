function [dforce_dlength_n_per_m, dforce_dpressure_n_per_kpa] = bpa_force_gradient(rest_length_m, contracted_length_m, length_m, pressure_kpa)
%BPA_FORCE_GRADIENT Derivatives of BPA_FORCE: by the length in N/m, by the pressure in N/kPa.
  [~, dforce_dlength_n_per_m, dforce_dpressure_n_per_kpa] = bpa_force(rest_length_m, contracted_length_m, length_m, pressure_kpa);
end
