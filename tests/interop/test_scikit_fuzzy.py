"""Control systems of scikit-fuzzy against rule bases made of them, and back."""

import random
import warnings

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from skfuzzy import control, trapmf, trimf

import fuzzytrack as ft
from fuzzytrack.errors import RuleBaseError
from fuzzytrack.fuzzy.loading import loads_rulebase
from fuzzytrack.fuzzy.saving import dumps_rulebase
from fuzzytrack.interop.scikit_fuzzy import from_skfuzzy, to_skfuzzy

METHODS = ("centroid", "bisector", "mom", "som", "lom")


def random_variable(rng, kind, label, count):
    """A variable on an uneven universe for inputs, and an even one for outputs."""
    low = rng.uniform(-3, 1)
    high = low + rng.uniform(0.5, 4)
    if kind is control.Antecedent:
        inner = sorted(rng.uniform(low, high) for _ in range(rng.randint(5, 30)))
        universe = np.unique([low, *inner, high])
    else:
        universe = np.linspace(low, high, rng.choice((201, 401)))
    variable = kind(universe, label)
    for k in range(count):
        corners = sorted(rng.uniform(low, high) for _ in range(4))
        variable[f"t{k}"] = np.clip(trapmf(universe, corners), 0, 1)
    variable["wide"] = np.full(len(universe), rng.uniform(0.2, 1))
    return variable


def random_clause(rng, variables, depth=0):
    kind = rng.random()
    if depth == 2 or kind < 0.4 or len(variables) < 2:
        variable = rng.choice(variables)
        term = variable[rng.choice(list(variable.terms))]
        return ~term if rng.random() < 0.2 else term
    # The sides of an AND are about different variables.
    half = rng.randint(1, len(variables) - 1)
    if kind < 0.7:
        sides = variables[:half], variables[half:]
        return random_clause(rng, sides[0], depth + 1) & random_clause(rng, sides[1], depth + 1)
    return random_clause(rng, variables, depth + 1) | random_clause(rng, variables, depth + 1)


def random_system(seed, methods):
    rng = random.Random(seed)
    names = [f"x{k}" for k in range(rng.randint(1, 3))]
    inputs = [random_variable(rng, control.Antecedent, name, rng.randint(2, 3)) for name in names]
    outputs = [
        random_variable(rng, control.Consequent, f"y{k}", 3) for k in range(rng.randint(1, 2))
    ]
    for output in outputs:
        output.defuzzify_method = rng.choice(methods)
    joined = rng.choice((np.fmin, np.multiply, control.accumulation_mult))
    first = inputs[0]["wide"]
    for variable in inputs[1:]:
        first = first & variable["wide"]
    clauses = [first, *(random_clause(rng, inputs) for _ in range(rng.randint(2, 5)))]
    rules = []
    for clause in clauses:
        terms = [y[rng.choice(list(y.terms))] % round(rng.uniform(0.3, 1), 2) for y in outputs]
        rules.append(control.Rule(clause, terms, and_func=joined))
    return control.ControlSystem(rules), inputs, outputs


def simulated(system, point):
    run = control.ControlSystemSimulation(system)
    for name, value in point.items():
        run.input[name] = value
    computed(run)
    return run.output


def computed(run):
    with warnings.catch_warnings():
        # scikit-fuzzy calls numpy in an old way.
        warnings.simplefilter("ignore", DeprecationWarning)
        run.compute()


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 10**6))
def test_outputs_are_those_of_a_simulation(seed):
    system, inputs, outputs = random_system(seed, ("centroid",))
    rules = from_skfuzzy(system)
    rng = random.Random(seed)
    for _ in range(3):
        point = {v.label: rng.uniform(v.universe[0] - 0.1, v.universe[-1] + 0.1) for v in inputs}
        values, expected = ft.FuzzySystem(rules)(**point), simulated(system, point)
        for output in outputs:
            step = output.universe[1] - output.universe[0]
            assert values[output.label] == pytest.approx(expected[output.label], abs=step / 10)


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 10**6))
def test_strengths_of_rules_are_those_of_a_simulation(seed):
    """At the inputs nothing is approximated: not the grades, and not the rules."""
    system, inputs, _ = random_system(seed, ("centroid",))
    rng = random.Random(seed)
    point = {v.label: rng.uniform(v.universe[0], v.universe[-1]) for v in inputs}
    run = control.ControlSystemSimulation(system)
    for name, value in point.items():
        run.input[name] = value
    computed(run)
    rules = from_skfuzzy(system)
    found = ft.FuzzySystem(rules)
    strength = found.strengths(np.array([[point[name] for name in rules.input_names]]))[0]
    for output in system.consequents:
        for label, term in output.terms.items():
            cuts = [
                s * c.confidence
                for s, rule in zip(strength, rules.rules, strict=True)
                for c in rule.consequents
                if (c.output, c.set_name) == (output.label, label)
            ]
            cut = term.membership_value[run]
            assert max(cuts, default=0.0) == pytest.approx(cut or 0.0, abs=1e-12)


