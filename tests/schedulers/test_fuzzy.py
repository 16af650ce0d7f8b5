import pickle
from dataclasses import dataclass, replace

import numpy as np
import pytest

import fuzzytrack as ft
from fuzzytrack.fuzzy.loading import loads_rulebase
from fuzzytrack.fuzzy.ramps import find_ramps
from fuzzytrack.fuzzy.saving import dumps_rulebase
from fuzzytrack.fuzzy.variable import Universe, Variable
from fuzzytrack.gains import resampled_gains
from fuzzytrack.normalizations import normalizations
from fuzzytrack.normalizations.chan import Chan
from fuzzytrack.testing import check_scheduler


@pytest.fixture(scope="module")
def rules():
    return ft.load_rulebase("stiffness-damping")


def changed(rules, old, new):
    text = dumps_rulebase(rules)
    assert old in text
    return ft.loads_rulebase(text.replace(old, new), "my.yaml")


def test_gains_come_from_the_rule_base_through_the_w_domain(rules):
    kernel = ft.FuzzyScheduler(rules).kernel(1)
    # E = 3/10, and with E′ = 0.5 the error rate is -0.2/0.5
    alpha, beta, gamma, phi, memory = kernel(3.0, -10.0, 1.0, float("nan"), (0.5,))
    inferred = ft.FuzzySystem(rules)(E=0.3, dE=-0.4)
    expected = ft.alpha_beta_from_w(inferred["stiffness"], inferred["damping"])
    assert (alpha, beta) == pytest.approx(expected, rel=1e-12)
    assert (gamma, phi, memory) == (0.0, 1.0, (0.3,))


def test_direct_gains_and_coupling():
    scheduler = ft.FuzzyScheduler(ft.load_rulebase("chan-style"))
    assert scheduler.coupled
    assert not scheduler.needs_sigma
    alpha, beta, *_ = scheduler.kernel(2)((0.0, 0.0), (1.0, 1.0), 1.0, (1.0, 1.0), (0.0, 0.0))
    assert (alpha, beta) == pytest.approx((0.3, 0.1))
    alpha, beta, *_ = scheduler.kernel(2)((9.0, -9.0), (1.0, 1.0), 1.0, (1.0, 1.0), (0.0, 0.0))
    assert (alpha, beta) == pytest.approx((0.9, 0.6))


def with_gamma(rules, high=0.01):
    """The rule base with outputs alpha, beta and gamma in place of stiffness and damping."""
    text = dumps_rulebase(rules)
    for old, new in (
        ("stiffness", "beta"),
        ("damping", "alpha"),
        ("gains: w-domain", "gains: direct"),
    ):
        text = text.replace(old, new)
    base = ft.loads_rulebase(text.replace("w-domain", "direct"))
    alpha, beta = base.output("alpha"), base.output("beta")
    gamma = Variable(
        "gamma",
        Universe(0.0, high, 11),
        tuple(replace(s, shape="trimf", parameters=(0, high / 2, high)) for s in beta.sets[:1]),
    )
    first = gamma.sets[0].name
    rules = tuple(
        replace(r, consequents=(*r.consequents, ft.fuzzy.rulebase.Consequent("gamma", first)))
        for r in base.rules
    )
    return replace(base, outputs=(gamma, alpha, beta), rules=rules, layout=None)


def test_direct_gains_with_gamma_in_any_order(rules):
    scheduler = ft.FuzzyScheduler(with_gamma(rules))
    assert scheduler.uses_acceleration
    alpha, beta, gamma, *_ = scheduler.kernel(1)(0.0, 1.0, 1.0, 1.0, (0.0,))
    assert (alpha, beta, gamma) == pytest.approx((0.89, 0.35, 0.005))
    check_scheduler(scheduler)


