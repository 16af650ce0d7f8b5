"""The machine of the default scan tracker, written down once more as its equations stand.

Dense and slow: every track is compared with every plot, the assignment is SciPy's, the maps are
dictionaries of cells, and nothing is shared with the package but the values that go in. What is
tested is the engine, by its tracks being the same.

One scan is `ReferenceMachine.step`; its order is that of the text:

 1. decay of the maps            5. gate, cost and assignment     9. deposits and their corrections
 2. deposit of every plot        6. merged plots                 10. births
 3. density of clutter           7. existence, bank, filter
 4. prediction                   8. kind, confirmation, deletion
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from scipy.optimize import linear_sum_assignment

UNDECIDED, MOVING, STATIC = 0, 1, 2


@dataclass(frozen=True)
class Numbers:
    """Parameters of the study under its symbols; rates per scan of `period`."""

    period: float = 1.678
    sr: float = 0.702  # noise: range (m), bearing (rad), extra (m)
    saz: float = 0.006
    sext: float = 0.7
    qa: float = 0.117  # acceleration (m/s²), speed of a new track (m/s)
    sv0: float = 1.85
    gate: float = 16.0
    vmax: float = 7.0
    pd: float = 0.624
    ps: float = 0.998
    lam0: float = 5.3e-7  # density of clutter (1/m²) and its weight (scans), of new targets
    n0: float = 32.0
    lb: float = 1.5e-5
    tau: float = 19.1  # clutter map
    wc: float = 0.353
    h: float = 31.0
    h2: float = 4.0
    wl: float = 1.0
    kap: float = 0.3
    w0: float = 0.479
    wsh: float = 6.5
    lc: float = 5.1  # confirmation, deletion, report
    lc2: float = 7.51
    wb: float = 0.208
    le: float = 0.74
    ld: float = -7.6
    lmax: float = 22.0
    lrep: float = -2.0
    minhit: int = 3
    kt: int = 4
    k: int = 14
    kc: int = 8
    sst: float = 2.31  # bank of hypotheses
    slo: float = 3.44
    srw: float = 9.68
    sar: float = 2.11
    sac: float = 7.63
    kr: float = 20.0
    lhr: float = 0.12
    chilo: float = 1.5
    tm: float = 0.5
    tst: float = -0.25
    lcs: float = 11.1
    hstat: int = 13
    rest: float = 3.0
    ff2: float = 0.996
    mdr: float = 8.0  # merged plots
    mdc: float = 6.0
    mda: float = 0.06
    mh: int = 2
    ks: int = 8
    bonus: float = 10.1


def sigmoid(x):
    return 1.0 / (1.0 + math.exp(-x)) if x > 0.0 else math.exp(x) / (1.0 + math.exp(x))


def log_normal(nu, s):
    """Logarithm of the normal density with covariance `s` at the distance `nu`."""
    return -0.5 * nu @ np.linalg.solve(s, nu) - math.log(2 * math.pi * math.sqrt(np.linalg.det(s)))


def log_round(nu, variance):
    """The same with one variance for both axes."""
    return log_normal(np.asarray(nu), variance * np.eye(2))


@dataclass
class Plot:
    z: np.ndarray
    t: float
    own: np.ndarray
    r: np.ndarray  # covariance
    row: int
    lam: float = 0.0

    @property
    def rbar(self):
        return math.sqrt(np.linalg.det(self.r))

    def sight(self):
        """Range, and unit vectors along and across the line of sight."""
        d = self.z - self.own
        r = math.hypot(*d)
        along = d / r if r > 0.0 else np.array([1.0, 0.0])
        return r, along, np.array([-along[1], along[0]])


@dataclass
class Track:
    id: int
    p: np.ndarray  # state at the last plot: position, velocity, variances
    v: np.ndarray
    var: tuple
    last: Plot
    existence: float  # log-odds L
    mean: np.ndarray  # of its plots, for the steady hypotheses
    ll: float
    weight: float
    held_plots: list
    looked: float
    hits: int = 1
    misses: int = 0
    shared: int = 0
    confirmed: bool = False
    kind: int = UNDECIDED
    strength: float = 0.0  # e
    evidence: np.ndarray = field(default_factory=lambda: np.zeros(4))  # E
    against: float = 0.0  # B
    ratio: float = 1.0  # rho
    plot: int = -1

    def at(self, t, n):
        """Position and variances at the time t."""
        gap, t0, q = t - self.last.t, n.period, n.qa**2
        if gap >= t0:
            noise = (
                q * t0 * (gap**3 / 3 - gap * t0**2 / 12),
                q * t0 * gap**2 / 2,
                q * t0 * gap,
            )
        else:
            noise = (q * gap**4 / 4, q * gap**3 / 2, q * gap**2)
        p11, p12, p22 = self.var
        return self.p + gap * self.v, (
            p11 + 2 * gap * p12 + gap**2 * p22 + noise[0],
            p12 + gap * p22 + noise[1],
            p22 + noise[2],
        )


class Grid:
    """A map with cloud-in-cell deposits; its nodes are at whole multiples of the cell."""

    def __init__(self, cell):
        self.cell, self.values = cell, {}

    def shares(self, z):
        x, y = z / self.cell
        i, j = math.floor(x), math.floor(y)
        a, b = x - i, y - j
        return {
            (i, j): (1 - a) * (1 - b),
            (i + 1, j): a * (1 - b),
            (i, j + 1): (1 - a) * b,
            (i + 1, j + 1): a * b,
        }

    def deposit(self, z, weight):
        for node, share in self.shares(z).items():
            self.values[node] = self.values.get(node, 0.0) + weight * share

    def read(self, z):
        return sum(share * self.values.get(node, 0.0) for node, share in self.shares(z).items())

    def own_share(self, z):
        return sum(share**2 for share in self.shares(z).values())

    def decay(self, factor):
        self.values = {node: value * factor for node, value in self.values.items()}


class ReferenceMachine:
    """Tracks of one radar; `step` takes a scan and returns the reported tracks."""

    def __init__(self, numbers=None):
        self.n = numbers or Numbers()
        self.grids = [Grid(self.n.h), Grid(self.n.h * self.n.h2)]
        self.scans_seen = 0.0  # W
        self.tracks, self.next_id, self.k = [], 1, 0

    def step(self, scan):
        n = self.n
        own = np.array(scan.own, float)
        for grid in self.grids:
            grid.decay(math.exp(-1 / n.tau))
        self.scans_seen = self.scans_seen * math.exp(-1 / n.tau) + 1
        plots = self.plots_of(scan, own)
        for plot in plots:
            self.deposit(plot.z, n.wc)
        for plot in plots:
            plot.lam = self.density(plot.z)

        gated = [
            {j: at for j, plot in enumerate(plots) if (at := self.gated(track, plot)) is not None}
            for track in self.tracks
        ]
        hit = self.assigned(gated, plots)
        looked = [plots[hit[i]].t if i in hit else scan.time for i in range(len(self.tracks))]
        prior = [self.survived(*each) for each in zip(self.tracks, looked, strict=True)]
        # Ratio of the likelihood with a target to that of clutter, at the plots in the gate.
        ratio = [
            {j: n.pd * math.exp(at) / plots[j].lam for j, at in near.items()} for near in gated
        ]
        posterior = [
            before + math.log(1 - n.pd + (ratio[i][hit[i]] if i in hit else 0.0))
            for i, before in enumerate(prior)
        ]
        held = self.merged(plots, prior, ratio, hit, posterior)

        alive = []
        for i, track in enumerate(self.tracks):
            plot = plots[hit[i]] if i in hit else None
            track.existence = min(posterior[i], n.lmax)
            track.plot = plot.row if plot else -1
            if plot:
                self.take(track, plot, gated[i][hit[i]])
            elif i in held:
                track.shared += 1
            else:
                track.misses += 1
                track.ratio -= n.lhr * track.ratio
            self.decide_kind(track, hit=plot is not None)
            before = track.confirmed
            track.confirmed = before or self.confirms(track)
            dead = track.existence < n.ld or track.misses > (n.k if track.confirmed else n.kt)
            self.judge_plots(track, plot, before, dead)
            if not dead:
                alive.append(track)
        self.tracks = alive + [
            self.born(plot) for j, plot in enumerate(plots) if j not in hit.values()
        ]
        self.k += 1
        return [track for track in self.tracks if self.reported(track)]

    def plots_of(self, scan, own):
        """Plots with their covariances: step 1 of the study."""
        n, plots = self.n, []
        for j, z in enumerate(np.asarray(scan.positions, float).reshape(-1, 2)):
            plot = Plot(
                z,
                scan.time if scan.times is None else float(scan.times[j]),
                own,
                np.eye(2),
                j if scan.rows is None else int(scan.rows[j]),
            )
            if scan.covariances is not None:
                xx, xy, yy = scan.covariances[j]
                plot.r = np.array([[xx, xy], [xy, yy]])
            elif np.isnan(own).any():
                plot.r = (n.sr**2 + n.sext**2) * np.eye(2)
            else:
                r, u, w = plot.sight()
                plot.r = (
                    n.sr**2 * np.outer(u, u)
                    + (n.saz * r) ** 2 * np.outer(w, w)
                    + n.sext**2 * np.eye(2)
                )
            plots.append(plot)
        return plots

    def deposit(self, z, weight):
        for grid in self.grids:
            grid.deposit(z, weight)

    def density(self, z):
        """Clutter at a plot, its own deposit taken out: steps 3 and 4 as changed by (b)."""
        n = self.n
        fine, coarse = (
            (n.lam0 * n.n0 + max(g.read(z) - n.wc * g.own_share(z), 0.0) / g.cell**2)
            / (n.n0 + self.scans_seen)
            for g in self.grids
        )
        return max(fine, n.wl * coarse)

    def density_at(self, z):
        """Clutter at a place without a plot."""
        n = self.n
        fine, coarse = (
            (n.lam0 * n.n0 + max(g.read(z), 0.0) / g.cell**2) / (n.n0 + self.scans_seen)
            for g in self.grids
        )
        return max(fine, n.wl * coarse)

    def survived(self, track, time):
        """Prediction of step 8, over the time since the track was last looked for."""
        since, track.looked = time - track.looked, time
        chance = sigmoid(track.existence) * self.n.ps ** (since / self.n.period)
        return math.log(chance / (1 - chance))

    def gated(self, track, plot):
        """Step 5: log density of the plot at the predicted track, None outside the gate."""
        n = self.n
        if not plot.t > track.last.t:
            return None
        p, var = track.at(plot.t, n)
        nu, s = plot.z - p, var[0] * np.eye(2) + plot.r
        if not nu @ np.linalg.solve(s, nu) < n.gate:
            return None
        farthest = n.vmax * (plot.t - track.last.t) + 3 * math.sqrt(plot.rbar)
        if track.hits == 1 and not math.hypot(*nu) < farthest:
            return None
        return log_normal(nu, s)

    def assigned(self, gated, plots):
        """Step 6: plot of each track that has one."""
        n = self.n
        cost = np.zeros((len(gated), len(plots)))
        for i, near in enumerate(gated):
            for j, at in near.items():
                gain = math.log(n.pd / (1 - n.pd)) + at - math.log(plots[j].lam)
                gain += n.bonus * self.tracks[i].confirmed
                # Never more than -0.001 in the text; this way two of these differ.
                cost[i, j] = -gain if gain > 0.001 else -0.001 * math.exp(gain - 0.001)
        return {
            int(i): int(j)
            for i, j in zip(*linear_sum_assignment(cost), strict=True)
            if cost[i, j] < 0
        }

    def merged(self, plots, prior, ratio, hit, posterior):
        """Change (g): tracks without a plot whose echo is in another's; revises `posterior`."""
        n, held = self.n, set()
        user = {j: i for i, j in hit.items()}
        for i, track in enumerate(self.tracks):
            if i in hit or track.hits < n.mh or track.shared >= n.ks:
                continue
            pairs = [
                (self.chance_merged(track, self.tracks[user[j]], plots[j]), -j)
                for j in ratio[i]
                if j in user and self.tracks[user[j]].hits >= n.mh
            ]
            pm, j = max(pairs, default=(0.0, 0))
            j = -j
            if pm <= 0.05:
                continue
            w = user[j]
            l10, l01 = 1 - n.pd + ratio[i][j], 1 - n.pd + ratio[w][j]
            both = 1 - (1 - n.pd) ** 2
            gm = both * math.exp(self.log_merged(track, self.tracks[w], plots[j])) / plots[j].lam
            apart = (1 - n.pd) ** 2 + (1 - n.pd) * (ratio[i][j] + ratio[w][j])
            l11 = pm * (1 - both + gm) + (1 - pm) * apart
            ri, rw = sigmoid(prior[i]), sigmoid(prior[w])
            posterior[i] = prior[i] + math.log(((1 - rw) * l10 + rw * l11) / ((1 - rw) + rw * l01))
            posterior[w] = prior[w] + math.log(((1 - ri) * l01 + ri * l11) / ((1 - ri) + ri * l10))
            held.add(i)
        return held

    def chance_merged(self, one, other, plot):
        """pm: probability that two echoes at these predictions are one plot."""
        n = self.n
        s = one.at(plot.t, n)[0] - other.at(plot.t, n)[0]
        if np.isnan(plot.own).any():
            return math.exp(-0.5 * (s @ s) / n.mdr**2)
        r, u, w = plot.sight()
        return math.exp(-0.5 * ((s @ u / n.mdr) ** 2 + (s @ w / (n.mdc + n.mda * r)) ** 2))

    def log_merged(self, one, other, plot):
        n = self.n
        (p, var), (q, war) = one.at(plot.t, n), other.at(plot.t, n)
        s = p - q
        spread = (var[0] + war[0]) / 4 * np.eye(2) + plot.r + np.outer(s, s) / 12
        return log_normal(plot.z - (p + q) / 2, spread)

    def take(self, track, plot, at):
        """A hit: bank (10), filter (7), smoothed density and strength (8), counts."""
        n = self.n
        self.weigh_hypotheses(track, plot, at)
        p, (p11, p12, p22) = track.at(plot.t, n)
        nu, r = plot.z - p, plot.rbar
        alpha, g = p11 / (p11 + r), p12 / (p11 + r)
        track.p, track.v = p + alpha * nu, track.v + g * nu
        track.var = (
            (1 - alpha) ** 2 * p11 + alpha**2 * r,
            (1 - alpha) * (p12 - g * p11) + alpha * g * r,
            p22 - 2 * g * p12 + g**2 * p11 + g**2 * r,
        )
        track.last = plot
        track.ll = 0.7 * track.ll + 0.3 * math.log(plot.lam)
        strength = math.log(n.pd) + at - math.log(plot.lam)
        if track.hits == 1:
            track.strength = strength
        else:
            track.strength = (1 - n.le) * track.strength + n.le * strength
        track.hits += 1
        track.misses = track.shared = 0
        track.ratio += n.lhr * (1 - track.ratio)

    def weigh_hypotheses(self, track, plot, at):
        """Log ratios of moving to steady, loose, wandering and arc: step 10 and change (c)."""
        n, z, before = self.n, plot.z, track.last
        many = min(track.hits, 20)
        scans = (plot.t - before.t) / n.period
        log_each = [
            log_round(z - track.mean, n.sst**2 * (1 + 1 / many)),
            log_round(z - track.mean, n.slo**2 * (1 + 1 / many)),
            log_round(z - before.z, n.srw**2 * scans + 2 * n.sr**2),
            -math.inf,
        ]
        if not np.isnan([plot.own, before.own]).any():
            (a, b), (c, d) = before.z - before.own, plot.z - plot.own
            r0, r1 = math.hypot(a, b), math.hypot(c, d)
            turn = math.sin(math.atan2(d, c) - math.atan2(b, a))
            spread = [n.sar**2 * (1 + 0.3 * scans), n.sac**2 * scans + 2 * n.sr**2]
            log_each[3] = log_normal(np.array([r1 - r0, turn * (r0 + r1) / 2]), np.diag(spread))
        track.evidence = n.ff2 * track.evidence + at - np.array(log_each)
        track.mean = track.mean + max(1 / (many + 1), 0.05) * (z - track.mean)

    def decide_kind(self, track, *, hit):
        """Steps 10 and change (d)."""
        n, e = self.n, track.evidence
        if track.hits < 2:
            return
        if hit:
            track.against = math.log(np.exp(-e).sum()) + n.kap * (track.ll - math.log(1e-5))
        against = track.against + n.kr * (1 - track.ratio)
        if track.kind == MOVING and against > n.chilo:
            track.kind = UNDECIDED
        if not hit or track.kind == MOVING:
            return
        if against < -n.tm:
            track.kind = MOVING
        elif min(e[1], e[2]) - e[0] > n.tst and track.existence > n.lcs and track.hits >= n.hstat:
            track.kind = STATIC

    def confirms(self, track):
        """Step 11 with change (e)."""
        n = self.n
        motion = n.wb * min(max(-track.against, 0.0), 10.0)
        return (
            track.hits >= n.minhit
            and track.kind != UNDECIDED
            and track.existence > n.lc
            and track.strength + motion > n.lc2
        )

    def judge_plots(self, track, plot, before, dead):
        """Change (a): what the map holds of a track's plots, by what became of it."""
        n = self.n
        likely_clutter = 1 - sigmoid(track.existence - n.wsh)
        if before:
            if plot:
                self.deposit(plot.z, likely_clutter - n.wc)
            return
        if plot:
            self.deposit(plot.z, track.weight - n.wc)
            track.held_plots = [*track.held_plots, (self.k, plot.z)][-8:]
        if dead:
            weight = 1.0
        elif track.confirmed and track.kind == MOVING:
            weight = 0.0
        else:
            weight = n.w0 * likely_clutter
        if abs(weight - track.weight) > 0.1:
            for k, z in track.held_plots:
                self.deposit(z, (weight - track.weight) * math.exp(-(self.k - k) / n.tau))
            track.weight = weight

    def born(self, plot):
        """Step 14."""
        n = self.n
        self.deposit(plot.z, n.w0 - n.wc)
        track = Track(
            id=self.next_id,
            p=plot.z.copy(),
            v=np.zeros(2),
            var=(plot.rbar, 0.0, n.sv0**2),
            last=plot,
            existence=math.log(n.lb / plot.lam),
            mean=plot.z.copy(),
            ll=math.log(plot.lam),
            weight=n.w0,
            held_plots=[(self.k, plot.z)],
            looked=plot.t,
            plot=plot.row,
        )
        self.next_id += 1
        return track

    def kind_reported(self, track):
        """Moving, unless it has long been where the mean of its plots is."""
        still = track.hits >= self.n.hstat and math.dist(track.p, track.mean) < self.n.rest
        return STATIC if still and track.kind == MOVING else track.kind

    def reported(self, track):
        """Step 15."""
        n = self.n
        return (
            track.confirmed
            and track.kind != UNDECIDED
            and track.misses <= n.kc
            and track.existence > n.lrep
        )
