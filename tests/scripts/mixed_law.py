"""Predicts by the laws of mixed models again, with NumPy alone, and compares with `pipeline predict`; shares no code with the program.

    python3 tests/scripts/mixed_law.py PROGRAM [FOLDER [CAMPAIGN ...]]

FOLDER is a project that has been run; CAMPAIGN picks some of its laws. Without one, campaigns are simulated and run: without effects, with a sharp
and a gradual threshold of the bladder, and two that make a pool.

For every law: force, parts of its variance, degrees of freedom and interval of a muscle of which nothing is known, its own, as the rig reads it, and
at a length known to 1.5 mm; what each effect changes. Then of muscles that are simulated with a few readings, and of one that the law was made of:
gain, set lengths, the same in one more session, and what the next reading would be worth.

Everything that is not known (common misfit, share of noted contractions that is error, coefficients, effects, gains, lengths, zeros, misfits of
sessions and strokes) stands in physical units in one vector u with a prior covariance S. Derivatives J are central differences, and readings y with noise R say of it what a textbook has:
    V = J S J' + R,  u' = u + S J' V^-1 (y - f(u)),  S' = S - S J' V^-1 J S,
about the last u for what acts nonlinearly (gains, contracted and set lengths, zeros), until it stays.

Ends with status 1 where a difference is above 1e-6 of the value, and after readings, where the program stops short of the mode, above 1e-3 N.
"""

import csv
import json
import math
import pathlib
import re
import subprocess
import sys
import tempfile
import tomllib

import numpy as np

P_620, WIDTH, NEAR_SLACK, SURELY_SLACK = 620.0, 0.03, 0.03, 0.1
COMMON_LENGTH, SESSION_LENGTH, STROKE_LENGTH = 0.45, 100 / P_620, 200 / P_620
PAIRS = [(j, k) for j in range(6) for k in range(6 - j)][1:]
OF_ACTUATOR = {"bladder_threshold", "rest_length_scaling", "temperature", "creep", "conditioning", "hysteresis", "rate_dependence"}
# Of the readings here nobody knows what these go by: they are 0.
WITHOUT_TRACE = {"creep", "force_drift", "temperature", "rate_dependence"}
OWN = ["campaign gain", "campaign zero", "gain", "rest", "contracted"]
NONLINEAR = ["campaign gain", "campaign zero", "gain", "contracted", "set length", "zero"]
PARTS = ["estimation_n", "campaign_n", "gain_n", "lengths_n", "set_length_n", "zero_n", "misfit_n", "noise_n"]


def cosines(count, x, length):
    """A Gaussian process of unit variance as a sum of cosines from -length to 1 + length."""
    k, part = np.arange(count), length / (1 + 2 * length)
    density = np.where(k == 0, 1, 2) * part * math.sqrt(2 * math.pi) * np.exp(-0.5 * (math.pi * k * part) ** 2)
    return np.sqrt(density) * np.cos(math.pi * k * (x + length) / (1 + 2 * length))


def t_quantile(freedom):
    """What Student's t exceeds in size in 5%; t = sqrt(freedom) tan(a) has the density cos(a)^(freedom - 1)."""
    nodes, weights = np.polynomial.legendre.leggauss(80)
    log_front = math.lgamma(0.5 * (freedom + 1)) - math.lgamma(0.5 * freedom) - 0.5 * math.log(math.pi)
    low, high = 0.0, 1e3
    for _ in range(80):
        t = 0.5 * (low + high)
        a = 0.5 * math.atan(t / math.sqrt(freedom))
        within = 2 * a * weights @ np.exp(log_front + (freedom - 1) * np.log(np.cos(a * (nodes + 1))))
        low, high = (t, high) if within < 0.95 else (low, t)
    return low


def slopes(f, at, steps):
    """Central differences of eighth order."""
    weights = {1: 4 / 5, 2: -1 / 5, 3: 4 / 105, 4: -1 / 280}
    moved = lambda k, j: f([x + j * steps[k] * (i == k) for i, x in enumerate(at)])
    return np.array([sum(w * (moved(k, j) - moved(k, -j)) for j, w in weights.items()) / steps[k] for k in range(len(at))])


class NotAbove(Exception):
    """A state that is not above the onset."""


