"""The maneuver rule bases once more: full matrices, states, and rules as interpolation."""

import numpy as np

#: Of each rule base: numbers, corners of its inputs, and what the rules say at the corners.
MANEUVER = {
    "times": (6.5, 16.0),
    "gap": 0.6,
    "corners": ((0.8, 4.0), (1.5, 6.0)),
    "noise": ((0.09, 2.2), (1.4, 2.7)),
    "retention": (0.3, 7.0),
}
TWO_RULES = {
    "times": (6.0, 1.0),
    "gap": 0.5,
    "corners": ((1.0, 4.0), (0.0, 1.0)),
    "noise": ((0.12, 0.12), (2.0, 2.0)),
    "retention": (1.0, 4.0),
}
CLIP, DELAY, START = 4.0, 1.0, 0.65


def kept(x):
    return 1 / (1 + x + x * x / 2)


def say(rules, surprise, agreement):
    """Noise and retention."""
    u, c = (
        np.clip((value - low) / (high - low), 0, 1)
        for value, (low, high) in zip((surprise, agreement), rules["corners"], strict=True)
    )
    noise = np.array([1 - u, u]) @ np.array(rules["noise"]) @ np.array([1 - c, c])
    return noise, np.interp(u, [0, 1], rules["retention"])


def track(rules, t, z, sigma, level=None, two_point=True, velocity_sigma=None, own=False):
    """Numbers of each plot after those that start the track: one dict a plot."""
    n = z.shape[1]
    r = sigma**2 if own else np.repeat((sigma**2).mean(axis=1, keepdims=True), n, axis=1)
    typical = sigma[0].mean()
    quiet_noise, quiet_retention = say(rules, 0, 0)

    def units(k):
        if level is not None:
            return np.sqrt(typical / (level / 3)), level / 3
        time = (t[k] - t[0]) / max(k, 1)
        return time, typical / time**2

    s, before, c = np.zeros(n), np.zeros(n), 0.0
    x = np.zeros((3, n))
    x[0] = z[0]
    found, first = [], 1
    if velocity_sigma is not None:
        time, acceleration = units(0)
        last = START * acceleration
        p = [np.diag([r[0, j], velocity_sigma**2, last**2]) for j in range(n)]
        tau = quiet_retention * time
    else:
        first = 2
        dt = t[1] - t[0]
        time, acceleration = units(1)
        last = START * acceleration
        if not two_point:
            found.append({"alpha": np.ones(n), "beta": np.ones(n), "gamma": np.zeros(n)})
        x[0], x[1] = z[1], (z[1] - z[0]) / dt
        q = last**2
        p = []
        for j in range(n):
            rate = (r[0, j] + r[1, j]) / dt**2 + q * dt**2 / 4
            row = r[1, j] / dt
            p.append(np.array([[r[1, j], row, 0], [row, rate, q * dt / 2], [0, q * dt / 2, q]]))
        tau = quiet_retention * time

    for k in range(first, len(t)):
        dt = t[k] - t[k - 1]
        time, acceleration = units(k)
        phi = kept(dt / tau)
        f = np.array([[1, dt, phi * dt**2 / 2], [0, 1, phi * dt], [0, 0, phi]])
        x = f @ x
        p = [f @ each @ f.T for each in p]
        d = dt + DELAY * time
        g = np.array([d * d / 2, d, 1])
        b = (1 - phi**2) / (1 + dt / time / rules["gap"])
        gate = np.array([p[j][0, 0] + b * last**2 * g[0] ** 2 + r[k, j] for j in range(n)])
        quiet = b * (quiet_noise * acceleration * g[0]) ** 2
        nu = (z[k] - x[0]) / np.sqrt([p[j][0, 0] + quiet + r[k, j] for j in range(n)])
        nu *= min(1, CLIP / np.linalg.norm(nu))
        forget, forget_product = (kept(dt / time / each) for each in rules["times"])
        s = forget * s + np.sqrt(1 - forget**2) * nu
        c = forget_product * c + np.sqrt(1 - forget_product**2) * (nu @ before)
        before = nu
        noise, retention = say(rules, np.linalg.norm(s), c)
        last, tau = noise * acceleration, retention * time
        predicted, gains = x[0].copy(), np.zeros((3, n))
        for j in range(n):
            p[j] = p[j] + b * last**2 * np.outer(g, g)
            gain = p[j][:, 0] / (p[j][0, 0] + r[k, j])
            p[j] = p[j] - np.outer(gain, gain) * (p[j][0, 0] + r[k, j])
            x[:, j] += gain * (z[k, j] - x[0, j])
            gains[:, j] = gain * [1, dt, 2 * dt**2]
        found.append({
            "alpha": gains[0], "beta": gains[1], "gamma": gains[2], "tau": tau, "gate": gate,
            "predicted": predicted, "filtered": x[0].copy(),
        })  # fmt: skip
    return found
