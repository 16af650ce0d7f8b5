"""What all tests share."""

import os
import sys
import threading

import pytest
from hypothesis import HealthCheck, settings

# No test depends on time: a slow machine is no defect. `make test` tries the same examples in every
# run, `make lowest` fewer; `make fuzz` draws new ones, and more of them.
_UNTIMED = settings(deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.register_profile("repeatable", _UNTIMED, derandomize=True, max_examples=50)
settings.register_profile("few", _UNTIMED, derandomize=True, max_examples=10)
settings.register_profile("free", _UNTIMED, derandomize=False, max_examples=1000)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "repeatable"))


def _draw_without_modules():
    """Draw no numbers and texts that stand in the modules of the project that are loaded.

    Which ones are loaded depends on the tests before, and so would the examples. Versions of
    Hypothesis before 6.131 draw none.
    """
    try:
        from hypothesis.internal.conjecture import providers
    except ImportError:
        return
    providers._get_local_constants = providers.Constants


if settings().derandomize:
    _draw_without_modules()


@pytest.fixture(scope="session", autouse=True)
def compiled_code_is_kept(tmp_path_factory):
    """Keep compiled code for other processes, also for a user without a home folder."""
    from fuzzytrack.kernels.cache import VARIABLE, KernelFolder

    with pytest.MonkeyPatch.context() as patch:
        if VARIABLE not in os.environ and KernelFolder.of_user().problem() is not None:
            patch.setenv(VARIABLE, str(tmp_path_factory.mktemp("kernels")))
        yield


@pytest.fixture(autouse=True)
def no_figures_are_left():
    """Which tests run before one in the same process depends on the number of processes."""
    yield
    plt = sys.modules.get("matplotlib.pyplot")
    if plt is not None:
        plt.close("all")


class _Pause:
    """Stops the measurement of coverage while it is entered; may be nested."""

    def __init__(self):
        self.depth = 0
        self.stopped = []

    def start(self):
        self.depth += 1
        if self.depth > 1:
            return
        # In processes that tests are distributed to, several measure at once: when one of them
        # stops, the one before it goes on.
        while (running := _running_coverage()) is not None:
            running.stop()
            self.stopped.append(running)

    def end(self):
        self.depth -= 1
        while self.depth == 0 and self.stopped:
            self.stopped.pop().start()


def _running_coverage():
    try:
        from coverage import Coverage
    except ImportError:
        return None
    return Coverage.current()


_pause = _Pause()


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item, nextitem):
    """Leave tests that are marked `untraced` out of coverage, their set-up included.

    Traced, plain Python kernels take five times as long. What such a test covers, another test
    covers with less work.
    """
    if item.get_closest_marker("untraced") is None:
        return (yield)
    _pause.start()
    try:
        # Other processes that the test starts are traced if this variable says so.
        with pytest.MonkeyPatch.context() as patch:
            patch.delenv("COVERAGE_PROCESS_CONFIG", raising=False)
            return (yield)
    finally:
        _pause.end()


def pytest_sessionstart(session):
    """Pause coverage also where tracing doubles the time: Numba compiles, pytest rewrites tests."""
    if _running_coverage() is None:
        return
    _leave_rewriting_out()
    from numba.core import event

    class Compilation(event.Listener):
        def on_start(self, _):
            if threading.current_thread() is threading.main_thread():
                _pause.start()

        def on_end(self, _):
            if threading.current_thread() is threading.main_thread():
                _pause.end()

    event.register("numba:compiler_lock", Compilation())


def _leave_rewriting_out():
    """Pause coverage while assertions of a test module are rewritten, which runs nothing of it."""
    from _pytest.assertion import rewrite

    rewrite_test = rewrite._rewrite_test

    def untraced(*arguments):
        _pause.start()
        try:
            return rewrite_test(*arguments)
        finally:
            _pause.end()

    rewrite._rewrite_test = untraced
