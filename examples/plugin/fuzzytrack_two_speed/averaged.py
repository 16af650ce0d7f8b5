"""A tracker that averages two fixed filters; docs/write-a-tracker.md explains it."""

from dataclasses import dataclass

from fuzzytrack.trackers import LaneProgram, LaneTracker, Rows, single_axis_step


@dataclass(frozen=True)
class Averaged(LaneTracker):
    source = "example"

    quiet: float = 0.3  # position gain of one filter
    agile: float = 0.8  # position gain of the other one

    def program(self, n_axes):
        rows = Rows(n_axes, 4)  # memory: position and velocity of both filters
        gains = tuple((alpha, alpha**2 / (2.0 - alpha)) for alpha in (self.quiet, self.agile))

        def step(stride):
            return single_axis_step(rows, stride, averaging(gains, rows.memory * stride, stride))

        return LaneProgram(rows, (0.0,) * 4, step)


def averaging(gains, memory, stride):
    (alpha_1, beta_1), (alpha_2, beta_2) = gains
    alpha, beta = (alpha_1 + alpha_2) / 2.0, (beta_1 + beta_2) / 2.0

    def advance(buffer, x, v, z, velocity, dt, alpha, beta, update, starts):
        prediction = buffer[x] + buffer[v] * dt
        e = z - prediction if update else 0.0
        buffer[x] = z if starts else prediction + alpha * e
        buffer[v] = velocity if starts else buffer[v] + beta / dt * e
        return buffer[x], buffer[v]

    def correct(buffer, lane, z, prediction, velocity, dt, gap, sigma, update, starts):
        x, v = memory + lane, memory + stride + lane
        x_1, v_1 = advance(buffer, x, v, z, velocity, dt, alpha_1, beta_1, update, starts)
        x, v = x + 2 * stride, v + 2 * stride
        x_2, v_2 = advance(buffer, x, v, z, velocity, dt, alpha_2, beta_2, update, starts)
        return prediction, (x_1 + x_2) / 2.0, (v_1 + v_2) / 2.0, alpha, beta

    return correct
