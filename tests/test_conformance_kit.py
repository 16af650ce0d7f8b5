"""The conformance kit must fail what breaks the contract."""

import math
import random
import re
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

import fuzzytrack as ft
from fuzzytrack.errors import PluginError
from fuzzytrack.normalizations import normalizations
from fuzzytrack.schedulers import GainScheduler, KalmanCV, schedulers
from fuzzytrack.testing import check_scheduler, check_tracker, checks_for, parametrize_with_checks
from fuzzytrack.trackers import LaneProgram, LaneTracker, Rows, single_axis_step, trackers


def scheduler_of(kernel, memory=(), **attributes):
    class Made(GainScheduler):
        def initial_memory(self, n_axes):
            return memory

        def kernel(self, n_axes):
            return kernel

        def __eq__(self, other):
            return type(other) is type(self)

        def __hash__(self):
            return 0

    for name, value in attributes.items():
        setattr(Made, name, value)
    return Made()


def run_check(name, subject):
    """Run the one check of that name."""
    (check,) = (check for check in checks_for(subject) if check.name == name)
    check()


def fixed(innovation, change, dt, sigma, memory):
    return 0.5, 0.2, 0.0, 1.0, memory


def divides(innovation, change, dt, sigma, memory):
    return 0.5, 0.2 / innovation, 0.0, 1.0, memory


def forgets_one(innovation, change, dt, sigma, memory):
    return 0.5, 0.2, 0.0, 1.0, ()


def four_answers(innovation, change, dt, sigma, memory):
    return 0.5, 0.2, 0.0, 1.0


def bare_memory(innovation, change, dt, sigma, memory):
    return 0.5, 0.2, 0.0, 1.0, memory[0] + 1.0


def no_answer(innovation, change, dt, sigma, memory):
    pass


def grows_to_infinity(innovation, change, dt, sigma, memory):
    return 0.5, 0.2 + 1e300 * abs(innovation) * 1e300, 0.0, 1.0, memory


def gambles(innovation, change, dt, sigma, memory):
    return random.random(), 0.2, 0.0, 1.0, memory


@dataclass
class Unhashable(GainScheduler):
    def kernel(self, n_axes):
        return fixed


@dataclass(frozen=True, eq=False)
class Unequal(GainScheduler):
    def kernel(self, n_axes):
        return fixed


@pytest.mark.parametrize(
    ("scheduler", "promise"),
    [
        (0.5, "must be a GainScheduler, got float"),
        (ft.FixedGains, r"got the class FixedGains; give an object, as FixedGains\(\) makes it"),
        (Unhashable(), "^hashable: Unhashable must be hashable: make it a frozen dataclass"),
        (Unequal(), "^equals-pickled-copy: Unequal must equal its pickled copy"),
        (scheduler_of(fixed), "Made must pickle .*: define the class at the top of a module"),
    ],
)
def test_a_scheduler_is_a_value(scheduler, promise):
    with pytest.raises(AssertionError, match=promise):
        check_scheduler(scheduler)


@pytest.mark.parametrize(
    ("kernel", "memory", "promise"),
    [
        (forgets_one, (0.0,), "must return a memory of length 1 as it gets, got length 0"),
        (bare_memory, (0.0,), "must return its memory as a tuple, got 1.0"),
        (four_answers, (), r"must return \(alpha, beta, gamma, phi, memory\), got \(0.5, 0.2, 0.0"),
        (no_answer, (), r"must return \(alpha, beta, gamma, phi, memory\), got None"),
        (lambda *words: [0.5, 0.2, 0.0, 1.0, ()], (), r"must return \(alpha, .*\), got \[0.5, 0"),
        (lambda *words: (0.5, 0.2, 0.0, 1.0, []), (), r"its memory as a tuple, got \[\]"),
        (grows_to_infinity, (), "gains and memory must be finite floats"),
        (gambles, (), "must depend on nothing else"),
        (divides, (), r"innovation 0, change 0: raises ZeroDivisionError .* guard its own divis"),
    ],
)
def test_what_a_kernel_returns(kernel, memory, promise):
    with pytest.raises(AssertionError, match=f"^kernel-answers-in-form: kernel at .*{promise}"):
        run_check("kernel-answers-in-form", scheduler_of(kernel, memory))


def test_gamma_needs_a_declaration():
    made = scheduler_of(lambda e, d, dt, s, m: (0.5, 0.2, 0.01, 1.0, m), uses_acceleration=False)
    with pytest.raises(AssertionError, match="gamma must be 0 unless uses_acceleration is set"):
        run_check("kernel-answers-in-form", made)