@pytest.mark.parametrize("method", METHODS)
def test_every_method_of_defuzzification(method):
    x = control.Antecedent(np.linspace(0, 1, 5), "x")
    x["lo"], x["hi"] = trimf(x.universe, [0, 0, 1]), trimf(x.universe, [0, 1, 1])
    y = control.Consequent(np.linspace(0, 10, 101), "y", defuzzify_method=method)
    y["small"], y["large"] = trimf(y.universe, [0, 2, 4]), trapmf(y.universe, [5, 6, 7, 10])
    system = control.ControlSystem(
        [control.Rule(x["lo"], y["small"]), control.Rule(x["hi"], y["large"])]
    )
    rules = from_skfuzzy(system)
    assert rules.operators.defuzzification == method
    for value in (0.1, 0.3, 0.8):
        expected = simulated(system, {"x": value})["y"]
        # Rounding decides which of its points are at the maximum there.
        within = 0.01 if method in ("centroid", "bisector") else 0.1 + 1e-9
        assert ft.FuzzySystem(rules)(x=value)["y"] == pytest.approx(expected, abs=within)


def test_two_methods_in_one_system_and_yaml():
    system, _, outputs = random_system(3, METHODS)
    outputs[0].defuzzify_method = "mom"
    rules = from_skfuzzy(system, "mine")
    assert rules.name == "mine"
    assert {rules.operators_of(v).defuzzification for v in rules.outputs} == {
        v.defuzzify_method for v in system.consequents
    }
    assert loads_rulebase(dumps_rulebase(rules)) == rules


def test_consequents_as_conditions_stand_for_those_behind_them():
    x = control.Antecedent(np.linspace(0, 1, 11), "x")
    x["lo"], x["hi"] = trimf(x.universe, [0, 0, 1]), trimf(x.universe, [0, 1, 1])
    y, z = (control.Consequent(np.linspace(0, 1, 101), name) for name in "yz")
    for each in (y, z):
        each["lo"], each["hi"] = trimf(each.universe, [0, 0, 1]), trimf(each.universe, [0, 1, 1])
    rules = [control.Rule(x["lo"], y["lo"]), control.Rule(x["hi"], y["hi"])]
    rules += [control.Rule(y["lo"], z["hi"]), control.Rule(y["hi"], z["lo"])]
    system = control.ControlSystem(rules)
    values = ft.FuzzySystem(from_skfuzzy(system))(x=0.3)
    expected = simulated(system, {"x": 0.3})
    for name in "yz":
        assert values[name] == pytest.approx(expected[name], abs=1e-3)


def small(**options):
    x = control.Antecedent(np.linspace(0, 1, 5), "x")
    z = control.Antecedent(np.linspace(0, 1, 5), "z")
    for each in (x, z):
        each["lo"], each["hi"] = trimf(each.universe, [0, 0, 1]), trimf(each.universe, [0, 1, 1])
    y = control.Consequent(np.linspace(0, 1, 11), "y")
    y["lo"] = trimf(y.universe, [0, 0, 1])
    return x, z, y, options


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (
            lambda x, z, y: [control.Rule(x["lo"], y["lo"], and_func=np.fmax)],
            "and_func fmax has no",
        ),
        (lambda x, z, y: [control.Rule(x["lo"], y["lo"], or_func=np.add)], "rule 1: or_func add"),
        (
            lambda x, z, y: [control.Rule(~(x["lo"] & z["lo"]), y["lo"], and_func=np.multiply)],
            "rule 1: a NOT of several terms",
        ),
        (
            lambda x, z, y: [control.Rule(x["lo"] & x["hi"], y["lo"])],
            "rule 1: two conditions",
        ),
        (lambda x, z, y: [control.Rule(x["lo"], y["lo"] % 1.5)], "rule 1: weight must be within"),
        (
            lambda x, z, y: [
                control.Rule(x["lo"], y["lo"]),
                control.Rule(x["hi"] & z["lo"], y["lo"], and_func=np.multiply),
            ],
            "rules with different functions and_func",
        ),
    ],
)
def test_what_has_no_counterpart_is_named(make, said):
    x, z, y, _ = small()
    with pytest.raises(RuleBaseError, match=f"control_system.*{said}"):
        from_skfuzzy(control.ControlSystem(make(x, z, y)))


def test_other_settings_without_a_counterpart():
    x, _, y, _ = small()
    system = control.ControlSystem([control.Rule(x["lo"], y["lo"])])
    y.defuzzify_method = "best"
    with pytest.raises(RuleBaseError, match="control_system: defuzzify_method 'best' has no"):
        from_skfuzzy(system)
    y.defuzzify_method, y.accumulation_method = "centroid", np.multiply
    with pytest.raises(RuleBaseError, match="accumulation_method multiply of 'y' has no"):
        from_skfuzzy(system)
    with pytest.raises(TypeError, match=r"must be a skfuzzy\.control\.ControlSystem, got int"):
        from_skfuzzy(5)


# -------------------------------------------------------------------- back


@pytest.mark.parametrize(
    "point", [{"service": 2, "food": 1}, {"service": 6.5, "food": 8}, {"service": 9.8, "food": 4}]
)
def test_the_tipper_there_and_back(point):
    expected = ft.FuzzySystem("tipper")(**point)["tip"]
    system = to_skfuzzy("tipper")
    assert simulated(system, point)["tip"] == pytest.approx(expected, abs=0.05)
    again = ft.FuzzySystem(from_skfuzzy(system))
    assert again(**point)["tip"] == pytest.approx(simulated(system, point)["tip"], abs=1e-3)


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("stiffness-damping", "or sum"),
        ("valve", "or sum"),
    ],
)
def test_what_scikit_fuzzy_lacks_is_named(name, said):
    with pytest.raises(RuleBaseError, match=f"{name}: {said} has no counterpart in scikit-fuzzy"):
        to_skfuzzy(name)
    with pytest.raises(ValueError, match="points must be at least 2, got 1"):
        to_skfuzzy("tipper", 1)