def friction(change, force, pulls):
    if pulls or force <= 0:
        return change * pulls
    return change / math.hypot(1, change / force)


class Reading:
    """A state, or a reading with what was before it."""

    def __init__(self, rest, contracted, length, kpa, **known):
        self.rest, self.contracted, self.length, self.kpa, self.highest = rest, contracted, length, kpa, kpa
        self.direction, self.first_filling, self.as_read = 0, False, True
        self.campaign = self.force = self.session = self.stroke = self.set_sd = None
        self.__dict__.update(known)
        x = (rest - length) / rest / 0.01
        self.sliding = x * x / (x * x + 1)


class Law:
    def __init__(self, law):
        self.__dict__.update(law)
        self.size = law["sd"]
        self.pooled = len(self.campaigns) > 1
        self.mean = np.array(self.common_mean + [0.0] * len(self.free))
        assert len(self.common_mean) == len(PAIRS) + 1 + 2 * self.pooled * len(self.campaigns)
        root = np.zeros((len(self.mean), len(self.mean)))
        root[np.tril_indices(len(root))] = self.root
        self.covariance = root @ root.T

    def noted_off(self, r):
        """By how many mm the contracted length is longer than noted if what is noted were all error; none here is declared."""
        if self.noted_contraction is None:
            return 0.0
        return 1e3 * ((r.rest - r.contracted) - r.rest * self.noted_contraction)

    def name(self, term):
        what = term["what"]
        return what if isinstance(what, str) else what.get("effect", {}).get("id", "column")

    def surface(self, c, contraction, kpa):
        return c[0] * (math.exp(-c[1] * contraction) - 1) + kpa / P_620 * math.exp(-c[2] * contraction**2)

    def share(self, r):
        """The force by the law that tells where an actuator is slack, relative to that at 620 kPa."""
        return self.surface(self.shape, (r.rest - r.length) / (r.rest - r.contracted), r.kpa)

    def side(self, r):
        if abs(r.force) >= max(NEAR_SLACK, -0.5 * self.share(r)) * self.largest_n:
            return "pulls"
        return "slack" if -self.share(r) > SURELY_SLACK else "corner"

    def plain(self, c, kpa, length, r, side, longer_mm=(0.0, 0.0)):
        rest, contracted = r.rest + 1e-3 * longer_mm[0], r.contracted + 1e-3 * longer_mm[1]
        share = self.surface(c[2:], (rest - length) / (rest - contracted), kpa)
        share = {"pulls": share, "slack": 0.0, "corner": 0.5 * (share + math.hypot(share, WIDTH))}[side]
        return share * c[0] * math.atan((rest - self.cap_length_m) / c[1])

    def acting(self, r, without):
        """The terms that act, with the places of their two numbers."""
        for t, term in enumerate(self.terms):
            if t == without or not (r.as_read or self.name(term) in OF_ACTUATOR):
                continue
            group = 0
            if term["acts"] != "all":
                some = term["acts"]["sessions"]
                group = some["amplitude"].get(r.session, 0 if some["later"] else None)
            if group is not None:
                is_effect = "effect" in term["what"]
                yield t, [group, len(term["values"]) - 1] if is_effect else [2 * group, 2 * group + 1]

    def chain(self, r, side, c, values, gain, longer_mm, set_length, zero, without):
        """What the sensor shows, without misfit: inputs, actuator in its frame, sensor."""
        terms = [(self.name(self.terms[t]), self.terms[t]["what"], [values[t][p] for p in places]) for t, places in self.acting(r, without)]
        effects = [(name, what["effect"]["form"], a) for name, what, (a, _) in terms if "effect" in what and name not in WITHOUT_TRACE]
        kpa, length, compliance, pulls = r.kpa, r.length + 1e-3 * set_length, 0.0, side == "pulls"
        for name, form, a in effects:
            if name == "pressure_gain":
                kpa *= 1 + a
            elif name == "pressure_zero_offset":
                kpa -= a
            elif name == "bladder_threshold":
                kpa = max(0.0, kpa - a) if form == "sharp" else kpa - a * (1 - math.exp(-kpa / a))
            elif name == "length_offset":
                length += 1e-3 * a
            elif name == "series_compliance":
                compliance += 1e-6 * a
        pull = lambda force: gain * self.plain(c, kpa, length - compliance * force, r, side, longer_mm)
        force, before = pull(0.0), 0.0
        for _ in range(60 if compliance else 0):
            g, g_before = force - pull(force), before - pull(before)
            if g == g_before:
                break
            force, before = force - g * (force - before) / (g - g_before), force
        for name, form, a in effects:
            if name == "force_gain":
                force *= 1 + a
            elif (name, form) == ("force_zero_offset", "constant"):
                force += a
            elif (name, form) == ("hysteresis", "constant"):
                force -= friction(a * r.direction, force, pulls)
            elif (name, form) == ("hysteresis", "constant, slack too"):
                force -= a * r.direction
            elif (name, form) == ("hysteresis", "sliding, closed at the top"):
                force -= friction(2 * a * r.direction * r.sliding * (1 - r.kpa / r.highest), force, pulls)
            elif (name, form) == ("conditioning", "first filling"):
                force -= friction(a * r.sliding * r.first_filling, force, pulls)
            else:
                inputs = {"pressure_gain", "pressure_zero_offset", "bladder_threshold", "length_offset", "series_compliance"}
                assert name in inputs, f"this script has no {name}, {form}"
        force += zero
        for name, what, (a, b) in terms:
            # Other columns have their mean here.
            if name in ("force", "pressure"):
                x = force / 500 if name == "force" else r.kpa / P_620
                force *= 1 + (b * x + a) * x
        return force

    def misfit(self, r, side):
        """The scale of the misfit, N, and the columns of the common one."""
        if side == "slack":
            return 0.0, np.zeros(len(PAIRS))
        c = self.beside["coefficients"]
        force = lambda c: self.plain(c, r.kpa, r.length, r, side)
        scale = (max(force(c), 0.0) + self.floor_n) / (1 + self.floor_n / self.largest_n)
        x, y = (cosines(6, z, COMMON_LENGTH) for z in [(r.rest - r.length) / (r.rest - r.contracted), r.kpa / P_620])
        by_law = slopes(force, c, [1e-2 * abs(x) for x in c])[self.beside["free"]]
        return scale, scale * np.array([x[j] * y[k] for j, k in PAIRS]) - np.array(self.beside["weights"]) @ by_law

    def view(self, r, u, sessions=(), without=None):
        """Force, its derivatives by everything, by a session and by a stroke of its own, mean and noise beside it, about a point."""
        n, common = len(self.mean), len(self.common_mean)
        place = self.campaigns.index(r.campaign) if r.campaign in self.campaigns else None
        noting, off = len(PAIRS), self.noted_off(r)
        known = [noting + 1 + place, noting + 1 + len(self.campaigns) + place] if self.pooled and place is not None else []
        mine = n + len(OWN) + 10 * list(sessions).index(r.session) if r.session in sessions else None
        flat = [v for term in self.terms for v in term["values"]]
        first = np.cumsum([5] + [len(term["values"]) for term in self.terms])

        def force(x, side):
            values = [x[a:b] for a, b in zip(first, first[1:])]
            error, known_gain, known_zero, campaign_gain, campaign_zero, gain, rest, contracted, set_length, zero = x[first[-1] :]
            contracted += (0.5 + 0.5 * error) * off
            gain = (1 + gain) * (1 + campaign_gain) * (1 + known_gain)
            zero = r.as_read * (known_zero + campaign_zero + zero)
            return self.chain(r, side, x[:5], values, gain, (rest, contracted), set_length, zero, without)

        # What acts linearly stands at its estimate.
        at = [*self.coefficients, *flat, self.mean[noting], *(self.mean[known] if known else (0, 0)), *u[n : n + 3], 0, u[n + 4], *(u[mine : mine + 2] if mine else (0, 0))]
        steps = [1e-2 * abs(x) for x in self.coefficients] + [1e-2 * abs(v) for v in flat] + [1e-2, 1e-2, 1, 1e-2, 1, 1e-2, 0.1, 0.1, 0.1, 1]
        side = "pulls" if r.force is None else self.side(r)
        if r.force is None and force(at, side) <= NEAR_SLACK * self.largest_n:
            raise NotAbove(f"{r.kpa} kPa: no state that pulls")
        slope = slopes(lambda x: force(x, side), at, steps)
        scale, columns = self.misfit(r, side)
        row, own = np.zeros(len(u)), slope[first[-1] :]
        row[: len(PAIRS)] = columns
        row[noting], own = own[0], own[1:]
        if known:
            row[known] = own[:2]
        for k, slot in enumerate(self.free):
            row[common + k] = slope[slot["coefficient"]] if "coefficient" in slot else slope[first[slot["value"][0]] + slot["value"][1]]
        row[n : n + 5] = own[2:7]
        if not self.pooled or known:
            row[n : n + 2] = 0
        of_session = np.concatenate([own[7:], scale * cosines(8, r.kpa / P_620, SESSION_LENGTH)])
        of_stroke = scale * cosines(5, r.kpa / P_620, STROKE_LENGTH)
        if mine:
            row[mine : mine + 10] = of_session
            if self.size["stroke_misfit"]:
                row[n + len(OWN) + 10 * len(sessions) + 5 * r.stroke :][:5] = of_stroke
        noise = self.size["noise_n"]
        shown = 0.0, math.sqrt(np.mean(np.square(noise))) if place is None else noise[place]
        if side == "corner":
            shown = self.size["corner_n"][np.searchsorted([0.5, 1.5, 3.0], abs(self.share(r)) / WIDTH)]
        return force(at, side) + columns @ self.mean[: len(PAIRS)], row, of_session, of_stroke, *shown