# -------------------------------------------------------------------- arguments and words


def of_three(innovation, dt, memory):
    return 0.5, 0.2, 0.0, 1.0, memory


class WithMethod(GainScheduler):
    alpha = 0.5

    def kernel(self, n_axes):
        return self.kernel_of_mine

    def kernel_of_mine(self, innovation, change, dt, sigma, memory):
        return self.alpha, 0.2, 0.0, 1.0, memory


def test_a_kernel_has_five_arguments():
    expected = (
        r"^kernel-takes-five-arguments: the kernel of Made must take the five arguments "
        r"\(innovation, change, dt, sigma, memory\), takes \(innovation, dt, memory\)$"
    )
    with pytest.raises(AssertionError, match=expected):
        run_check("kernel-takes-five-arguments", scheduler_of(of_three))
    with pytest.raises(AssertionError, match="must return a plain function, got method: define"):
        run_check("kernel-takes-five-arguments", WithMethod())
    with pytest.raises(AssertionError, match=r"Made\.kernel must return a function, got None$"):
        run_check("kernel-takes-five-arguments", scheduler_of(None))


@pytest.mark.parametrize("memory", [0.0, None, ("word",)])
@pytest.mark.parametrize(
    "name", ["kernel-answers-in-form", "gains-are-stable", "inputs-left-alone"]
)
def test_the_first_memory_is_a_tuple(memory, name):
    expected = f"{name}: Made.initial_memory must return a tuple of numbers, got {memory!r}"
    with pytest.raises(AssertionError, match=f"^{re.escape(expected)}$") as caught:
        run_check(name, scheduler_of(fixed, memory))
    assert isinstance(caught.value.__cause__, PluginError)

    def of_one_more(innovation, change, dt, sigma, memory, *, alpha=0.5):
        return alpha, 0.2, 0.0, 1.0, memory

    with pytest.raises(AssertionError, match=r"the five arguments .*, takes .* \*, alpha=0.5\)$"):
        run_check("kernel-takes-five-arguments", scheduler_of(of_one_more))


LIMIT = 2.0
TABLE = (0.5, (0.2, "word"), None)
NUMBERS = np.array([0.5, 0.2])


def helper(number):
    return min(abs(number), LIMIT) * math.pi


def deep_helper(number):
    return np.tanh(number)


class WithSelf(GainScheduler):
    alpha = 0.5

    def kernel(self, n_axes):
        alpha, count = self.alpha, 0

        def good(innovation, change, dt, sigma, memory):
            inner = tuple(helper(m) for m in memory)
            scaled = max([helper(m) for m in inner] or [float(NUMBERS[0])])
            return alpha, TABLE[1][0], math.sqrt(scaled) * 0.0, 1.0, memory

        def of_self(innovation, change, dt, sigma, memory):
            return self.alpha, 0.2, 0.0, 1.0, memory

        def of_numpy(innovation, change, dt, sigma, memory):
            return np.clip(innovation, 0.0, 1.0), 0.2, 0.0, 1.0, memory

        def through_a_helper(innovation, change, dt, sigma, memory):
            return deep_helper(innovation), 0.2, 0.0, 1.0, memory

        def of_a_function_of_numpy(innovation, change, dt, sigma, memory):
            return tanh(innovation), 0.2, 0.0, 1.0, memory

        def of_another_module(innovation, change, dt, sigma, memory):
            return (lambda: random.random())(), 0.2, 0.0, 1.0, memory

        def of_a_class(innovation, change, dt, sigma, memory):
            return WithSelf.alpha, 0.2, 0.0, 1.0, memory

        def of_nothing(innovation, change, dt, sigma, memory):
            return no_such_name, 0.2, 0.0, 1.0, memory  # noqa: F821

        def of_later(innovation, change, dt, sigma, memory):
            return later, 0.2, 0.0, 1.0, memory

        def importing(innovation, change, dt, sigma, memory):
            import cmath

            return cmath.phase(innovation), 0.2, 0.0, 1.0, memory

        def counting(innovation, change, dt, sigma, memory):
            nonlocal count
            count += 1
            return 0.5, 0.2, 0.0, 1.0, memory

        def changing(innovation, change, dt, sigma, memory):
            global LIMIT
            LIMIT = innovation
            return 0.5, 0.2, 0.0, 1.0, memory

        tanh = np.tanh
        if n_axes == "never":
            later = 1.0
        return locals()[n_axes] if isinstance(n_axes, str) else of_self


