"""How tests wait for what other processes and threads do: for the thing itself, not for a time."""

import time

import pytest

# Seconds after which something hangs. A slow or loaded machine stays far below.
PATIENCE = 120.0


def wait_until(met, process=None):
    """Wait until a condition is met; fails if that takes too long, or a process ends before."""
    limit = time.monotonic() + PATIENCE
    while not met():
        if process is not None and process.poll() is not None and not met():
            pytest.fail(f"the process has ended, with status {process.returncode}")
        if time.monotonic() > limit:
            pytest.fail(f"waited for {PATIENCE:.0f} s")
        time.sleep(0.02)