class Muscle:
    """What is known of a muscle of a resting length, m: by the law, or with readings."""

    def __init__(self, law, rest, readings=(), in_law=False):
        self.law, self.rest, size, n = law, rest, law.size, len(law.mean)
        self.sessions = {r.session: size["set_length_mm"] if r.set_sd is None else size["declared_factor"] * r.set_sd for r in readings}
        strokes = len({r.stroke for r in readings}) if size["stroke_misfit"] else 0
        self.names = np.array(["law"] * n + OWN + ["set length", "zero", *["misfit"] * 8] * len(self.sessions) + ["misfit"] * 5 * strokes)
        own = [size[k] for k in ("campaign_gain", "campaign_zero_n", "gain", "rest_length_mm")]
        own += [math.hypot(size["contracted_length_mm"], 1e3 * rest * size["contraction"])]
        for set_sd in self.sessions.values():
            own += [set_sd, size["zero_n"], *[size["session_misfit"]] * 8]
        own += [size["stroke_misfit"]] * 5 * strokes
        self.prior = np.concatenate([law.mean, np.zeros(len(own))])
        self.covariance = np.diag(np.concatenate([np.zeros(n), np.square(own)]))
        self.covariance[:n, :n] = law.covariance
        self.u, self.sd_before, self.before = self.prior, np.sqrt(np.diag(self.covariance)), self.covariance
        self.linear = ~np.isin(self.names, NONLINEAR)
        if readings:
            # From nothing, and from where readings lead without misfit: the likelier of both.
            starts = [self.mode(readings, in_law, stages) for stages in ([True], [False, True])]
            self.u, self.covariance, _ = min(starts, key=lambda start: start[2])

    def mode(self, readings, in_law, stages):
        u, own, y = self.prior, self.names != "law", np.array([r.force for r in readings])
        for misfit in stages:
            stays = ((self.names == "misfit") & (not misfit)) | (~own & in_law)
            s = np.where(np.outer(stays, stays) | stays | stays[:, None], 0.0, self.covariance)
            for _ in range(200):
                views = [self.law.view(r, u, self.sessions) for r in readings]
                j, noise = np.array([v[1] for v in views]), np.array([v[5] for v in views])
                f = np.array([v[0] + v[4] for v in views]) + j @ np.where(self.linear, u - self.prior, 0.0)
                v = j @ s @ j.T + np.diag(noise**2)
                there = self.prior + s @ j.T @ np.linalg.solve(v, y - f + j @ (u - self.prior))
                step = np.max(np.abs(there - u) / np.where(self.sd_before > 0, self.sd_before, 1))
                u = there
                if step < 1e-10:
                    break
            assert step < 1e-6, f"no mode: {step}"
        weight = np.linalg.solve(v, j @ s)
        covariance = s - s @ j.T @ weight
        if in_law:
            # Its readings told of the law before, which stays; what is the muscle's own follows it.
            follows = np.eye(len(u)) - weight.T @ np.where(own, 0.0, j)
            covariance = covariance + follows @ np.where(np.outer(own, own), 0.0, self.covariance) @ follows.T
        left, moved = (y - f) / noise, u - self.prior
        return u, covariance, left @ left + moved @ np.linalg.pinv(self.covariance, rcond=1e-14, hermitian=True) @ moved

    def row(self, r, without=None):
        return self.law.view(r, self.u, without=without)

    def at(self, r, length_sd):
        """The force in one more session, its parts, freedom and interval."""
        law, size, n = self.law, self.law.size, len(self.law.mean)
        f, j, of_session, of_stroke, _, noise = self.row(r)
        mean = f + j @ np.where(self.linear, self.u - self.prior, 0.0)
        part = lambda c, a, b: math.sqrt(max(0.0, j[a:b] @ c[a:b, a:b] @ j[a:b]))
        unread = [part(self.before, *ends) for ends in [(0, n), (n, n + 2), (n + 2, n + 3), (n + 3, n + 5)]]
        known = [part(self.covariance, 0, len(j)), 0, 0, 0] if self.sessions else unread
        set_sd = size["set_length_mm"] if length_sd is None else length_sd
        misfit = np.concatenate([of_session[2:] * size["session_misfit"], of_stroke * (size["stroke_misfit"] or 0)])
        parts = [*known, abs(of_session[0]) * set_sd, abs(of_session[1]) * size["zero_n"], np.linalg.norm(misfit), r.as_read * noise]
        specimens, sessions, campaigns = (max(k - 1, 1) for k in (len(law.specimens), law.sessions, len(law.campaigns)))
        of_length = math.inf if size["set_length_declared"] or length_sd is not None else sessions
        of_lengths = specimens if 1e3 * self.rest * size["contraction"] > size["contracted_length_mm"] else math.inf
        groups = [specimens, campaigns, specimens, of_lengths, of_length, sessions, sessions, max(law.readings - law.sessions, 1)]
        variance = sum(np.square(parts))
        of_sum = lambda sds, groups: min(sum(np.square(sds)) ** 2 / sum(p**4 / k for p, k in zip(sds, groups)), 1e5)
        # Readings take no degrees of freedom from what was not known before them.
        freedom = of_sum(parts, [of_sum(unread, groups), *groups[1:]] if self.sessions else groups)
        half, least = t_quantile(freedom) * math.sqrt(variance), -math.inf if r.as_read else 0.0
        ends = {"low_n": max(mean - half, least), "high_n": max(mean + half, least)}
        return {"force_n": max(mean, least), **dict(zip(PARTS, parts)), "freedom": freedom, **ends}

    def worth(self, here, there, length_sd):
        """Standard deviation of the force here before and after a reading of the rig there in another session."""
        (a, b), of_a, of_b = [self.row(r)[1] for r in (here, there)], self.at(here, length_sd), self.at(there, None)
        alike, other = (sum(of[k] ** 2 for k in PARTS[4:]) for of in (of_a, of_b))
        before = a @ self.covariance @ a + alike
        return math.sqrt(before), math.sqrt(before - (a @ self.covariance @ b) ** 2 / (b @ self.covariance @ b + other))


