"""The state of a live run of scans in a file, with which it goes on as if it had never stopped."""

from __future__ import annotations

from collections import Counter
from typing import Any

from fuzzytrack.errors import DataError
from fuzzytrack.io.files import PathLike
from fuzzytrack.recordings.plain_values import PlainValues
from fuzzytrack.recordings.radar_place import RadarPlace
from fuzzytrack.recordings.run_state import RunState
from fuzzytrack.recordings.scan_cut import Cutter
from fuzzytrack.recordings.scan_feed import ScanFeed
from fuzzytrack.recordings.scan_gathering import ScanGathering
from fuzzytrack.recordings.scan_order import CountedOn, RowOrder
from fuzzytrack.recordings.scan_rows import ScanRows
from fuzzytrack.recordings.scan_run import SectorRun
from fuzzytrack.recordings.scan_sectors import Beam, SectorPass
from fuzzytrack.scan.scan_session import ScanSession
from fuzzytrack.scan.update.tracked_states import TrackedStates
from fuzzytrack.trackers.track_store import TrackStore

__all__ = ["ScanState"]

# What a stream of scans is made of.
_CLASSES = (
    CountedOn, RowOrder, ScanGathering, Cutter, RadarPlace, SectorRun, SectorPass, Beam, ScanRows,
    ScanSession, TrackedStates, TrackStore,
)  # fmt: skip


class ScanState(RunState):
    """State of a live run of scans, see `RunState`: tracks, and plots whose scan has not ended."""

    format = "fuzzytrack scan state"
    version = 2
    run = "scan"

    @classmethod
    def of(cls, feed: ScanFeed, written: int) -> ScanState:
        """State of a feed that has begun; the feed can go on meanwhile.

        Parameters
        ----------
        feed : ScanFeed
        written : int
            Bytes of the output so far.
        """
        stream, arrays = feed.stream, dict[str, Any]()
        assert stream is not None
        values = PlainValues(_CLASSES, _parts(feed, stream.session), arrays)
        findings = stream.plots.findings
        facts = {
            "options": feed.options,
            "configuration": feed.scanner.name,
            "digest": feed.digest,
            "head": values.written(feed.head),
            "beginning": feed.beginning,
            "lines": feed.items,
            "checksum": feed.checksum,
            "written": written,
            "stream": values.written(vars(stream)),
            "found": findings.counts,
            "impossible": dict(findings.impossible),
            "faults": dict(feed.faults.counts),
            "totals": values.written(vars(feed.totals)),
        }
        return cls(facts, arrays)

    def resume(self, feed: ScanFeed, path: PathLike) -> None:
        """Make a feed that has not begun go on from this state.

        Parameters
        ----------
        feed : ScanFeed
        path : str or path
            File of the state, for messages.

        Raises
        ------
        DataError
            If the state is that of another configuration or of other options, or is damaged.
        """
        self.check_options(feed.options, path)
        if feed.digest != self.facts["digest"]:
            raise DataError(
                f"{path}: was made with the configuration {self.facts['configuration']}, which is "
                f"not this {feed.scanner.name}; give the same, or remove it to begin anew"
            )
        try:
            facts = self.facts
            feed.start(PlainValues((), {}, self.arrays).read(facts["head"]))
            stream = feed.stream
            assert stream is not None
            findings = stream.plots.findings
            values = PlainValues(_CLASSES, _parts(feed, feed.scanner.start()), self.arrays)
            vars(stream).update(values.read(facts["stream"]))
            vars(feed.totals).update(values.read(facts["totals"]))
            vars(findings).update({name: int(facts["found"][name]) for name in findings.counts})
            findings.impossible = Counter(facts["impossible"])
            feed.faults.counts.update(facts["faults"])
            feed.items, feed.checksum, feed.beginning = self.lines, self.checksum, self.beginning
        except (ValueError, KeyError, TypeError, IndexError, AttributeError, StopIteration):
            raise DataError(f"{path}: is damaged; remove it to begin anew") from None


def _parts(feed: ScanFeed, session: ScanSession | None) -> dict[str, object]:
    """What each run makes anew, by its configuration and the first items."""
    assert feed.stream is not None
    plots = feed.stream.plots
    parts: dict[str, object] = {
        "plots": plots,
        "cut": plots.cut,
        "decoder": plots.files.decoder,
        "findings": plots.findings,
        "rules": feed.stream.rules,
        "scanner": feed.scanner,
    }
    if session is not None and isinstance(session.companion, TrackedStates):
        parts["tracker"] = session.companion.tracker
    return parts