@pytest.mark.parametrize(
    ("name", "what"),
    [
        ("of_self", "uses 'self.alpha', where 'self' is a WithSelf"),
        ("of_numpy", "uses 'np.clip' of the module numpy"),
        ("through_a_helper", "uses 'np.tanh' of the module numpy"),
        ("of_a_function_of_numpy", "uses 'tanh' of the module numpy"),
        ("of_another_module", "uses 'random.random' of the module random"),
        ("of_a_class", "uses 'WithSelf.alpha', where 'WithSelf' is a class"),
        ("of_nothing", "uses 'no_such_name', which is not defined"),
        ("of_later", "uses 'later', which is not defined"),
        ("importing", "imports 'cmath'"),
        ("counting", "changes 'count', a variable outside of it"),
        ("changing", "changes the global variable 'LIMIT'"),
    ],
)
def test_a_kernel_uses_numbers_only(name, what):
    kernel = WithSelf().kernel(name)
    where = deep_helper if name == "through_a_helper" else kernel
    first = where.__code__.co_firstlineno
    with pytest.raises(AssertionError) as caught:
        run_check("kernel-uses-numbers-only", scheduler_of(kernel))
    text = str(caught.value)
    line = int(text.removeprefix("kernel-uses-numbers-only: line ").partition(" ")[0])
    assert first < line <= first + 3
    name = where.__name__
    assert f"of test_conformance_kit.py: the function {name} {what}; it may use numbers" in text
    assert "\n" not in text


def test_the_step_of_a_tracker_uses_numbers_only():
    @dataclass(frozen=True)
    class OfSelf(LaneTracker):
        alpha: float = 0.5

        def program(self, n_axes):
            rows = Rows(n_axes, 0)

            def correct(b, lane, z, prediction, velocity, dt, gap, sigma, update, starts):
                return prediction, self.alpha * z, velocity, self.alpha, 0.1

            return LaneProgram(rows, (), lambda stride: single_axis_step(rows, stride, correct))

    with pytest.raises(AssertionError, match=r"the function correct uses 'self\.alpha', where"):
        run_check("program-uses-numbers-only", OfSelf())


def test_what_a_kernel_may_use():
    run_check("kernel-uses-numbers-only", scheduler_of(WithSelf().kernel("good")))


# -------------------------------------------------------------------- stability


def gains(alpha, beta, gamma=0.0, phi=1.0, memory=()):
    return scheduler_of(lambda e, d, dt, s, m: (alpha, beta, gamma, phi, m), memory)


@pytest.mark.parametrize(
    "values", [(1.9, 3.0), (0.5, -0.1), (2.1, 0.1), (-0.1, 0.2), (0.5, 0.2, 0.3), (0.5, 0.2, -0.1)]
)
def test_gains_outside_of_the_stability_region(values):
    with pytest.raises(
        AssertionError, match=r"^gains-are-stable: kernel at .*2 alpha \+ beta <= 4"
    ):
        run_check("gains-are-stable", gains(*values))
    allowed = gains(*values)
    type(allowed).may_be_unstable = True
    run_check("gains-are-stable", allowed)


@pytest.mark.parametrize(
    # Deadbeat gains, a plot that is left out, the corners and edges, and acceleration that fades.
    "values",
    [(1.0, 1.0), (1.0, 1.5, 1.0), (0.0, 0.0), (0.0, 4.0), (2.0, 0.0), (1.0, 2.0),
     (0.5, 0.2, 0.5, 0.2)],
)  # fmt: skip
def test_the_edge_of_the_region_is_inside(values):
    run_check("gains-are-stable", gains(*values))


def test_gains_that_become_unstable_later():
    def wanders(innovation, change, dt, sigma, memory):
        return 0.5, 0.2 + memory[0], 0.0, 1.0, (memory[0] + 0.2,)

    with pytest.raises(AssertionError, match="make a filter unstable"):
        run_check("gains-are-stable", scheduler_of(wanders, (0.0,)))


@pytest.mark.parametrize("direction", [-1.0, 1.0])
def test_gains_are_stable_for_large_innovations_in_both_directions(direction):
    def jumps(innovation, change, dt, sigma, memory):
        return 1.9 if direction * innovation > 1e6 else 0.5, 0.3, 0.0, 1.0, memory

    with pytest.raises(AssertionError, match=r"innovation -?1e[+]09, .* make a filter unstable"):
        run_check("gains-are-stable", scheduler_of(jumps))


def test_steps_of_a_start_need_no_gains():
    def counts(innovation, change, dt, sigma, memory):
        return (0.5 if memory[0] > 1.0 else 9.0), 0.2, 0.0, 1.0, (memory[0] + 1.0,)

    run_check("gains-are-stable", scheduler_of(counts, (0.0,), sees_every_step=True))
    with pytest.raises(AssertionError, match="alpha = 9"):
        run_check("gains-are-stable", scheduler_of(counts, (0.0,)))