class Compared:
    """The program, and how far from it this is: the largest differences by quantity."""

    def __init__(self, program, folder):
        self.program, self.folder, self.calls, self.bad, self.worst = str(pathlib.Path(program).resolve()), folder, 0, 0, {}

    def run(self, *arguments):
        self.calls += 1
        said = subprocess.run([self.program, *map(str, arguments)], cwd=self.folder, capture_output=True, text=True)
        assert said.returncode == 0, (arguments, said.stderr)
        return said.stdout

    def predict(self, law, *arguments):
        return json.loads(self.run("predict", "--campaign", law.campaign, "--json", *arguments))

    def number(self, what, quantity, ours, theirs, absolute, relative=1e-6):
        difference = abs(ours - theirs)
        if not difference <= max(absolute, relative * abs(theirs)):
            self.bad += 1
            print(f"{what}: {quantity} {ours:.10g}, the program has {theirs:.10g}")
        key = ("with readings" if "readings" in what else "without", quantity)
        count, most, share = self.worst.get(key, (0, 0.0, 0.0))
        self.worst[key] = count + 1, max(most, difference), max(share, difference / max(abs(theirs), 1e-6))

    def forecast(self, what, ours, force_n, interval, absolute):
        for quantity, value in ours.items():
            # The degrees of freedom go with the fourth power of the parts.
            limits = (0.0, 1e-6 if absolute < 1e-6 else 1e-4) if quantity == "freedom" else (absolute,)
            self.number(what, quantity, value, {"force_n": force_n, **interval}[quantity], *limits)


