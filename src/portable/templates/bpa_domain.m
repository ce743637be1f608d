function inside = bpa_domain(rest_length_m, contracted_length_m, length_m, pressure_kpa)
%BPA_DOMAIN True where a state is in the box of the model; outside it BPA_FORCE is a bounded continuation.
  [~, ~, ~, inside] = bpa_force(rest_length_m, contracted_length_m, length_m, pressure_kpa);
end
