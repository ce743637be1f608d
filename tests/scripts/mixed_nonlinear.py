"""Writes tests/data/mixed/{one_noise,two_noises}{,_expected}.csv: readings of nested groups and their nonlinear mixed model, by NumPy and SciPy.

Usage, from the root of the repository: python3 tests/scripts/mixed_nonlinear.py
Needs numpy and scipy. For src/inference/reference_tests.rs; shares no code and no shortcut with src/inference.

Readings of a specimen k in a session s are
    y = A (1 + u_k) (1 - exp(-(x + d_s) / c)) + m_k(x) + e
with a gain u of every specimen and an offset d of every session, both of which act nonlinearly. In the first case there is no misfit m and one
class of noise. In the second every specimen has a misfit, m_k(x) = sum over j of m_kj sin(pi j x / 10), and readings of its saturation
    y = A (1 + u_k) + e'
that belong to no session and have a noise of their own; gain and misfit have half-normal priors of their standard deviations, each counted once
a specimen.

The fit is the alternation of Lindstrom and Bates (Biometrics 46 (1990) 673) with the covariance V as a matrix: modes b of the random effects
(penalised least squares by MINPACK); derivatives Z by b there (complex steps); maximum of the likelihood of
    y + Z b - f(theta, b) ~ N(0, Z D Z' + S)
with the priors over coefficients and standard deviations at once, Z held; until nothing moves. Then, for the linear model at the end, the
standard deviations of the restricted likelihood; and the same where the prior of the gain is that of `Prior::Away`.
"""

import pathlib

import numpy as np
from scipy import optimize

FOLDER = pathlib.Path(__file__).parents[1] / "data" / "mixed"
WAVES = 3


class Case:
    """Readings and what is known of the standard deviations, in the order gain, offset, misfit (where there is one), noises."""

    def __init__(self, name, rows, priors, usual_gain):
        self.name = name
        self.rows = rows
        # (scale, groups) of a half-normal prior, or None.
        self.priors = priors
        self.usual_gain = usual_gain
        kind, specimen, session, x, y = (np.array(column) for column in zip(*rows))
        self.kind, self.specimen, self.session, self.x, self.y = kind, specimen, session, x, y
        self.specimens, self.sessions = specimen.max() + 1, session.max() + 1
        self.misfit = len(priors) > 3
        sizes = [self.specimens, self.sessions] + [self.specimens * WAVES] * self.misfit
        self.component = np.repeat(np.arange(len(sizes)), sizes)
        self.noises = kind.max() + 1

    def predict(self, theta, b):
        ends = np.cumsum([self.specimens, self.sessions])
        gain, offset, misfit = np.split(b, ends)
        full = theta[0] * (1 + gain[self.specimen])
        y = full * (1 - np.exp(-(self.x + offset[self.session]) / theta[1]))
        if self.misfit:
            waves = np.sin(np.pi * np.outer(self.x, np.arange(1, WAVES + 1)) / 10)
            y = y + np.sum(misfit.reshape(-1, WAVES)[self.specimen] * waves, axis=1)
        return np.where(self.kind == 1, full, y)

    def split(self, sds):
        """Standard deviations of every random effect and of the noise of every reading."""
        return sds[self.component], sds[len(sds) - self.noises :][self.kind]

    def log_prior(self, sds):
        known = [(s, p) for s, p in zip(sds, self.priors) if p]
        return sum(-0.5 * groups * (s / scale) ** 2 for s, (scale, groups) in known)


def derivatives(f, at):
    columns = []
    for k in range(len(at)):
        step = at.astype(complex)
        step[k] += 1e-30j
        columns.append(f(step).imag / 1e-30)
    return np.column_stack(columns)


def modes(case, theta, sds, b):
    sd, noise = case.split(sds)
    residual = lambda b: np.concatenate([(case.y - case.predict(theta, b)) / noise, b / sd])
    jacobian = lambda b: np.vstack([-derivatives(lambda c: case.predict(theta, c), b) / noise[:, None], np.diag(1 / sd)])
    b = optimize.least_squares(residual, b, jac=jacobian, method="lm", xtol=1e-14, ftol=1e-14, gtol=1e-14).x
    # MINPACK ends where the sum of squares no longer falls, at half the digits of b; Gauss and Newton's steps bring the rest.
    for _ in range(5):
        b = b - np.linalg.lstsq(jacobian(b), residual(b), rcond=None)[0]
    return b


def marginal(case, v, b, z):
    """Log-likelihood with priors of the model linear in the random effects, and its gradient; v: logarithms of coefficients, then of sds."""
    theta, sds = np.exp(v[:2]), np.exp(v[2:])
    sd, noise = case.split(sds)
    w = np.linalg.inv((z * sd**2) @ z.T + np.diag(noise**2))
    r = case.y + z @ b - case.predict(theta, b)
    wr = w @ r
    value = 0.5 * (np.linalg.slogdet(w)[1] - len(r) * np.log(2 * np.pi) - r @ wr) + case.log_prior(sds)
    by_theta = theta * (derivatives(lambda t: case.predict(t, b), theta).T @ wr)
    by_effect = sd**2 * ((z.T @ wr) ** 2 - np.einsum("ij,ik,kj->j", z, w, z))
    by_reading = noise**2 * (wr**2 - np.diag(w))
    components = len(sds) - case.noises
    by_sd = np.concatenate([np.bincount(case.component, by_effect, components), np.bincount(case.kind, by_reading, case.noises)])
    by_sd -= [p[1] * (s / p[0]) ** 2 if p else 0.0 for s, p in zip(sds, case.priors)]
    return value, np.concatenate([by_theta, by_sd])