def state(answer, **known):
    rest, eps = answer["muscle"]["rest_length_m"], answer["muscle"]["contraction_620"]
    return Reading(rest, rest * (1 - eps), answer["length_m"], answer["pressure_kpa"], **known)


def unread(compared, law):
    """A dozen states that pull, each with three intervals; returns the mean contraction of specimens at 620 kPa."""
    probe = ["--diameter", law.diameter_mm, "--rest-length", "300mm", "--contraction", "0", "--pressure", "600kPa"]
    ranges = compared.predict(law, *probe)["fit"]["ranges"]
    eps, (shortest, longest) = np.mean(ranges["contraction_620"]), ranges["rest_length_m"]
    for part, contraction, kpa in [(0.1, 0, 200), (0.4, 0, 550), (0.9, 0.01, 600), (0.2, 0.03, 620), (0.6, 0.04, 450), (0.5, 0.07, 580)]:
        rest = f"{shortest + part * (longest - shortest):.4f}m"
        asked = ["--diameter", law.diameter_mm, "--rest-length", rest, "--contraction-620", f"{eps:.4f}", "--contraction", contraction]
        asked += ["--sweep", "pressure", "--from", f"{kpa}kPa", "--to", f"{kpa + 20}kPa", "--step", "20kPa"]
        for options, as_read, length_sd in [([], False, None), (["--as-read"], True, None), (["--length-sd", "1.5mm"], False, 1.5)]:
            for answer in compared.predict(law, *asked, *options)["sweep"]["answers"]:
                what = f"{law.campaign}, {rest}, {contraction}, {answer['pressure_kpa']} kPa {' '.join(options)}"
                muscle = Muscle(law, answer["muscle"]["rest_length_m"])
                compared.forecast(what, muscle.at(state(answer, as_read=as_read), length_sd), answer["force_n"], answer["interval"], 1e-9)
                for t, effect in enumerate(answer["effects"]):
                    change = muscle.row(state(answer))[0] - muscle.row(state(answer), without=t)[0]
                    compared.number(what, "change_n", change, effect["change_n"], 1e-9)
    return eps


