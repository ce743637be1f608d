% Holds bpa_force.m to golden_vectors.csv: prints the number of points and the largest difference, as a multiple of what is allowed (1e-9 of the
% value, or 1e-9 in its unit). Arguments: the folder of the export.
folder = argv(){1};
addpath(folder);
file = fopen(fullfile(folder, 'golden_vectors.csv'));
fgetl(file);
columns = textscan(file, '%f %f %f %f %f %f %f %f', 'Delimiter', ',');
fclose(file);
x = [columns{:}];
found = zeros(rows(x), 4);
found(:, 1) = bpa_force(x(:, 1), x(:, 2), x(:, 3), x(:, 4));
[found(:, 2), found(:, 3)] = bpa_force_gradient(x(:, 1), x(:, 2), x(:, 3), x(:, 4));
found(:, 4) = bpa_domain(x(:, 1), x(:, 2), x(:, 3), x(:, 4));
expected = x(:, 5:8);
for k = 1:rows(x)
  % A scalar gives what the array gave.
  alone = bpa_force(x(k, 1), x(k, 2), x(k, 3), x(k, 4));
  if ! (alone == found(k, 1) || isnan(alone) && isnan(found(k, 1)))
    found(k, 1) = Inf;
  end
end
share = abs(found - expected) ./ (1e-9 * max(1, abs(expected)));
share(isnan(found) & isnan(expected)) = 0;
share(isnan(share)) = Inf;
printf('%d %.3g\n', rows(x), max(share(:)));
