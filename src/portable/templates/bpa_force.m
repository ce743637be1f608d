function [force_n, dforce_dlength_n_per_m, dforce_dpressure_n_per_kpa, inside] = bpa_force(rest_length_m, contracted_length_m, length_m, pressure_kpa)
%BPA_FORCE Force of a braided pneumatic actuator in N, tension positive.
%   F = BPA_FORCE(REST_LENGTH_M, CONTRACTED_LENGTH_M, LENGTH_M, PRESSURE_KPA), element by element: scalars, or arrays of one size.
%   [F, DL, DP, INSIDE] = ... also has its derivatives by the length (N/m) and the pressure (N/kPa), and whether the state is in the
%   box of the model. F is NaN for arguments that describe no muscle. Also BPA_FORCE_GRADIENT, BPA_DOMAIN.
%
@HEADER@

  % The box of the model; the head of this file says whose it is.
  REST = [@REST_MIN@, @REST_MAX@];
  FREE = [@FREE_MIN@, @FREE_MAX@];
  CONTRACTION = [@U_MIN@, @U_MAX@];
  PRESSURE = [@P_MIN@, @P_MAX@];

  % The law; the head of this file has it under the names of the paper.
  % F = F0 max(0, S), F0 = (f0 + b1 atan(b2 (l_rest - l_0))) (1 + k1 (l_rest - l_mid) + k2 l_mid (1 - l_mid/l_rest)),
  % S = s0 + s1 exp(-s2 u) + v (s3 exp(-(s4 u + s5 u^2)) + s6)
  F0 = @F0@; B1 = @B1@; B2 = @B2@; L_0 = @L_0@;
  K1 = @K1@; K2 = @K2@; L_MID = @L_MID@;
  S0 = @S0@; S1 = @S1@; S2 = @S2@; S3 = @S3@; S4 = @S4@; S5 = @S5@; S6 = @S6@;
  % Contraction at u = 1; 0: the muscle's own, (l_rest - l_620)/l_rest.
  EPS_MAX = @EPS_MAX@;
  % v = P'/P_REF, P' = max(0, P - P1) - P2 (1 - exp(-P/P2)).
  P_REF = @P_REF@; P1 = @P1@; P2 = @P2@;
  % The law is used up to u = END; what force is left there fades out over FADE.
  END = @END@; FADE = @FADE@;
  % Width of the box's edges; S up to which the muscle is slack.
  EDGE = @EDGE@; SLACK = @SLACK@;

  % One size for all.
  zero = 0 * (rest_length_m + contracted_length_m + length_m + pressure_kpa);
  zero(~isfinite(zero)) = 0;
  rest = rest_length_m + zero;
  contracted = contracted_length_m + zero;
  length = length_m + zero;
  pressure = pressure_kpa + zero;

  if EPS_MAX > 0
    stroke = rest * EPS_MAX;
  else
    stroke = rest - contracted;
  end
  muscle = isfinite(rest) & isfinite(contracted) & isfinite(length) & isfinite(pressure) & rest > 0 & contracted > 0 & stroke > 0;
  within = @(x, box) x >= box(1) - EDGE & x <= box(2) + EDGE;

  u = (rest - length) ./ stroke;
  at = min(max(u, CONTRACTION(1)), END);

  p = min(max(pressure, 0), PRESSURE(2));
  open = p - P1 >= 0;
  v = zero;
  v(open) = p(open) - P1;
  by_kpa = double(open);
  if P2 > 0
    left = exp(-p / P2);
    v = v - P2 * (1 - left);
    by_kpa = by_kpa - left;
  end
  v = v / P_REF;
  by_kpa = by_kpa / P_REF;

  relaxing = S1 * exp(-S2 * at);
  pressing = S3 * exp(-(S4 * at + S5 * at .* at));
  surface = S0 + relaxing + v .* (pressing + S6);
  fade = 1 - max(u - END, 0) / FADE;
  pulls = muscle & surface > SLACK & fade > 0;

  % F0, continued beyond the box.
  scale = @(l) 1 + K1 * (l - L_MID) + K2 * L_MID * (1 - L_MID ./ l);
  law = @(l) (F0 + B1 * atan(B2 * (l - L_0))) .* scale(l);
  shorter = min(rest, REST(2));
  top = max(min(law(shorter), law(max(shorter, REST(1)))), 0);

  force = top .* surface .* fade;
  by_length = top .* (S2 * relaxing + v .* pressing .* (S4 + 2 * S5 * at)) ./ stroke;
  by_length(u < CONTRACTION(1) - EDGE) = 0;
  fading = u > END + EDGE;
  by_length(fading) = top(fading) .* surface(fading) ./ (FADE * stroke(fading));
  by_pressure = top .* fade .* (pressing + S6) .* by_kpa;
  by_pressure(~within(pressure, [0, PRESSURE(2)])) = 0;

  force_n = only(force, pulls, muscle);
  dforce_dlength_n_per_m = only(by_length, pulls, muscle);
  dforce_dpressure_n_per_kpa = only(by_pressure, pulls, muscle);
  inside = muscle & within(rest, REST) & within((rest - contracted) ./ rest, FREE) & within(u, CONTRACTION) & within(pressure, PRESSURE);
end

% Zero where the muscle is slack, NaN where there is no muscle.
function x = only(x, pulls, muscle)
  x(~pulls) = 0;
  x(~muscle) = NaN;
end