def readings_in(folder):
    """The readings of sessions of points that the simulator wrote."""
    readings, strokes = [], {}
    said = [(tomllib.loads(path.read_text()), path.parent) for path in pathlib.Path(folder).rglob("session.toml")]
    for session, place in sorted(said, key=lambda s: s[0]["id"]):
        specimen, vented = session["specimen"], False
        lengths = [1e-3 * x for x in (specimen["rest_length_mm"], specimen["contracted_length_mm"], session["setup"]["length_mm"])]
        rows = list(csv.DictReader((place / session["log"][0]["file"]).open()))
        for row in rows:
            direction = {"1": 1, "2": -1, None: 0}[row.get("phase")]
            vented |= direction < 0
            known = {"force": float(row["force_n"]), "direction": direction, "first_filling": direction > 0 and not vented}
            known |= {"session": session["id"], "campaign": session["campaign"], "set_sd": session["setup"].get("length_sd_mm")}
            stroke = strokes.setdefault((session["id"], direction < 0), len(strokes))
            known |= {"highest": max(float(r["pressure_kpa"]) for r in rows), "stroke": stroke}
            readings.append(Reading(*lengths, float(row["pressure_kpa"]), **known))
    return readings


def read(compared, law, folder, name, in_law=False):
    """A muscle with the readings in a folder, at three states."""
    readings = readings_in(folder)
    muscle, n = Muscle(law, readings[0].rest, readings, in_law), len(law.mean)
    known = {"campaign": readings[0].campaign}
    for contraction, kpa, options, length_sd in [(0.02, 500, [], None), (0.04, 600, ["--as-read"], None), (0.0, 300, ["--length-sd", "0.5mm"], 0.5)]:
        said = compared.predict(law, "--calibrate", folder, "--contraction", contraction, "--pressure", f"{kpa}kPa", *options)
        answer, told, as_read = said["answer"], said["calibration"], "--as-read" in options
        what = f"{law.campaign}, readings ({name}), {contraction}, {kpa} kPa {' '.join(options)}"
        assert told["readings"] == len(readings), what
        here = state(answer, as_read=as_read, **known)
        compared.forecast(what, muscle.at(here, length_sd), answer["force_n"], answer["interval"], 1e-3)
        before = Muscle(law, readings[0].rest)
        compared.forecast(f"{law.campaign}, before", before.at(state(answer, as_read=as_read), length_sd), *answer["uncalibrated"], 1e-9)
        estimates = [("gain", {n + 2: 1}, told["specimen_gain"])]
        longer = {len(PAIRS): 0.5 * law.noted_off(readings[0]), n + OWN.index("contracted"): 1}
        estimates += [("contracted length", longer, told["contracted_length"])]
        estimates += [("set length", {n + len(OWN) + 10 * list(muscle.sessions).index(s["session"]): 1}, s) for s in told["set_lengths"]]
        for quantity, sum_of, theirs in estimates:
            row = np.zeros(len(muscle.u))
            row[list(sum_of)] = list(sum_of.values())
            sd, sd_before = (math.sqrt(row @ c @ row) for c in (muscle.covariance, muscle.before))
            usual = 0.5 * law.noted_off(readings[0]) * (quantity == "contracted length")
            ours = {"value": usual + row @ muscle.u, "value_before": usual + row @ muscle.prior, "sd": sd, "sd_before": sd_before}
            for end, value in ours.items():
                compared.number(what, f"{quantity}, {end}", value, theirs[end], 1e-4 * sd_before)
        percentile = 50 * (1 + math.erf(muscle.u[n + 2] / muscle.sd_before[n + 2] / math.sqrt(2)))
        compared.number(what, "percentile", percentile, told["percentile"], 1e-2)
        worth = told["next"]
        there = Reading(here.rest, here.contracted, here.rest * (1 - worth["contraction"]), worth["pressure_kpa"], as_read=True, **known)
        try:
            worth = [(f"next, {end}", value, worth[end]) for end, value in zip(["sd_before_n", "sd_after_n"], muscle.worth(here, there, length_sd))]
        except NotAbove:
            # It tells the zero of the force.
            worth = []
        for numbers in worth:
            compared.number(what, *numbers, 1e-3)