def test_unstable_reach_is_refused(rules):
    with pytest.raises(ft.RuleBaseError, match="reach unstable gains"):
        ft.FuzzyScheduler(with_gamma(rules, high=3.0))
    stiffness = rules.output("stiffness")
    negative = replace(stiffness, universe=Universe(-0.1, 0.35, 41))
    with pytest.raises(ft.RuleBaseError, match="stiffness must not be negative"):
        ft.FuzzyScheduler(replace(rules, outputs=(negative, rules.output("damping"))))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            "normalization: chan",
            "normalization: chann",
            "unknown normalization 'chann'; one of",
        ),
        ("gains: w-domain", "gains: direct", "gains 'direct' need outputs alpha, beta or alpha"),
        ("gains: w-domain", "gains: w", "unknown gains 'w'; one of w-domain, kalata, direct"),
        ("gains: w-domain", "gains: kalata", "gains 'kalata' need outputs stiffness; stiffness-d"),
        ("w-domain}", "w-domain, opening: fast}", "unknown opening 'fast'; one of growing-memory"),
        (
            "w-domain}",
            "w-domain, rho: 0.5}",
            "unknown scheduler setting 'rho' for normalization 'chan'; allowed: normalization, "
            "gains, opening, period",
        ),
        (
            "chan, gains: w-domain}",
            "smoothed, gains: w-domain, roh: 0.5}",
            "unknown scheduler setting 'roh' .* did you mean 'rho'?",
        ),
        (
            "chan, gains: w-domain}",
            "smoothed, gains: w-domain, rho: 1.5}",
            "rho must be >= 0 and < 1, got 1.5",
        ),
        ("w-domain}", "w-domain, period: soon}", "period must be a number of seconds, got 'soon'"),
        ("w-domain}", "w-domain, period: 0}", "period must be positive and finite .*, got 0"),
    ],
)
def test_wrong_settings_are_shown_where_they_stand(rules, old, new, message):
    wrong = changed(rules, old, new)
    with pytest.raises(ft.RuleBaseError, match=message) as caught:
        ft.FuzzyScheduler(wrong)
    assert caught.value.location.file == "my.yaml"
    assert caught.value.location.line > 40
    assert str(caught.value).startswith(f"my.yaml:{caught.value.location.line}:")


def test_the_place_of_a_wrong_number_is_its_own(rules):
    wrong = changed(rules, "chan, gains: w-domain}", "smoothed, gains: w-domain, rho: 1.5}")
    with pytest.raises(ft.RuleBaseError) as caught:
        ft.FuzzyScheduler(wrong)
    line = dumps_rulebase(wrong).splitlines()[caught.value.location.line - 1]
    assert line[caught.value.location.column - 1 :] == "1.5}"


@pytest.mark.parametrize("name", ["agreement_time", "time", "gap"])
def test_the_place_of_a_wrong_number_is_not_that_of_a_name_within_its_own(name):
    rules = ft.load_rulebase("maneuver")
    number = dict(rules.scheduler)[name]
    wrong = changed(rules, f"{name}: {number}", f"{name}: 0")
    with pytest.raises(ft.RuleBaseError, match=f" {name} must be finite and > 0, got 0") as caught:
        ft.FuzzyScheduler(wrong)
    line = dumps_rulebase(wrong).splitlines()[caught.value.location.line - 1]
    assert line[: caught.value.location.column - 1].endswith(f" {name}: ")


def test_numbers_of_the_normalization(rules):
    with_rho = changed(rules, "chan, gains: w-domain}", "smoothed, rho: 0.25, gains: w-domain}")
    assert ft.FuzzyScheduler(with_rho).normalization.rho == 0.25
    *_, memory = ft.FuzzyScheduler(with_rho).kernel(1)(8.0, 0.0, 1.0, 2.0, (1.0,))
    assert memory == (0.25 * 1 + 0.75 * 4,)
    assert ft.loads_rulebase(dumps_rulebase(with_rho)) == with_rho
    assert "rho: 0.25," in dumps_rulebase(with_rho)
    settings = (*rules.scheduler, ("rho", "half"))
    with pytest.raises(ft.RuleBaseError, match="unknown scheduler setting 'rho'"):
        ft.FuzzyScheduler(replace(rules, scheduler=settings))
    settings = (("normalization", "smoothed"), ("gains", "w-domain"), ("rho", "half"))
    with pytest.raises(ft.RuleBaseError, match="rho of normalization 'smoothed' must be a number"):
        ft.FuzzyScheduler(replace(rules, scheduler=settings))


