"""Tasks in this process and on executors that finish, fail and break in every order."""

import warnings
from concurrent.futures import BrokenExecutor, Executor, Future

import pytest

from fuzzytrack import tasks
from fuzzytrack.tasks import part, run_tasks


def square(number):
    return number * number


class Scripted(Executor):
    """Fails each task with the errors given for it, then does it; counts what it is given.

    Tasks are done only when they are waited for, and those that were given last come first.
    """

    def __init__(self, monkeypatch, **errors):
        self.errors = {int(name.strip("_")): list(given) for name, given in errors.items()}
        self.given, self.waiting, self.most, self.canceled = [], [], 0, []
        wait = tasks.wait

        def working_wait(futures, **how):
            self.finish_last()
            return wait(futures, **how)

        monkeypatch.setattr(tasks, "wait", working_wait)

    def submit(self, function, /, *given):
        task = given[-1]
        self.given.append(task)
        future = Future()
        future.add_done_callback(lambda f: f.cancelled() and self.canceled.append(task))
        self.waiting.append((future, lambda task: function(*given), task))
        self.most = max(self.most, len(self.waiting))
        return future

    def finish_last(self):
        future, function, task = self.waiting.pop()
        if self.errors.get(task):
            future.set_exception(self.errors[task].pop(0))
        else:
            future.set_result(function(task))


def test_here_tasks_are_done_in_their_order():
    done = []
    outcomes = run_tasks(lambda task: done.append(task) or task + 1, (3, 1, 2))
    assert done == []
    assert next(outcomes) == (3, 4)
    assert done == [3]
    assert list(outcomes) == [(1, 2), (2, 3)]


def test_no_tasks(monkeypatch):
    assert list(run_tasks(square, [])) == []
    assert list(run_tasks(square, [], Scripted(monkeypatch))) == []


def test_outcomes_come_as_tasks_finish(monkeypatch):
    executor = Scripted(monkeypatch)
    assert list(run_tasks(square, [1, 2, 3], executor)) == [(3, 9), (2, 4), (1, 1)]


def test_an_executor_has_only_so_many_tasks_at_a_time(monkeypatch):
    monkeypatch.setattr(tasks, "_AHEAD", 4)
    executor = Scripted(monkeypatch)
    found = dict(run_tasks(square, range(11), executor))
    assert found == {n: n * n for n in range(11)}
    assert executor.most == 4


def test_a_lost_task_is_done_again(monkeypatch):
    lost = [AttributeError("lost"), OSError("lost")]
    executor = Scripted(monkeypatch, _2=lost)
    assert dict(run_tasks(square, [1, 2, 3], executor)) == {1: 1, 2: 4, 3: 9}
    assert sorted(executor.given) == [1, 2, 2, 2, 3]


@pytest.mark.parametrize(
    ("errors", "tries"),
    [
        ([AttributeError("lost")] * 3, 3),
        # The executor's own, as Dask's has one if a worker dies.
        ([ValueError("unpacked")] * 3, 3),
        ([AttributeError("lost"), BrokenExecutor("broken")], 2),
    ],
)
def test_a_task_that_fails_for_good_ends_the_job(monkeypatch, errors, tries):
    executor = Scripted(monkeypatch, _5=list(errors))
    with pytest.raises(type(errors[-1]), match=str(errors[-1])):
        list(run_tasks(square, [4, 5], executor))
    assert executor.given.count(5) == tries
    assert executor.canceled == [4]


def test_a_task_with_wrong_input_is_not_tried_again(monkeypatch):
    def refuse(task):
        raise ValueError(f"no {task}")

    executor = Scripted(monkeypatch)
    with pytest.raises(ValueError, match="no 5"):
        list(run_tasks(refuse, [4, 5], executor))
    assert executor.given == [4, 5]
    assert executor.canceled == [4]


def test_what_has_not_begun_is_canceled_when_nobody_wants_it(monkeypatch):
    executor = Scripted(monkeypatch)
    outcomes = run_tasks(square, [1, 2, 3], executor)
    assert next(outcomes) == (3, 9)
    outcomes.close()
    assert sorted(executor.canceled) == [1, 2]


def test_warnings_of_other_processes_are_issued_in_this_one(monkeypatch):
    def warn(task):
        warnings.warn(f"{task % 2}", UserWarning, stacklevel=1)
        return task

    monkeypatch.setattr(tasks, "parent_process", lambda: "another process")
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("default")
        outcomes = dict(run_tasks(warn, range(4), Scripted(monkeypatch)))
    assert outcomes == {task: task for task in range(4)}
    assert {str(w.message) for w in caught} == {"0", "1"}


def test_a_part_of_the_work_reports_its_share():
    seen = []
    part(seen.append, 0.5, 0.75)(0.5)
    assert seen == [0.625]
