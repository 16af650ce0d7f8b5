"""Random rule bases, and programs in C built from what was exported."""

from __future__ import annotations

import ctypes
import re
import shutil
import subprocess

import numpy as np
from hypothesis import strategies as st

from fuzzytrack.fuzzy.membership import FuzzySet
from fuzzytrack.fuzzy.rulebase import Consequent, Operators, Rule, RuleBase
from fuzzytrack.fuzzy.variable import Universe, Variable

WARNINGS = (
    "-std=c99", "-pedantic", "-Wall", "-Wextra", "-Wconversion", "-Wsign-conversion", "-Wshadow",
    "-Wdouble-promotion", "-Wundef", "-Werror",
)  # fmt: skip
COMPILERS = [name for name in ("gcc", "clang") if shutil.which(name)]
TYPES = {"double": np.float64, "float": np.float32, "q15": np.int16}

PLACES = st.integers(0, 12)


@st.composite
def straight_bases(draw, defaults=(True, False)):
    """Product and sum, sets with straight sides without jumps, rules that may leave holes."""
    inputs = []
    for name in "ab"[: draw(st.integers(1, 2))]:
        corners = draw(st.lists(st.lists(PLACES, min_size=4, max_size=4), min_size=1, max_size=3))
        sets = []
        for k, places in enumerate(corners):
            a, b, c, d = sorted(places)
            # A side that would be vertical within the universe is moved out of it.
            a = -1 if a == b else a
            d = 13 if c == d else d
            sets.append(FuzzySet(f"s{k}", "trapmf", tuple(p / 4 - 1.3 for p in (a, b, c, d))))
        inputs.append(Variable(name, Universe(-1.3, 1.7, 13), tuple(sets)))
    outputs = tuple(
        Variable(
            name,
            Universe(low, high, 21),
            (
                FuzzySet("p", "trimf", (low, low, high)),
                FuzzySet("q", "trimf", (low, (low + 2 * high) / 3, high)),
            ),
            default=low + (high - low) / 3 if draw(st.sampled_from(defaults)) else None,
        )
        for name, low, high in (("u", 0.25, 0.35), ("v", -2.0, 3.0))
    )
    conditions = st.fixed_dictionaries(
        {v.name: st.sampled_from([*v.set_names, None]) for v in inputs}
    )
    rows = draw(
        st.lists(
            conditions,
            min_size=1,
            max_size=5,
            unique_by=lambda row: tuple(sorted(row.items(), key=str)),
        )
    )
    rules = []
    for row in rows:
        given_ = tuple((name, word) for name, word in sorted(row.items()) if word is not None)
        if given_:
            words = [draw(st.sampled_from("pq")) for _ in outputs]
            sure = draw(st.sampled_from([1.0, 0.5]))
            about = (Consequent(v.name, w, sure) for v, w in zip(outputs, words, strict=True))
            rules.append(Rule(given_, tuple(about)))
    if not rules:
        rules = [Rule(((inputs[0].name, "s0"),), tuple(Consequent(v.name, "p") for v in outputs))]
    way = draw(st.sampled_from(["centroid", "weighted-centers"]))
    return RuleBase(
        "random", tuple(inputs), outputs, tuple(rules), Operators("product", "sum", way)
    )


def partition_base(n_inputs=2, name="shared"):
    """Sets that share out every point, unevenly, and a rule for every combination."""
    centers = (-1.0, -0.35, 0.1, 0.45, 2.0)
    sets = tuple(
        FuzzySet(f"s{k}", "trimf", (centers[max(k - 1, 0)], c, centers[min(k + 1, 4)]))
        for k, c in enumerate(centers)
    )
    inputs = tuple(Variable(n, Universe(-1.0, 2.0, 31), sets) for n in "abc"[:n_inputs])
    terms = tuple(FuzzySet(f"t{k}", "singleton", (c,)) for k, c in enumerate((0.1, 0.4, 0.45, 1.3)))
    output = Variable("y", Universe(0.1, 1.3, 31), terms)
    random = np.random.default_rng(3)
    rules = tuple(
        Rule(
            tuple(zip("abc", (f"s{k}" for k in cell), strict=False)),
            (Consequent("y", f"t{random.integers(4)}"),),
        )
        for cell in np.ndindex(*[5] * n_inputs)
    )
    operators = Operators("product", "sum", "weighted-centers")
    return RuleBase(name, inputs, (output,), rules, operators)


def built(made, folder, compiler="gcc", options=("-O2",)):
    """A function of rows of inputs, shape (n, n_inputs), that runs the exported C."""
    made.write(folder)
    signature = re.search(r"FUZZYTRACK_INLINE (\w+_outputs) (\w+_infer)\((.*)\)", made.header)
    structure, function, parameters = signature.groups()
    members = re.search(r"typedef struct {([^}]*)} \w+_outputs;", made.header)[1]
    outputs = re.findall(r"\w+ (\w+);", members)
    n_inputs = parameters.count(",") + 1
    c_type = parameters.split()[0]
    (folder / "driver.c").write_text(
        f'#include <math.h>\n#include "{made.name}.h"\n'
        f"void driver(long n, const {c_type} *x, {c_type} *y);\n"
        f"void driver(long n, const {c_type} *x, {c_type} *y)\n{{\n    long k;\n"
        f"    for (k = 0; k < n; k++) {{\n        const {structure} out = {function}("
        + ", ".join(f"x[(k * {n_inputs}) + {j}]" for j in range(n_inputs))
        + ");\n"
        + "".join(
            f"        y[(k * {len(outputs)}) + {j}] = out.{word};\n"
            for j, word in enumerate(outputs)
        )
        + "    }\n}\n"
    )
    library = folder / "driver.so"
    command = [compiler, *WARNINGS, *options, "-shared", "-fPIC", "driver.c", "-o", library]
    subprocess.run(command, cwd=folder, check=True)
    driver = ctypes.CDLL(str(library)).driver

    def evaluate(rows):
        dtype = TYPES[made.number]
        given_ = np.ascontiguousarray(rows, dtype)
        answer = np.empty((len(rows), len(outputs)), dtype)
        pointers = [ctypes.c_void_p(a.ctypes.data) for a in (given_, answer)]
        driver(ctypes.c_long(len(rows)), *pointers)
        return answer

    return evaluate