def simulate(compared, folder, campaign, seed, law, lengths, contractions, pressures, directions, effects="", spread=0.0):
    diameter, b1, b2, cap, (c0, c1, c2), eps = law
    text = f'schema = "bpa-truth/1"\ncampaign = "{campaign}"\nseed = {seed}\ndate = "2026-01"\ndiameter_mm = {diameter}\n'
    text += f"coefficients = {{ b1 = {b1}, b2 = {b2}, l_0 = {cap}, c0 = {c0}, c1 = {c1}, c2 = {c2} }}\ncontractions = {contractions}\n"
    text += f'runs = [1]\nsampling = "points"\npressures_kpa = {pressures}\ndirections = "{directions}"\n'
    for length in lengths:
        own_eps = eps * (1 + spread * math.sin(length))
        text += f'[[specimen]]\nid = "{campaign}-{length}"\nrest_length_mm = {length}\ncontraction_max = {own_eps:.4f}\n'
    text += '[[effect]]\nid = "specimen_variation"\nform = "normal"\nsd = 0.05\n[[effect]]\nid = "length_offset"\nsd = 0.8\n' + effects
    with tempfile.TemporaryDirectory() as place:
        file = pathlib.Path(place, "truth.toml")
        file.write_text(text)
        compared.run("simulate", file, "--out", folder, "--replace")


def edit(folder, pattern, by):
    for file in pathlib.Path(folder).rglob("session.toml"):
        file.write_text(re.sub(pattern, by, file.read_text()))


