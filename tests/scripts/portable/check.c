/* Holds bpa_model.c to golden_vectors.csv: prints the number of points and the largest difference, as a multiple of what is allowed (1e-9 of the
   value, or 1e-9 in its unit). */
#include "bpa_model.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static double worst = 0.0;

static void compare(double found, double expected)
{
    double allowed, share;
    if (isnan(expected) && isnan(found))
        return;
    allowed = 1e-9 * fmax(1.0, fabs(expected));
    share = fabs(found - expected) / allowed;
    if (!(share <= worst))
        worst = isnan(share) ? INFINITY : share;
}

int main(int argc, char **argv)
{
    char line[1024];
    double x[7], by_length, by_pressure;
    int points = 0, inside, k;
    FILE *file = argc > 1 ? fopen(argv[1], "r") : NULL;
    if (!file || !fgets(line, sizeof line, file))
        return 2;
    while (fgets(line, sizeof line, file)) {
        char *at = line;
        for (k = 0; k < 7; k++)
            x[k] = strtod(at, &at), at++;
        inside = (int)strtol(at, NULL, 10);
        compare(bpa_force(x[0], x[1], x[2], x[3]), x[4]);
        bpa_force_gradient(x[0], x[1], x[2], x[3], &by_length, &by_pressure);
        compare(by_length, x[5]);
        compare(by_pressure, x[6]);
        if (bpa_domain(x[0], x[1], x[2], x[3]) != inside)
            worst = INFINITY;
        points++;
    }
    fclose(file);
    printf("%d %.3g\n", points, worst);
    return 0;
}
