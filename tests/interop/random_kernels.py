"""Random functions in the restricted Python of kernels, as text."""

import math
from functools import cache

from hypothesis import strategies as st

__all__ = ["functions", "made"]

CONSTANTS = ("0.0", "-0.0", "1.0", "-1.5", "0.1", "3.0", "1e-3", "250.0", "LIMIT", "nan", "inf")
#: What generated functions find around them.
HELPERS = """
def clipped(x, low, high=2.5):
    if x < low:
        return low
    return high if x > high else x


def both(x, y):
    if x != x or y != y:
        return 0.0, x, False
    quotient = x / (1.0 + y * y)
    return quotient, x - quotient, quotient > y


def turned(vector):
    x, *rest = vector
    return (*rest, x)


halved = lambda x: 0.5 * x  # noqa: E731
"""


@cache
def numbers(depth, names=("a", "b", "c", "m[0]", "m[-1]", "x", "y")):
    leaf = st.sampled_from([*CONSTANTS, *names, *names])
    if depth == 0:
        return leaf
    n, w, t = numbers(depth - 1, names), wholes(depth - 1, names), truths(depth - 1, names)
    return st.one_of(
        leaf,
        st.builds("({} {} {})".format, n, st.sampled_from(["+", "-", "*", "/", "//", "%"]), n),
        st.builds("({} {} {})".format, n, st.sampled_from(["+", "-", "*", "/"]), w),
        st.builds("(-{})".format, n),
        st.builds("({} if {} else {})".format, n, t, n),
        st.builds("{}({}, {})".format, st.sampled_from(["min", "max"]), n, n),
        st.builds("min({}, {}, {})".format, n, n, n),
        st.builds("abs({})".format, n),
        st.builds("math.fabs({})".format, n),
        st.builds("math.sqrt(abs({}))".format, n),
        st.builds("float({})".format, w),
        st.builds("({} {} {})".format, n, st.sampled_from(["and", "or"]), n),
        st.builds("TABLE[{} % 5]".format, w),
        st.builds("({}, {}, {})[{} % 3]".format, n, n, n, w),
        st.builds("clipped({}, {})".format, n, n),
        st.builds("clipped({}, high={}, low={})".format, n, n, n),
        st.builds("both({}, {})[{}]".format, n, n, st.integers(0, 1)),
        st.builds("turned(({}, *m))[{}]".format, n, st.integers(-3, 2)),
        st.builds("halved({})".format, n),
        st.builds("sum(m[{}:])".format, st.integers(0, 1)),
    )


@cache
def wholes(depth, names):
    leaf = st.sampled_from(["0", "1", "-3", "7", "COUNT", "n", "len(m)"])
    if depth == 0:
        return leaf
    n, w, t = numbers(depth - 1, names), wholes(depth - 1, names), truths(depth - 1, names)
    return st.one_of(
        leaf,
        st.builds("({} {} {})".format, w, st.sampled_from(["+", "-", "*"]), w),
        st.builds("({} {} {})".format, w, st.sampled_from(["//", "%"]), st.sampled_from([3, -4])),
        st.builds("(-{})".format, w),
        st.builds("abs({})".format, w),
        st.builds("({} if {} else {})".format, w, t, w),
        st.builds("{}({}, {})".format, st.sampled_from(["min", "max"]), w, w),
        st.builds(
            "{}({})".format,
            st.sampled_from(["int", "math.floor", "math.ceil", "math.trunc", "round"]),
            n,
        ),
        st.builds("int(min(max({}, 0.0), 4.0))".format, n),
        st.builds("PLACES[{} % 3]".format, w),
    )


@cache
def truths(depth, names):
    n, w = numbers(max(depth - 1, 0), names), wholes(max(depth - 1, 0), names)
    signs = st.sampled_from(["<", "<=", ">", ">=", "==", "!="])
    compared = st.one_of(
        st.builds("({} {} {})".format, n, signs, n),
        st.builds("({} {} {})".format, n, signs, w),
        st.builds("({} {} {})".format, w, signs, w),
        st.builds("({} {} {} {} {})".format, n, signs, n, signs, w),
    )
    if depth == 0:
        return compared
    t = truths(depth - 1, names)
    return st.one_of(
        compared,
        st.builds("({} {} {})".format, t, st.sampled_from(["and", "or", "&", "|", "^"]), t),
        st.builds("(not {})".format, t),
        st.builds("math.isnan({})".format, n),
        st.builds("math.isfinite({})".format, n),
        st.builds("bool({})".format, n),
        st.builds("both({}, {})[2]".format, n, n),
    )


@st.composite
def functions(draw, depth=3):
    """Text of a function ``kernel(a, b, c, m)`` of three numbers and a tuple of two."""
    some = st.deferred(lambda: numbers(depth, ("a", "b", "c", "m[0]", "m[-1]")))
    n, w = numbers(depth), wholes(depth, ("a", "b", "c", "m[0]", "m[-1]", "x", "y"))
    t = truths(2, ("a", "b", "c", "m[0]", "m[-1]", "x", "y"))
    turns = draw(st.integers(0, 6))
    jump = draw(st.sampled_from(["pass", "break", "continue"])) if turns > 1 else "pass"
    lines = [
        "n = 2",
        f"x = {draw(some)}",
        f"y = {draw(st.sampled_from(['a', 'b * x', 'x']))}",
        f"n = {draw(w)}",
        f"if {draw(t)}:",
        f"    x = {draw(n)}",
        f"    z = {draw(n)}",
        f"elif {draw(t)}:",
        "    z = 1",
        "else:",
        f"    y, z = {draw(n)}, x",
        f"for i in range({turns}):",
        f"    if {draw(t)}:",
        f"        {jump}",
        f"    x = {draw(n)} + i * 0.5",
        f"    n = n % 5 + i - {draw(st.integers(0, 3))}",
        f"x, y = y, {draw(n)}",
        f"t = (x, *m, {draw(n)}, float(z))",
        f"t = t if {draw(t)} else (*turned((y, *m)), float(n), {draw(n)})",
        "total = 0.0",
        "for part in t:",
        "    total += part",
        f"if {draw(t)}:",
        f"    return total, t[1:3], {draw(w)}",
        f"return {draw(n)}, (total, t[n % 5]), n",
    ]
    return "def kernel(a, b, c, m):\n" + "".join(f"    {line}\n" for line in lines)


def made(text, **other):
    """The function of a text, with what is around it; `other` takes the place of some of that."""
    around = {
        "math": math, "nan": math.nan, "inf": math.inf, "LIMIT": 12.25, "COUNT": 3,
        "TABLE": (0.5, -2.0, 1e6, math.nan, 7.75), "PLACES": (2, -1, 40),
    }  # fmt: skip
    whole = HELPERS + "\n\n" + text
    namespace = {**around, **other, "__name__": "random_kernels"}
    exec(compile(whole, "<random kernel>", "exec"), namespace)
    for name in ("kernel", "clipped", "both", "turned", "halved"):
        vars(namespace[name])["source"] = whole
    return namespace["kernel"]