def alternate(case, theta, sds):
    v, b = np.log(np.concatenate([theta, sds])), np.zeros(len(case.component))
    for _ in range(500):
        before = np.concatenate([v, b])
        b = modes(case, np.exp(v[:2]), np.exp(v[2:]), b)
        z = derivatives(lambda c: case.predict(np.exp(v[:2]), c), b)
        below = lambda v: tuple(-part for part in marginal(case, v, b, z))
        # From afar within bounds, so that no step leads where V is singular; BFGS then goes as far as rounding lets it.
        near = optimize.minimize(below, v, jac=True, method="L-BFGS-B", bounds=[(x - 1, x + 1) for x in v]).x
        v = optimize.minimize(below, near, jac=True, method="BFGS", options={"gtol": 1e-10}).x
        if np.max(np.abs(np.concatenate([v, b]) - before)) < 1e-9:
            return marginal(case, v, b, z)[0], v, b, z
    raise AssertionError("the alternation does not end")


def restricted(case, v, b, z, away):
    """Standard deviations at the maximum of the restricted likelihood of the linear model at the end of a fit."""
    theta = np.exp(v[:2])
    x = derivatives(lambda t: case.predict(t, b), theta)
    y = case.y + z @ b - case.predict(theta, b)

    def below(logs):
        sds = np.exp(logs)
        sd, noise = case.split(sds)
        w = np.linalg.inv((z * sd**2) @ z.T + np.diag(noise**2))
        information = x.T @ w @ x
        r = y - x @ np.linalg.solve(information, x.T @ w @ y)
        value = 0.5 * (np.linalg.slogdet(w)[1] - np.linalg.slogdet(information)[1] - r @ w @ r) + case.log_prior(sds)
        ratio = sds[0] / case.usual_gain
        return -value - (np.log(ratio / (1 + ratio**2)) if away else 0.0)

    options = {"xatol": 1e-8, "fatol": 1e-11, "maxiter": 5000, "adaptive": True}
    return np.exp(optimize.minimize(below, v[2:], method="Nelder-Mead", options=options).x)


def simulate(name, random, sessions, gain_sd, priors, misfit_sd=0.0, saturations=0):
    rows, session = [], 0
    a, c = 40.0, 3.0
    for specimen, count in enumerate(sessions):
        gain = gain_sd * random.standard_normal()
        misfit = misfit_sd * random.standard_normal(WAVES)
        for _ in range(count):
            offset = 0.3 * random.standard_normal()
            for x in np.round(random.uniform(0.5, 9.5, random.integers(5, 8)), 2).tolist():
                y = a * (1 + gain) * (1 - np.exp(-(x + offset) / c)) + misfit @ np.sin(np.pi * np.arange(1, WAVES + 1) * x / 10)
                rows.append((0, specimen, session, x, round(float(y + 0.4 * random.standard_normal()), 4)))
            session += 1
        for _ in range(saturations):
            rows.append((1, specimen, 0, 0.0, round(float(a * (1 + gain) + random.standard_normal()), 4)))
    return Case(name, rows, priors, usual_gain=0.02)


def write(case):
    ends = []
    for theta in ([40.0, 3.0], [25.0, 5.0]):
        for factor in (1.0, 0.2):
            sds = np.array([0.05, 0.2, 0.5][: len(case.priors) - case.noises] + [1.0] * case.noises)
            sds[: len(sds) - case.noises] *= factor
            ends.append(alternate(case, np.array(theta), sds))
    # More than one end would leave open which of them another implementation has to find.
    first = ends[0]
    assert all(abs(e[0] - first[0]) < 1e-6 and np.allclose(e[1], first[1], rtol=0, atol=1e-7) for e in ends)
    value, v, b, z = max(ends, key=lambda e: e[0])
    sds = np.exp(v[2:])
    gain, offset, misfit = np.split(b, np.cumsum([case.specimens, case.sessions]))
    found = {"log_likelihood": [value], "coefficients": np.exp(v[:2]), "sd": sds, "gain": gain, "offset": offset, "misfit": misfit}
    found["restricted_sd"] = restricted(case, v, b, z, away=False)
    if case.priors[0]:
        found["away_sd"] = restricted(case, v, b, z, away=True)
    FOLDER.mkdir(parents=True, exist_ok=True)
    made = "# Made by tests/scripts/mixed_nonlinear.py: "
    # As many digits as the starts above agree in.
    lines = [",".join([q, *(f"{x:.9g}" for x in values)]) for q, values in found.items() if len(values)]
    (FOLDER / f"{case.name}_expected.csv").write_text("\n".join([made + "quantity, values.", *lines]) + "\n")
    rows = [",".join(map(repr, row)) for row in case.rows]
    head = made + "class, specimen, session, x, y; of class 1 session and x mean nothing."
    (FOLDER / f"{case.name}.csv").write_text("\n".join([head, *rows]) + "\n")


def main():
    random = np.random.default_rng(20240612)
    write(simulate("one_noise", random, [3, 2, 4, 3, 2, 2], 0.08, [None, None, None]))
    half_normal = [(0.05, 6), None, (0.4, 6), None, None]
    write(simulate("two_noises", random, [2, 3, 1, 2, 2, 3], 0.08, half_normal, misfit_sd=0.6, saturations=3))


main()