@pytest.mark.parametrize(
    ("settings", "word"),
    [
        ("{normalization: smoothed, gain: w-domain}", "gain"),
        ("{normalizaton: smoothed, gains: w-domain}", "normalizaton"),
        ("{gains: w-domain, rho: 0.5}", "rho"),
        ("{normalization: smoothed, rho-1: 0.5, gains: w-domain}", "rho-1"),
    ],
)
def test_unknown_keys_are_shown_where_they_stand(rules, settings, word):
    wrong = changed(rules, "{normalization: chan, gains: w-domain}", settings)
    with pytest.raises(ft.RuleBaseError, match=f"unknown scheduler setting '{word}'") as caught:
        ft.FuzzyScheduler(wrong)
    assert "allowed: normalization, gains, opening, period" in str(caught.value)
    assert caught.value.location.file == "my.yaml"
    line = dumps_rulebase(wrong).splitlines()[caught.value.location.line - 1]
    assert line[caught.value.location.column - 1 :].startswith(word)


@pytest.mark.parametrize("number", ["half", "1_0", "inf", "nan"])
def test_a_setting_of_a_normalization_must_be_a_number(rules, number):
    settings = f"{{normalization: smoothed, rho: {number}, gains: w-domain}}"
    wrong = changed(rules, "{normalization: chan, gains: w-domain}", settings)
    message = f"my.yaml:.*: rho of normalization 'smoothed' must be a number, got '{number}'"
    with pytest.raises(ft.RuleBaseError, match=message):
        ft.FuzzyScheduler(wrong)


def test_a_missing_key_is_shown_where_the_others_stand(rules):
    wrong = changed(rules, "chan, gains: w-domain}", "chan}")
    with pytest.raises(ft.RuleBaseError, match="no scheduler setting 'gains'") as caught:
        ft.FuzzyScheduler(wrong)
    assert caught.value.location.file == "my.yaml"


def test_a_number_that_a_normalization_lacks(rules):
    @dataclass(frozen=True)
    class Limited(Chan):
        limit: float

    normalizations.register("limited")(Limited)
    try:
        without = changed(rules, "normalization: chan", "normalization: limited")
        with pytest.raises(ft.RuleBaseError, match="'limited' needs the scheduler settings limit"):
            ft.FuzzyScheduler(without)
        given = changed(rules, "normalization: chan", "normalization: limited, limit: -2")
        assert ft.FuzzyScheduler(given).normalization == Limited(-2.0)
    finally:
        normalizations.unregister("limited")


def test_a_rule_base_without_settings_cannot_schedule():
    with pytest.raises(ft.RuleBaseError, match="no scheduler setting 'normalization'"):
        ft.FuzzyScheduler(ft.load_rulebase("tipper"))


def test_more_inputs_than_signals(rules):
    third = replace(rules.inputs[0], name="third")
    with pytest.raises(ft.RuleBaseError, match=r"gives 2 signals .*has 3 inputs"):
        ft.FuzzyScheduler(replace(rules, inputs=(*rules.inputs, third), layout=None))


def test_silence_is_refused_unless_there_is_a_default(rules):
    fewer = replace(rules, rules=rules.rules[1:], layout=None)
    with pytest.raises(ft.RuleBaseError, match="no rule about stiffness fires for E between -1"):
        ft.FuzzyScheduler(fewer)
    outputs = tuple(replace(v, default=v.universe.low) for v in fewer.outputs)
    scheduler = ft.FuzzyScheduler(replace(fewer, outputs=outputs))
    # Large negative error and error rate: where the first rule is missing
    alpha, beta, *_ = scheduler.kernel(1)(-1.0, 1.0, 1.0, 1.0, (1.0,))
    assert (alpha, beta) == pytest.approx(ft.alpha_beta_from_w(0.25, 0.54))