# -------------------------------------------------------------------- names


def test_checks_have_names():
    names = [check.name for check in checks_for(KalmanCV(0.5))]
    assert len(set(names)) == len(names)
    assert {"batch-equals-single", "streaming-equals-run", "gains-are-stable"} <= set(names)
    tracker = [check.name for check in checks_for(ft.AlphaBetaTracker(KalmanCV(0.5)))]
    assert set(tracker) - set(names) == {"program-uses-numbers-only"}
    assert "compiled-equals-plain" in tracker
    assert "compiled-equals-plain" not in [check.name for check in checks_for(Faulty())]


def test_the_page_lists_every_check_and_every_kind_of_plugin():
    page = (Path(__file__).resolve().parents[1] / "docs" / "plugins.md").read_text()
    for subject in (ft.FixedGains(0.5, 0.2), ft.AlphaBetaTracker(ft.FixedGains(0.5, 0.2))):
        assert [check.name for check in checks_for(subject) if f"`{check.name}`" not in page] == []
    for registry in (schedulers, trackers, normalizations):
        assert f"| `{registry.group}` |" in page


@parametrize_with_checks({"good": ft.FixedGains(0.5, 0.2)})
def test_each_check_is_a_test(check, request):
    assert request.node.name == f"test_each_check_is_a_test[good-{check.name}]"
    if check.name != "compiled-equals-plain":
        check()


def test_objects_of_a_class_are_numbered():
    mark = parametrize_with_checks([ft.FixedGains(0.5, 0.2), Faulty(), ft.FixedGains(0.4, 0.2)])
    ids = [parameters.id for parameters in mark.args[1]]
    assert len(set(ids)) == len(ids)
    for name in ("FixedGains-hashable", "Faulty-batch-equals-single", "FixedGains-2-hashable"):
        assert name in ids


def test_any_other_error_says_in_which_check():
    def raises(result, t, z):
        raise KeyError("z")

    with pytest.raises(
        AssertionError, match=r"^inputs-left-alone: Faulty raises KeyError: 'z'$"
    ) as caught:
        run_check("inputs-left-alone", Faulty(run=raises))
    assert isinstance(caught.value.__cause__, KeyError)


def test_an_error_of_the_compiler_is_one_sentence():
    def mixed(innovation, change, dt, sigma, memory):
        return (0.5 if abs(innovation) < 1e12 else "half"), 0.2, 0.0, 1.0, memory

    with pytest.raises(AssertionError) as caught:
        run_check("compiled-equals-plain", scheduler_of(mixed))
    assert re.match(
        r"compiled-equals-plain: Made raises TypingError: \S.*float64.*$", str(caught.value)
    )


@dataclass(frozen=True)
class Corrected(LaneTracker):
    """A tracker with fixed gains whose `correct` is replaced."""

    kind: str

    def program(self, n_axes):
        rows = Rows(n_axes, 0)

        def four_answers(b, lane, z, prediction, velocity, dt, gap, sigma, update, starts):
            return prediction, prediction, 0.5, 0.1

        def nine_arguments(b, lane, z, prediction, velocity, dt, gap, sigma, update):
            return prediction, prediction, velocity, 0.5, 0.1

        def divides(b, lane, z, prediction, velocity, dt, gap, sigma, update, starts):
            return prediction, prediction, velocity, 0.5 / (0.0 * gap), 0.1

        correct = locals()[self.kind]
        return LaneProgram(rows, (), lambda stride: single_axis_step(rows, stride, correct))


@pytest.mark.parametrize(
    ("kind", "error"),
    [
        ("four_answers", r"not enough values to unpack \(expected 5, got 4\)"),
        ("nine_arguments", "takes 9 positional arguments but 10 were given"),
    ],
)
def test_what_correct_takes_and_returns(kind, error):
    expected = (
        r"Corrected: correct must take \(buffer, lane, z, .*, update, starts\) and return "
        rf"\(prediction, position, velocity, alpha, beta\); .*{error}$"
    )
    with pytest.raises(AssertionError, match=f"^results-have-shape-of-plots: {expected}"):
        check_tracker(Corrected(kind))
    with pytest.raises(PluginError, match=expected) as caught:
        Corrected(kind).start(0.0, 0.0)
    assert caught.value.location.file == __file__