def project(compared):
    law = lambda b1: (10, b1, 19.03, 0.0075, (0.5682, 4.254, 0.5597), 0.165)
    lengths, low = [83, 112, 182, 257, 300, 382, 455], [10, 20, 30, 40, 60, 80, 120, 200, 350, 500, 620]
    threshold = '[[effect]]\nid = "bladder_threshold"\nthreshold_kpa = 40\nform = '
    zero = '[[effect]]\nid = "force_zero_offset"\nzero_n = 12\n'
    for campaign, *rest in [
        ("plain", 1, law(303.5), lengths, [0, 0.25, 0.5, 0.75], [200, 300, 400, 500, 620], "up-down"),
        ("sharp", 2, law(303.5), lengths, [0, 0.2, 0.4], low, "up", threshold + '"sharp"\n'),
        ("gradual", 3, law(303.5), lengths, [0, 0.2, 0.4], low, "up", threshold + '"smooth"\nwidth_kpa = 30\n'),
        ("pool-a", 4, law(303.5), lengths[::2], [0, 0.25, 0.5, 0.75], [200, 300, 400, 500, 620], "up-down"),
        ("pool-b", 5, law(390.0), [233, *lengths[1::2]], [0, 0.3, 0.6], [250, 350, 450, 550, 620], "up-down", zero),
    ]:
        # In one the contractions noted are all error, in the others actuators differ as noted.
        simulate(compared, compared.folder / "raw" / campaign, campaign, *rest, spread=0.06 * (campaign != "plain"))
        if campaign == "plain":
            noted = lambda line: f"contracted_length_mm = {float(line[1]) * (1 + 0.01 * math.sin(float(line[1]))):.2f}"
            edit(compared.folder / "raw" / campaign, r"contracted_length_mm = ([\d.]+)", noted)
        if campaign.startswith("pool"):
            # Simulated campaigns make no pool.
            edit(compared.folder / "raw" / campaign, 'notes = "simulated', 'notes = "made')
    # What takes long, and no law depends on.
    (compared.folder / "pipeline.toml").write_text("[fit]\nbootstrap_refits = 20\n[diagnose]\ndraws = 49\n[report]\npng_dpi = 20.0\n")
    compared.run("run")


def compare(compared, law, made):
    eps, c, own = unread(compared, law), law.coefficients, made / "own"
    length, some = [round(1e3 * law.origins["middle_rest_length_m"]) - 20], [200, 300, 400, 500, 620]
    simulated = lambda campaign, seed, *rest: simulate(
        compared, own, campaign, seed, (law.diameter_mm, 1.08 * c[0], 1 / c[1], law.cap_length_m, c[2:], eps), length, *rest
    )
    simulated("own", 24, [0.1, 0.4], some, "up-down")
    read(compared, law, own, "two sessions")
    edit(own, r"\[setup\]", "[setup]\nlength_sd_mm = 0.6")
    read(compared, law, own, "length declared")
    simulated("own", 25, [0.25], [300, 600], "up")
    read(compared, law, own, "two")
    if law.pooled:
        simulated(law.campaigns[-1], 26, [0.1, 0.4], some, "up-down")
        read(compared, law, own, "in a campaign of the pool")
    specimen = law.specimens[1].split(" ")[-1]
    of_law = [path for path in (compared.folder / "raw").rglob(f"{specimen}/*/session.toml") if 'sampling = "points"' in path.read_text()]
    if of_law:
        read(compared, law, of_law[0].parents[1], "of the law", in_law=True)


def main(program, folder=None, *wanted):
    with tempfile.TemporaryDirectory() as made:
        made = pathlib.Path(made)
        compared = Compared(program, pathlib.Path(folder or made).resolve())
        if not folder:
            project(compared)
        laws = [Law(law) for law in json.loads((compared.folder / "derived" / "mixed_laws.json").read_text())]
        for law in (law for law in laws if not wanted or law.campaign in wanted):
            print(f"{law.campaign}: {', '.join(law.name(term) for term in law.terms) or 'no effects'}", flush=True)
            compare(compared, law, made)
    print(f"\nlargest differences{'':26}count  absolute  relative")
    for key, (count, most, share) in sorted(compared.worst.items()):
        print(f"{key[0]:14} {key[1]:28} {count:6}   {most:.1e}   {share:.1e}")
    print(f"{compared.calls} calls of the program; {compared.bad} differences are too large")
    return 1 if compared.bad or not compared.worst else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
