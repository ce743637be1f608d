"""Writes tests/data/mixed/linear.csv and linear_expected.csv: readings of nested groups and their linear mixed model, by statsmodels (0.15.0).

Usage, from the root of the repository: python3 tests/scripts/mixed_linear.py
Needs numpy, scipy, pandas and statsmodels. For src/inference/reference_tests.rs.

The model is y = b0 + b1 x + g_k x + z_s + e: a gain g of every specimen, a zero z of every session within a specimen. Groups are of unequal
sizes, so that no closed form of balanced designs holds.

Constants of the log-likelihoods: MixedLM profiles out the variance of the noise and keeps every constant of the density. With n readings and p
fixed effects
    ML:   -1/2 (n log 2 pi + log|V| + r' V^-1 r)
    REML: -1/2 ((n - p) log 2 pi + log|V| + log|X' V^-1 X| + r' V^-1 r)
without the +1/2 log|X'X| that some programs add to REML. A covariance written out as a matrix is the judge: both formulae are evaluated with
it here, and the maximum is found again from it, by other code than that of statsmodels.
"""

import pathlib
import warnings

import numpy as np
import pandas as pd
from scipy import optimize
from statsmodels.regression.mixed_linear_model import MixedLM
from statsmodels.tools.sm_exceptions import ConvergenceWarning

FOLDER = pathlib.Path(__file__).parents[1] / "data" / "mixed"
SPECIMENS = 7
INTERCEPT, SLOPE, GAIN, ZERO, NOISE = 2.0, 1.5, 0.25, 0.8, 0.5


def readings():
    random = np.random.default_rng(20240611)
    rows, session = [], 0
    for specimen in range(SPECIMENS):
        gain = GAIN * random.standard_normal()
        for _ in range(random.integers(2, 5)):
            zero = ZERO * random.standard_normal()
            for _ in range(random.integers(3, 7)):
                x = round(random.uniform(0, 8), 2)
                y = INTERCEPT + (SLOPE + gain) * x + zero + NOISE * random.standard_normal()
                rows.append((specimen, session, x, round(y, 4)))
            session += 1
    return pd.DataFrame(rows, columns=["specimen", "session", "x", "y"])


def fit(data, reml):
    """Fixed effects, standard deviations (gain, zero, noise), predicted gains and zeros, log-likelihood."""
    model = MixedLM.from_formula(
        "y ~ x",
        data,
        groups="specimen",
        re_formula="0 + x",
        vc_formula={"session": "0 + C(session)"},
    )
    with warnings.catch_warnings():
        # The line search ends where rounding hides further gains; the maximum is compared with that of the dense covariance instead.
        warnings.simplefilter("ignore", ConvergenceWarning)
        result = model.fit(reml=reml, method=["bfgs", "lbfgs"], gtol=1e-9)
    sds = np.sqrt([result.cov_re.iloc[0, 0], result.vcomp[0], result.scale])
    gains = [result.random_effects[k]["x"] for k in range(SPECIMENS)]
    zeros = [v for k in range(SPECIMENS) for name, v in result.random_effects[k].items() if name.startswith("session")]
    return result.fe_params.to_numpy(), sds, np.array(gains), np.array(zeros), result.llf


class Dense:
    """The same model with V written out."""

    def __init__(self, data):
        self.y = data["y"].to_numpy()
        self.x = np.column_stack([np.ones(len(data)), data["x"]])
        member = lambda name: (data[name].to_numpy()[:, None] == np.arange(data[name].max() + 1)).astype(float)
        self.gains = member("specimen") * data["x"].to_numpy()[:, None]
        self.zeros = member("session")

    def at(self, sds, reml):
        """Log-likelihood maximised over the fixed effects, these, and the predicted random effects."""
        gain, zero, noise = sds
        v = gain**2 * self.gains @ self.gains.T + zero**2 * self.zeros @ self.zeros.T + noise**2 * np.eye(len(self.y))
        w = np.linalg.inv(v)
        information = self.x.T @ w @ self.x
        fixed = np.linalg.solve(information, self.x.T @ w @ self.y)
        wr = w @ (self.y - self.x @ fixed)
        free = len(self.y) - (len(fixed) if reml else 0)
        log_det = np.linalg.slogdet(v)[1] + (np.linalg.slogdet(information)[1] if reml else 0.0)
        value = -0.5 * (free * np.log(2 * np.pi) + log_det + self.y @ wr)
        return value, fixed, gain**2 * self.gains.T @ wr, zero**2 * self.zeros.T @ wr

    def maximum(self, reml):
        """Standard deviations at the maximum, from several starts."""
        below = lambda logs: -self.at(np.exp(logs), reml)[0]
        options = {"xatol": 1e-9, "fatol": 1e-12, "maxiter": 4000}
        starts = np.log([[0.05, 2.0, 0.4], [0.5, 0.1, 0.4]])
        ends = [optimize.minimize(below, s, method="Nelder-Mead", options=options) for s in starts]
        return np.exp(min(ends, key=lambda e: e.fun).x)


def main():
    data = readings()
    dense = Dense(data)
    lines = ["# Made by tests/scripts/mixed_linear.py with statsmodels: likelihood, quantity, values."]
    for name, reml in (("ml", False), ("reml", True)):
        fixed, sds, gains, zeros, value = fit(data, reml)
        there, fixed_there, gains_there, zeros_there = dense.at(sds, reml)
        worst = {
            "log-likelihood": abs(there - value),
            "sd": np.max(np.abs(dense.maximum(reml) / sds - 1)),
            "fixed": np.max(np.abs(fixed_there - fixed)),
            "gains": np.max(np.abs(gains_there - gains)),
            "zeros": np.max(np.abs(zeros_there - zeros)),
        }
        print(name, value, sds, fixed, {k: f"{v:.1e}" for k, v in worst.items()})
        assert worst["log-likelihood"] < 1e-8
        assert worst["sd"] < 1e-6
        assert max(worst["fixed"], worst["gains"], worst["zeros"]) < 1e-9
        for quantity, values in (
            ("log_likelihood", [value]),
            ("fixed", fixed),
            ("sd", sds),
            ("gain", gains),
            ("zero", zeros),
        ):
            lines.append(",".join([name, quantity, *(f"{v:.10g}" for v in values)]))
    FOLDER.mkdir(parents=True, exist_ok=True)
    head = "# Made by tests/scripts/mixed_linear.py: specimen, session, x, y.\n"
    rows = [f"{r.specimen},{r.session},{r.x!r},{r.y!r}" for r in data.itertuples()]
    (FOLDER / "linear.csv").write_text(head + "\n".join(rows) + "\n")
    (FOLDER / "linear_expected.csv").write_text("\n".join(lines) + "\n")


main()