def test_an_error_inside_of_correct_is_its_own():
    with pytest.raises(AssertionError, match="Corrected raises ZeroDivisionError: float division"):
        check_tracker(Corrected("divides"))
    with pytest.raises(ZeroDivisionError) as caught:
        Corrected("divides").run([0.0, 1.0], [0.0, 1.0])
    assert caught.value.__notes__ == ["in a step of Corrected"]


# -------------------------------------------------------------------- trackers


class Faulty:
    """A good tracker with one method changed."""

    def __init__(self, **changes):
        self.good = ft.AlphaBetaTracker(ft.FixedGains(0.5, 0.2))
        self.changes = changes

    def run(self, t, z, sigma=None):
        return self.changes.get("run", lambda result, t, z: result)(
            self.good.run(t, z, sigma), t, z
        )

    def start(self, z, t, sigma=None):
        return self.good.start(z, t, sigma)

    def step(self, state, z, t, sigma=None):
        new = self.good.step(state, z, t, sigma)
        return self.changes.get("step", lambda state: state)(new)

    def predict(self, state, t, sigma=None):
        found = self.good.predict(state, t, sigma)
        return self.changes.get("predict", lambda found, state: found)(found, state)


def spoil_input(result, t, z):
    if len(z) > 2:
        z[2] = 0.0
    return result


def shift(result, t, z):
    return replace(result, predicted=result.predicted + z.ndim * 1e-12)


def narrow(result, t, z):
    return replace(result, velocity=result.velocity[..., :1])


def zero_gains(result, t, z):
    gains = replace(result.gains, alpha=np.nan_to_num(result.gains.alpha))
    return replace(result, gains=gains)


def drift(state):
    return replace(state, lanes=state.lanes + 1e-9)


def spoil_state(found, state):
    state.lanes[0] += 1.0
    return found


def hurry(found, state):
    return replace(found, velocity=found.velocity * (1 + 1e-15))


def boast(found, state):
    return replace(found, innovation_variance=np.full(found.position.shape, 100.0))


def one_for_all(found, state):
    return replace(found, position_variance=np.array(1.0))


def less_than_nothing(found, state):
    variance = np.full(found.position.shape, -1.0)
    return replace(found, position_variance=variance, innovation_variance=variance + 100.0)


@pytest.mark.parametrize(
    ("changes", "promise"),
    [
        ({"predict": spoil_state}, "predict must leave the state as it is"),
        ({"predict": hurry}, "equal a step with a missed plot: velocity differs"),
        ({"predict": boast}, "must be position_variance plus the variance of the plot"),
        ({"predict": one_for_all}, r"position_variance must have the shape \(2,\)"),
        ({"predict": less_than_nothing}, "position_variance must not be negative"),
        ({"run": spoil_input}, "run must leave its inputs as they are|same track"),
        ({"run": shift}, "batch must equal its tracks one by one|must be the prediction"),
        ({"run": narrow}, "velocity must have the shape"),
        ({"run": zero_gains}, "innovation and gains must be NaN"),
        ({"step": drift}, "streaming must equal run"),
    ],
)
def test_faulty_trackers(changes, promise):
    with pytest.raises(AssertionError, match=promise):
        check_tracker(Faulty(**changes))


class Accepting(Faulty):
    """Swallows bad input."""

    def run(self, t, z, sigma=None):
        z = np.where(np.isinf(z), np.nan, z)
        return super().run(t, z, sigma)


def test_bad_input_must_not_be_swallowed():
    with pytest.raises(AssertionError, match="an infinite plot must raise ValueError"):
        check_tracker(Accepting())


class Timeless(Faulty):
    """Predicts for times gone by, too."""

    def predict(self, state, t, sigma=None):
        return super().predict(state, np.where(t > state.time, t, state.time + 1.0), sigma)


def test_times_gone_by_must_be_refused():
    with pytest.raises(AssertionError, match=r"a time that is not later .* must raise ValueError"):
        check_tracker(Timeless())


class Confident(KalmanCV):
    """Presumes less noise than there is when it is asked for a prediction."""

    def prediction_variance(self, memory, dt):
        return 0.99 * super().prediction_variance(memory, dt)


def test_a_variance_must_be_that_of_the_covariance():
    tracker = ft.AlphaBetaTracker(Confident(1.0))
    with pytest.raises(AssertionError, match="must be that of track_covariance"):
        check_tracker(tracker)


def test_a_tracker_has_four_verbs():
    with pytest.raises(AssertionError, match="must have run, start, step and predict, got FixedG"):
        check_tracker(ft.FixedGains(0.5, 0.2))
    with pytest.raises(AssertionError, match="got the class Faulty; give an object"):
        list(checks_for(Faulty))