def test_maxima_need_a_table(rules):
    mom = changed(rules, "defuzzification: weighted-centers", "defuzzification: mom")
    with pytest.raises(ValueError, match="for mom use method='relation' or 'table'"):
        ft.FuzzyScheduler(mom)
    ft.FuzzyScheduler(mom, "relation")


def test_schedulers_of_equal_rules_are_equal(rules):
    one, other = ft.FuzzyScheduler(rules), ft.FuzzyScheduler(ft.load_rulebase("stiffness-damping"))
    assert one == other
    assert hash(one) == hash(other)
    assert pickle.loads(pickle.dumps(one)) == one
    assert one != ft.FuzzyScheduler(rules, "table")


def test_the_system_is_made_once_and_left_behind(rules):
    scheduler = ft.FuzzyScheduler(rules, "table")
    assert scheduler.system is scheduler.system
    size = len(pickle.dumps(scheduler))
    assert size < scheduler.system.table.values["stiffness"].nbytes
    twin = pickle.loads(pickle.dumps(scheduler))
    assert twin.kernel(1)(3.0, -10.0, 1.0, 1.0, (0.5,)) == scheduler.kernel(1)(
        3.0, -10.0, 1.0, 1.0, (0.5,)
    )


@pytest.mark.parametrize("name", ["chan-style", "omega-schedule", "stiffness-damping"])
def test_rule_bases_of_ramps_are_never_silent(name):
    rules = ft.load_rulebase(name)
    assert find_ramps(rules) is not None
    axes = []
    for variable in rules.inputs:
        corners = {p for s in variable.sets for p in s.breakpoints()}
        beside = {np.nextafter(p, toward) for p in corners for toward in (-np.inf, np.inf)}
        axes.append(sorted(corners | beside | set(variable.universe.values)))
    grid = dict(zip(rules.input_names, np.meshgrid(*axes), strict=True))
    for values in ft.FuzzySystem(rules)(**grid).values():
        assert not np.isnan(values).any()


def test_scaled_innovations_need_sigma(rules):
    scaled = ft.FuzzyScheduler(changed(rules, "normalization: chan", "normalization: scale"))
    assert scaled.needs_sigma
    tracker = ft.AlphaBetaTracker(scaled)
    with pytest.raises(ValueError, match="sigma: FuzzyScheduler needs the standard deviation"):
        tracker.run([0, 1, 2], [0, 1, 2])
    rough = tracker.run(np.arange(4), [0, 10, 19, 31], sigma=1e6)
    # Innovations far below the noise are zero error: the largest gains of the table
    assert rough.gains.alpha[2:] == pytest.approx(0.71383558, abs=1e-4)


# ------------------------------------------------------------------ period


def gains_at(scheduler, dt):
    return scheduler.kernel(1)(3.0, -10.0, dt, 1.0, scheduler.initial_memory(1))[:2]


@pytest.mark.parametrize("name", ["stiffness-damping", "omega-schedule"])
def test_with_a_period_gains_are_those_of_the_same_filter_at_the_time_step(name):
    rules = ft.load_rulebase(name)
    rules = replace(rules, scheduler=tuple(s for s in rules.scheduler if s[0] != "opening"))
    given = gains_at(ft.FuzzyScheduler(rules), 1.0)
    scheduler = ft.FuzzyScheduler(rules, period=30)
    assert gains_at(scheduler, 30.0) == given
    for dt in (0.2, 31.0, 400.0):
        expected = resampled_gains(*given, period=30.0, dt=dt)[:2]
        assert gains_at(scheduler, dt) == pytest.approx(expected, rel=1e-11)


