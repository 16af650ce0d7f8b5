"""An association in plain Python: tracks choose their plots one after the other."""

from dataclasses import dataclass

from fuzzytrack.scan.association import Association, AssociationKernels
from fuzzytrack.scan.part import parameter


@dataclass(frozen=True, repr=False)
class FirstCome(Association):
    """Tracks choose one after the other; each takes the likeliest plot that is left."""

    # Dictionaries and sorting are nothing that is compiled: this part runs in Python.
    plain = True

    bonus: float = parameter(0.0, "added to the gain of every pair", "nats", least=0)

    def kernels(self, setting):
        bonus = self.bonus

        def cost(tracks, i, plots, j, distance, log_likelihood):
            return min(-log_likelihood - bonus - 50.0, -0.001)

        def assign(rows, count, first, plot, cost, plot_of, track_of, integers, numbers):
            for i in range(rows):
                mine = range(first[i], first[i + 1])
                left = {e: cost[e] for e in mine if track_of[plot[e]] < 0}
                if left:
                    best = plot[min(left, key=left.get)]
                    plot_of[i], track_of[best] = best, i

        return AssociationKernels(cost, assign)
