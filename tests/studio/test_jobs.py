"""Jobs without processes: their states, and what they tell."""

import threading
import warnings

import pytest
from waiting import PATIENCE, wait_until

from fuzzytrack.errors import TrackWarning
from fuzzytrack.studio import jobs
from fuzzytrack.studio.jobs import CancelledJobError, Job, Jobs
from fuzzytrack.studio.notes import warnings_to_notes


class Reports:
    """An owner of jobs that keeps their reports; `end` waits for the end of one."""

    gone = False

    def __init__(self):
        self.told = []
        self.ended = threading.Event()

    def report(self, job, with_results):
        self.told.append(job.as_json(with_results))
        if job.ended:
            self.ended.set()

    def end(self):
        assert self.ended.wait(PATIENCE)
        return self.told[-1]


@pytest.fixture
def found():
    made = Jobs()
    yield made
    made.close()


def test_a_job_tells_how_far_it_is_and_what_it_found(found, monkeypatch):
    monkeypatch.setattr(jobs, "_PAUSE", 0.0)
    reports = Reports()

    def work(job, pool):
        job.progress(0.25)
        job.show({"x": 1})
        job.progress(0.5)
        return {"x": 2}

    found.start("run", 8, work, reports)
    assert reports.end()["results"] == {"x": 2}
    # That it runs is told before there is progress.
    assert [each["done"] for each in reports.told] == [0, 2, 2, 4, 8]
    assert [each["results"] for each in reports.told] == [None, None, {"x": 1}, None, {"x": 2}]
    assert reports.told[0]["seconds_left"] is None
    assert reports.told[1]["seconds_left"] >= 0
    last = reports.told[-1]
    assert (last["state"], last["seconds_left"], last["error"]) == ("done", None, None)


def test_a_job_that_is_canceled_stays_so(found):
    reports, go = Reports(), threading.Event()

    def work(job, pool):
        go.wait(PATIENCE)
        job.progress(0.9)
        return {}

    job = found.start("run", 1, work, reports)
    with pytest.raises(ValueError, match=r"a job \(run\) is running"):
        found.start("run", 1, work, reports)
    found.cancel(job)
    assert job.state == "cancelled"
    go.set()
    assert reports.end()["state"] == "cancelled"
    assert found.start("run", 1, lambda job, pool: {}, Reports()).number == job.number + 1


def test_a_job_goes_on_until_it_is_ended_by_its_page_or_for_that_of_another_one_when_it_is_gone(
    found,
):
    one, other, go = Reports(), Reports(), threading.Event()
    found.start("tune", 1, lambda job, pool: {"heard": go.wait(PATIENCE)}, one)
    found.start("run", 1, lambda job, pool: {"x": 1}, other)
    one.gone = True
    assert one.end()["state"] == "cancelled"
    assert other.end()["results"] == {"x": 1}
    go.set()


def test_jobs_that_are_started_meanwhile_wait_and_run_in_their_order(found):
    one, other, go = Reports(), Reports(), threading.Event()
    begun = []

    def work(job, pool):
        begun.append(job.number)
        go.wait(PATIENCE)
        return {"pool": id(pool)}

    first = found.start("run", 1, work, one)
    canceled = found.start("track", 1, work, one)
    replaced = found.start("tune", 1, work, other)
    last = found.start("run", 1, work, other)
    found.cancel(canceled)
    found.replace(replaced)
    assert [job.ended for job in (first, canceled, replaced, last)] == [False, True, True, False]
    go.set()
    # One that is ended before its turn takes no processes away from the one that runs.
    wait_until(lambda: "done" in [each["state"] for each in other.told])
    assert begun == [first.number, last.number]
    assert first.results == last.results != {}
    states = [each["state"] for each in other.told if each["id"] == last.number]
    assert states == ["waiting", "running", "done"]


def test_a_job_that_waits_for_one_without_progress_begins_after_a_while(found, monkeypatch):
    monkeypatch.setattr(jobs, "_LOOK", 0.01)
    stuck, waiting, go = Reports(), Reports(), threading.Event()
    found.start("run", 1, lambda job, pool: {"heard": go.wait(PATIENCE)}, stuck)
    found.start("run", 1, lambda job, pool: {"x": 1}, waiting)
    monkeypatch.setattr(jobs, "SILENCE", 0.0)
    assert "no progress for 0 s" in stuck.end()["error"]
    assert waiting.end()["results"] == {"x": 1}
    go.set()


def test_the_end_of_all_ends_those_that_wait(found):
    one, other, go = Reports(), Reports(), threading.Event()
    found.start("run", 1, lambda job, pool: {"heard": go.wait(PATIENCE)}, one)
    found.start("run", 1, lambda job, pool: {}, other)
    found.close()
    assert [one.end()["state"], other.end()["state"]] == ["cancelled", "cancelled"]
    go.set()


@pytest.mark.parametrize(
    ("failure", "told"),
    [
        (ValueError("runs: too many"), "runs: too many"),
        (KeyError("k"), "KeyError: 'k'"),
    ],
)
def test_a_job_that_fails_says_why(found, failure, told):
    reports = Reports()

    def work(job, pool):
        raise failure

    found.start("run", 1, work, reports)
    assert reports.end()["error"] == told


def test_warnings_in_a_job_become_its_notes(found):
    reports = Reports()

    def work(job, pool):
        for _ in range(2):
            warnings.warn("the gains do not suit", TrackWarning, stacklevel=1)
        return {"notes": job.notes}

    with warnings_to_notes():
        found.start("run", 1, work, reports)
        assert reports.end()["results"] == {"notes": ["the gains do not suit"]}


def test_nothing_is_told_of_a_job_after_its_end():
    reports = Reports()
    job = Job(1, "run", 1, reports)
    assert job.end("cancelled")
    # Its thread may begin, or go on, only now.
    job.begin()
    job.show({})
    with pytest.raises(CancelledJobError):
        job.progress(0.5)
    job.finish({})
    assert [each["state"] for each in reports.told] == ["cancelled"]


def test_a_job_has_no_processes_of_one_that_is_being_canceled(found):
    pools, go = [], threading.Event()
    last = Reports()

    def work(job, pool):
        pools.append(pool)
        go.wait(PATIENCE)
        return {}

    class Eager(Reports):
        def report(self, job, with_results):
            if job.ended:
                other.start()
                # If it does not wait for the end of the cancellation, it begins within this time.
                other.join(0.1)

    first = Eager()
    other = threading.Thread(target=lambda: found.start("run", 1, work, last))
    found.cancel(found.start("run", 1, work, first))
    go.set()
    other.join(PATIENCE)
    assert last.end()["state"] == "done"
    assert len(set(pools)) == 2