def test_the_period_is_a_setting_that_an_argument_overrides(rules):
    with_period = changed(rules, "w-domain}", "w-domain, period: 60}")
    assert ft.FuzzyScheduler(with_period).period == 60
    assert ft.FuzzyScheduler(with_period, period=4).period == 4
    assert ft.FuzzyScheduler(rules).period is None
    assert ft.FuzzyScheduler(with_period) == ft.FuzzyScheduler(with_period, period=60)
    assert ft.loads_rulebase(dumps_rulebase(with_period)) == with_period
    tracker = ft.AlphaBetaTracker("stiffness-damping:period=60")
    assert tracker.scheduler == ft.FuzzyScheduler(rules, period=60)
    with pytest.raises(ft.RuleBaseError, match="period must be positive and finite"):
        ft.FuzzyScheduler(rules, period=np.inf)


def test_the_opening_is_not_converted():
    rules = ft.load_rulebase("omega-schedule")
    scheduler = ft.FuzzyScheduler(rules, period=1000)
    gains = scheduler.kernel(1)(0.0, 0.0, 1.0, 1.0, (2.0, *scheduler.initial_memory(1)[1:]))[:2]
    assert gains == pytest.approx((5 / 6, 1 / 2))


def test_a_period_is_refused_where_a_pole_may_be_real_and_negative(rules):
    wide = changed(ft.load_rulebase("stiffness-damping-wide"), "w-domain}", "w-domain, period: 60}")
    with pytest.raises(ft.RuleBaseError, match=r"period: at stiffness=0.8, damping=1.3") as caught:
        ft.FuzzyScheduler(wide)
    line = dumps_rulebase(wide).splitlines()[caught.value.location.line - 1]
    assert line[caught.value.location.column - 1 :] == "60}"
    assert "gains with a negative real pole" in str(caught.value)
    assert ft.FuzzyScheduler("chan-style", period=4).period == 4
    with pytest.raises(ft.RuleBaseError, match="gives gamma; only alpha and beta"):
        ft.FuzzyScheduler(with_gamma(rules), period=4)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("universe: [0.25, 0.35", "universe: [-0.25, 0.35", "stiffness must not be negative"),
        ("universe: [0.54, 0", "universe: [-0.54, 0", "damping must not be negative"),
    ],
)
def test_outputs_out_of_range_are_named_with_their_place(rules, old, new, message):
    text = dumps_rulebase(rules)
    assert old in text
    with pytest.raises(ft.RuleBaseError, match=message) as refused:
        ft.FuzzyScheduler(loads_rulebase(text.replace(old, new), "mine.yaml"))
    before = text[: text.index(old) + len("universe: ")]
    place = refused.value.location
    assert (place.file, place.line) == ("mine.yaml", before.count("\n") + 1)
    assert place.column == len(before) - before.rindex("\n")
    # What was changed since comes from no file.
    with pytest.raises(ft.RuleBaseError) as refused:
        ft.FuzzyScheduler(replace(loads_rulebase(text.replace(old, new)), name="other"))
    assert refused.value.location is None


def test_noise_that_reaches_zero_is_named_with_its_place():
    text = dumps_rulebase(ft.load_rulebase("maneuver"))
    low = text.index("universe: [0.09") + len("universe: [")
    changed = text[:low] + "0" + text[low + 4 :]
    with pytest.raises(ft.RuleBaseError, match="noise must be > 0; its universe starts at 0"):
        ft.FuzzyScheduler(loads_rulebase(changed))
    with pytest.raises(ft.RuleBaseError) as refused:
        ft.FuzzyScheduler(loads_rulebase(changed, "m.yaml"))
    assert str(refused.value).startswith(f"m.yaml:{text[:low].count(chr(10)) + 1}:")


def test_a_missing_sigma_names_what_was_written():
    with pytest.raises(ValueError, match="sigma: maneuver:level=3 needs the standard deviation"):
        ft.trackers.catalog.make_tracker("maneuver:level=3").run([0, 1], [0, 1])
