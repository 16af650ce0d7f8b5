"""Arithmetic in C that Python has and C99 without its mathematical library has not.

Each piece of text is a function for one type of number, ``TYPE``, whose names begin with ``NAME_``.
Square roots are rounded correctly, so they are those of the processor to the last bit. The errors
of the others were measured, see `BOUNDS`.
"""

from __future__ import annotations

import re
from collections.abc import Iterable

__all__ = ["BOUNDS", "NEEDS", "TYPES", "arithmetic"]

#: Types of number, by the word that a user writes.
TYPES = {"double": "double", "float": "float"}

#: Largest relative errors of functions that are not rounded correctly, in units of 2^-52 for
#: double and 2^-23 for float: of a million arguments none had more, see `tests/fuzz_c99.py`.
#: Results below the normal numbers are within one step of those that there are.
BOUNDS = {
    ("exp", "double"): 0.7, ("exp", "float"): 0.7,
    ("log", "double"): 0.6, ("log", "float"): 0.6,
    ("cos", "double"): 0.8, ("cos", "float"): 0.6,
    ("pow", "double"): 1.3, ("pow", "float"): 1.3,
}  # fmt: skip

#: Functions that a function calls.
NEEDS = {
    "pow": ("exp", "log_parts", "two_to"), "exp": ("two_to",), "log": ("log_parts",),
    "floor_divide": ("remainder",), "modulo": ("remainder",), "floor": ("whole",),
    "ceil": ("whole",), "cos": ("circular",), "sin": ("circular",),
}  # fmt: skip

_SHARED = {
    "minimum": """
/* Python's min: the first of two that are equal or not comparable. */
INLINE TYPE NAME_minimum(TYPE a, TYPE b)
{
    return b < a ? b : a;
}
""",
    "maximum": """
/* Python's max: the first of two that are equal or not comparable. */
INLINE TYPE NAME_maximum(TYPE a, TYPE b)
{
    return b > a ? b : a;
}
""",
    "minimum_whole": """
INLINE int64_t NAME_minimum_whole(int64_t a, int64_t b)
{
    return b < a ? b : a;
}
""",
    "maximum_whole": """
INLINE int64_t NAME_maximum_whole(int64_t a, int64_t b)
{
    return b > a ? b : a;
}
""",
    "absolute": """
INLINE TYPE NAME_absolute(TYPE x)
{
    return x < ZERO ? -x : ZERO + x;
}
""",
    "absolute_whole": """
INLINE int64_t NAME_absolute_whole(int64_t x)
{
    return x >= 0 ? x : (x == INT64_MIN ? INT64_MAX : -x);
}
""",
    "add_whole": """
/* Sum of integers; the nearest integer that there is, where it is too large. */
INLINE int64_t NAME_add_whole(int64_t a, int64_t b)
{
    if (b > 0) {
        return a > INT64_MAX - b ? INT64_MAX : a + b;
    }
    return a < INT64_MIN - b ? INT64_MIN : a + b;
}
""",
    "multiply_whole": """
/* Product of integers; the nearest integer that there is, where it is too large. */
INLINE int64_t NAME_multiply_whole(int64_t a, int64_t b)
{
    bool fits = true;
    if (a > 0) {
        fits = b >= INT64_MIN / a && b <= INT64_MAX / a;
    } else if (a == -1) {
        fits = b != INT64_MIN;
    } else if (a < -1) {
        fits = b >= INT64_MAX / a && b <= INT64_MIN / a;
    }
    return fits ? a * b : ((a < 0) == (b < 0) ? INT64_MAX : INT64_MIN);
}
""",
    "floor_divide_whole": """
/* Python's // of integers, for a divisor other than 0. */
INLINE int64_t NAME_floor_divide_whole(int64_t a, int64_t b)
{
    int64_t quotient;
    if (b == -1) {
        return a == INT64_MIN ? INT64_MAX : -a;
    }
    quotient = a / b;
    return a % b != 0 && (a < 0) != (b < 0) ? quotient - 1 : quotient;
}
""",
    "modulo_whole": """
/* Python's % of integers, for a divisor other than 0. */
INLINE int64_t NAME_modulo_whole(int64_t a, int64_t b)
{
    const int64_t rest = b == -1 ? 0 : a % b;
    return rest != 0 && (rest < 0) != (b < 0) ? rest + b : rest;
}
""",
    "place": """
/* Python's index, from the end where it is negative; the nearest one that there is, otherwise. */
INLINE int64_t NAME_place(int64_t index, int64_t length)
{
    int64_t found = index < 0 ? index + length : index;
    found = found < 0 ? 0 : found;
    return found < length ? found : length - 1;
}
""",
    "whole": """
/* Integer toward 0; the nearest integer that there is, and 0 for NaN. */
INLINE int64_t NAME_whole(TYPE x)
{
    if (x >= LIMIT) {
        return INT64_MAX;
    }
    if (x < -LIMIT) {
        return INT64_MIN;
    }
    return x == x ? (int64_t)x : 0;
}
""",
    "floor": """
INLINE int64_t NAME_floor(TYPE x)
{
    const int64_t toward_0 = NAME_whole(x);
    return toward_0 > INT64_MIN && (TYPE)toward_0 > x ? toward_0 - 1 : toward_0;
}
""",
    "ceil": """
INLINE int64_t NAME_ceil(TYPE x)
{
    const int64_t toward_0 = NAME_whole(x);
    return toward_0 < INT64_MAX && (TYPE)toward_0 < x ? toward_0 + 1 : toward_0;
}
""",
    "remainder": """
/* What is left of x after it is divided by y, with the sign of x; exact. */
INLINE TYPE NAME_remainder(TYPE x, TYPE y)
{
    const TYPE size = y < ZERO ? -y : y;
    TYPE rest = x < ZERO ? -x : x;
    TYPE part = size;
    int32_t k;
    if (!(size > ZERO) || !(rest < (TYPE)INFINITY)) {
        return (TYPE)NAN;
    }
    /* Doubling and halving are exact, and so are differences of numbers within a factor of 2. */
    for (k = 0; k < 2200 && part <= rest * HALF; ++k) {
        part = part + part;
    }
    for (; k >= 0; k -= 1) {
        rest = rest >= part ? rest - part : rest;
        part = part * HALF;
    }
    return x < ZERO ? -rest : rest;
}
""",
    "modulo": """
/* Python's % of numbers: it has the sign of the divisor. */
INLINE TYPE NAME_modulo(TYPE x, TYPE y)
{
    const TYPE rest = NAME_remainder(x, y);
    if (rest == ZERO) {
        return y < ZERO ? -ZERO : ZERO;
    }
    return (rest < ZERO) == (y < ZERO) ? rest : rest + y;
}
""",
    "floor_divide": """
/* Python's // of numbers. */
INLINE TYPE NAME_floor_divide(TYPE x, TYPE y)
{
    const TYPE rest = NAME_remainder(x, y);
    TYPE quotient = (x - rest) / y;
    TYPE below;
    if (y == ZERO) {
        return x / y;
    }
    if (rest != ZERO && (rest < ZERO) != (y < ZERO)) {
        quotient = quotient - ONE;
    }
    if (quotient == ZERO) {
        /* With the sign of the exact quotient. */
        return x / y * ZERO;
    }
    /* Whole already, if it is so large, or not finite. */
    if (!(quotient < LARGE && quotient > -LARGE)) {
        return quotient;
    }
    below = (TYPE)(int64_t)quotient;
    below = below > quotient ? below - ONE : below;
    return quotient - below > HALF ? below + ONE : below;
}
""",
    "cos": """
INLINE TYPE NAME_cos(TYPE x)
{
    return NAME_circular(x, 0);
}
""",
    "sin": """
INLINE TYPE NAME_sin(TYPE x)
{
    return NAME_circular(x, 3);
}
""",
    "log": """
/* Natural logarithm. */
INLINE TYPE NAME_log(TYPE x)
{
    TYPE high;
    TYPE low;
    if (!(x > ZERO)) {
        return x == ZERO ? -(TYPE)INFINITY : (TYPE)NAN;
    }
    if (x == (TYPE)INFINITY) {
        return x;
    }
    NAME_log_parts(x, &high, &low);
    return high + low;
}
""",
}

_DOUBLE = {
    "circular": """
/* Cosine of an angle up to 1.6e6, or with quarters = 3 its sine; beyond, NaN. */
INLINE double NAME_circular(double x, int32_t quarters)
{
    int32_t k;
    double n;
    double r;
    double low;
    double y;
    double s;
    double value;
    if (!(x < 1.6e6 && x > -1.6e6)) {
        return (double)NAN;
    }
    k = (int32_t)(x * 0.6366197723675814 + (x < 0.0 ? -0.5 : 0.5));
    n = (double)k;
    /* A quarter of a turn in three parts; products with the first two are exact. */
    r = x - n * 1.5707963267341256;
    y = r - n * 6.077100506303966e-11;
    low = ((r - y) - n * 6.077100506303966e-11) - n * 2.0222662487959506e-21;
    r = y + low;
    low = (y - r) + low;
    s = r * r;
    k = (k + quarters) % 4;
    k = k < 0 ? k + 4 : k;
    if (k == 1 || k == 3) {
        value = r + (low - r * s * (1.0 / 6.0 - s * (1.0 / 120.0 - s * (1.0 / 5040.0 - s
            * (1.0 / 362880.0 - s * (1.0 / 39916800.0 - s * (1.0 / 6227020800.0 - s *
            (1.0 / 1307674368000.0 - s * (1.0 / 355687428096000.0 - s * (1.0 /
            121645100408832000.0))))))))));
    } else {
        /* What rounding takes from 1 - s/2 is given to the rest. */
        y = 1.0 - 0.5 * s;
        value = y + (((1.0 - y) - 0.5 * s) - r * low + s * s * (1.0 / 24.0 - s * (1.0 /
            720.0 - s * (1.0 / 40320.0 - s * (1.0 / 3628800.0 - s * (1.0 / 479001600.0 -
            s * (1.0 / 87178291200.0 - s * (1.0 / 20922789888000.0 - s * (1.0 /
            6402373705728000.0 - s * (1.0 / 2432902008176640000.0))))))))));
    }
    return k == 1 || k == 2 ? -value : value;
}
""",
    "sqrt": """
/* Square root, correctly rounded, digit by digit. Define FUZZYTRACK_SQRT to use that of the
   processor or of the mathematical library, which has the same bits. */
INLINE double NAME_sqrt(double x)
{
#ifdef FUZZYTRACK_SQRT
    return FUZZYTRACK_SQRT(x);
#else
    uint64_t bits;
    uint64_t digits;
    uint64_t root = 0u;
    uint64_t rest = 0u;
    int32_t exponent;
    int32_t k;
    double result;
    if (!(x > 0.0) || x == (double)INFINITY) {
        return x >= 0.0 ? x : (double)NAN;
    }
    (void)memcpy(&bits, &x, sizeof bits);
    exponent = (int32_t)(bits >> 52);
    digits = bits & UINT64_C(0xFFFFFFFFFFFFF);
    if (exponent != 0) {
        digits |= UINT64_C(0x10000000000000);
    } else {
        exponent = 1;
        for (k = 0; k < 52 && digits < UINT64_C(0x10000000000000); ++k) {
            digits <<= 1;
            exponent -= 1;
        }
    }
    /* x = digits * 2^(exponent - 1075), with an even power of 2. */
    if ((exponent & 1) == 0) {
        digits <<= 1;
        exponent -= 1;
    }
    for (k = 0; k < 54; ++k) {
        rest = (rest << 2) | (k < 27 ? (digits >> (52 - 2 * k)) & 3u : 0u);
        root <<= 1;
        if (rest > root << 1) {
            rest -= (root << 1) | 1u;
            root |= 1u;
        }
    }
    /* The last digit decides on rounding; a root is never halfway. */
    root = (root + 1u) >> 1;
    exponent = (exponent - 1075) / 2 + 1049;
    bits = ((uint64_t)exponent << 52) + (root - UINT64_C(0x10000000000000));
    (void)memcpy(&result, &bits, sizeof result);
    return result;
#endif
}
""",
    "two_to": """
/* 2 to the power of n, for -1022 <= n <= 1023. */
INLINE double NAME_two_to(int32_t n)
{
    const uint64_t bits = (uint64_t)(n + 1023) << 52;
    double result;
    (void)memcpy(&result, &bits, sizeof result);
    return result;
}
""",
    "exp": """
/* Exponential: a series over half an octave. */
INLINE double NAME_exp(double x)
{
    double n;
    double r;
    double low;
    double y;
    int32_t half;
    if (!(x < 709.79)) {
        return x >= 709.79 ? (double)INFINITY : x;
    }
    if (x < -745.2) {
        return 0.0;
    }
    half = (int32_t)(x * 1.4426950408889634 + (x < 0.0 ? -0.5 : 0.5));
    n = (double)half;
    r = x - n * 0.6931471803691238;
    low = n * 1.9082149292705877e-10;
    y = r - low;
    /* What rounding took from y. */
    low = (r - y) - low;
    y = y + (low + y * (low + y * (1.0 / 2.0 + y * (1.0 / 6.0 + y * (1.0 / 24.0 + y * (1.0 / 120.0
        + y * (1.0 / 720.0 + y * (1.0 / 5040.0 + y * (1.0 / 40320.0 + y * (1.0 / 362880.0
        + y * (1.0 / 3628800.0 + y * (1.0 / 39916800.0 + y * (1.0 / 479001600.0
        + y * (1.0 / 6227020800.0))))))))))))));
    half = half / 2;
    return (1.0 + y) * NAME_two_to(half) * NAME_two_to((int32_t)n - half);
}
""",
    "log_parts": """
/* Natural logarithm of a positive number as a sum of two numbers, the second one small. */
INLINE void NAME_log_parts(double x, double *high, double *low)
{
    uint64_t bits;
    int32_t n = 0;
    double m = x;
    double f;
    double s;
    double s_low;
    double square;
    double series;
    double start;
    double rest;
    if (m < 2.2250738585072014e-308) {
        m = m * 18014398509481984.0;
        n = -54;
    }
    (void)memcpy(&bits, &m, sizeof bits);
    n += (int32_t)(bits >> 52) - 1023;
    bits = (bits & UINT64_C(0xFFFFFFFFFFFFF)) | UINT64_C(0x3FF0000000000000);
    (void)memcpy(&m, &bits, sizeof m);
    if (m > 1.4142135623730951) {
        m = m * 0.5;
        ++n;
    }
    /* log m = 2 (s + s^3/3 + ...), s = (m - 1)/(m + 1) as a sum of two numbers: the first one has
       few digits, so that its product with a number of 27 digits is exact. */
    f = m - 1.0;
    s = (double)(float)(f / (m + 1.0));
    rest = m + 1.0;
    start = (double)(float)rest;
    s_low = ((f - s * start) - s * ((1.0 - start) + m)) / rest;
    square = (s + s_low) * (s + s_low);
    series = square * (s + s_low) * (1.0 / 3.0 + square * (1.0 / 5.0 + square * (1.0 / 7.0
        + square * (1.0 / 9.0 + square * (1.0 / 11.0 + square * (1.0 / 13.0 + square * (1.0 / 15.0
        + square * (1.0 / 17.0 + square * (1.0 / 19.0 + square * (1.0 / 21.0))))))))));
    start = (double)n * 0.6931471803691238;
    f = start + 2.0 * s;
    rest = start != 0.0 ? (start - f) + 2.0 * s : 0.0;
    rest = rest + 2.0 * (s_low + series) + (double)n * 1.9082149292705877e-10;
    *high = f + rest;
    *low = (f - *high) + rest;
}
""",
    "pow": """
/* x to the power of y; NaN for a negative x and a y that is not whole. */
INLINE double NAME_pow(double x, double y)
{
    const double size = x < 0.0 ? -x : x;
    const bool huge = y >= 9007199254740992.0 || y <= -9007199254740992.0;
    const bool even = huge || (y == y && (double)((int64_t)y / 2 * 2) == y);
    const bool whole = huge || (y == y && (double)(int64_t)y == y);
    double high;
    double low;
    double cut;
    double product;
    double rest;
    double result;
    if (y == 0.0 || x == 1.0) {
        return 1.0;
    }
    if (!(x == x && y == y) || (x < 0.0 && !whole && size < (double)INFINITY)) {
        return (double)NAN;
    }
    if (size == 0.0 || size == (double)INFINITY) {
        result = (size == 0.0) == (y < 0.0) ? (double)INFINITY : 0.0;
    } else if (size == 1.0) {
        result = 1.0;
    } else if (y == (double)INFINITY || y == -(double)INFINITY) {
        result = (size > 1.0) == (y > 0.0) ? (double)INFINITY : 0.0;
    } else {
        NAME_log_parts(size, &high, &low);
        product = y * high;
        if (product > 1000.0 || product < -1000.0) {
            result = product > 0.0 ? (double)INFINITY : 0.0;
        } else {
            /* What rounding took from the product: parts of few digits are multiplied exactly. */
            cut = (double)(float)high;
            rest = (double)(float)y;
            rest = ((rest * cut - product) + (y - rest) * cut) + y * (high - cut) + y * low;
            result = NAME_exp(product);
            result = result < (double)INFINITY ? result + result * rest : result;
        }
    }
    return (x < 0.0 || (x == 0.0 && 1.0 / x < 0.0)) && whole && !even ? -result : result;
}
""",
}

_FLOAT = {
    "circular": """
/* Cosine of an angle up to 1.6e6, or with quarters = 3 its sine; beyond, NaN. */
INLINE float NAME_circular(float x, int32_t quarters)
{
    int32_t k;
    double r;
    double s;
    double value;
    if (!(x < 1.6e6f && x > -1.6e6f)) {
        return NAN;
    }
    k = (int32_t)((double)x * 0.6366197723675814 + (x < 0.0f ? -0.5 : 0.5));
    r = ((double)x - (double)k * 1.5707963267341256) - (double)k * 6.077100506506192e-11;
    s = r * r;
    k = (k + quarters) % 4;
    k = k < 0 ? k + 4 : k;
    if (k == 1 || k == 3) {
        value = r - r * s * (1.0 / 6.0 - s * (1.0 / 120.0 - s * (1.0 / 5040.0 - s * (1.0
            / 362880.0 - s * (1.0 / 39916800.0)))));
    } else {
        value = 1.0 - s * (1.0 / 2.0 - s * (1.0 / 24.0 - s * (1.0 / 720.0 - s * (1.0 /
            40320.0 - s * (1.0 / 3628800.0 - s * (1.0 / 479001600.0))))));
    }
    return (float)(k == 1 || k == 2 ? -value : value);
}
""",
    "sqrt": """
/* Square root, correctly rounded, digit by digit. Define FUZZYTRACK_SQRT to use that of the
   processor or of the mathematical library, which has the same bits. */
INLINE float NAME_sqrt(float x)
{
#ifdef FUZZYTRACK_SQRT
    return FUZZYTRACK_SQRT(x);
#else
    uint32_t bits;
    uint32_t digits;
    uint32_t root = 0u;
    uint32_t rest = 0u;
    int32_t exponent;
    int32_t k;
    float result;
    if (!(x > 0.0f) || x == INFINITY) {
        return x >= 0.0f ? x : NAN;
    }
    (void)memcpy(&bits, &x, sizeof bits);
    exponent = (int32_t)(bits >> 23);
    digits = bits & UINT32_C(0x7FFFFF);
    if (exponent != 0) {
        digits |= UINT32_C(0x800000);
    } else {
        exponent = 1;
        for (k = 0; k < 23 && digits < UINT32_C(0x800000); ++k) {
            digits <<= 1;
            exponent -= 1;
        }
    }
    /* x = digits * 2^(exponent - 150), with an even power of 2. */
    digits <<= 1;
    exponent -= 1;
    if ((exponent & 1) != 0) {
        digits <<= 1;
        exponent -= 1;
    }
    for (k = 0; k < 25; ++k) {
        rest = (rest << 2) | (k < 13 ? (digits >> (24 - 2 * k)) & 3u : 0u);
        root <<= 1;
        if (rest > root << 1) {
            rest -= (root << 1) | 1u;
            root |= 1u;
        }
    }
    /* The last digit decides on rounding; a root is never halfway. */
    root = (root + 1u) >> 1;
    exponent = (exponent - 150) / 2 + 139;
    bits = ((uint32_t)exponent << 23) + (root - UINT32_C(0x800000));
    (void)memcpy(&result, &bits, sizeof result);
    return result;
#endif
}
""",
    "two_to": """
/* 2 to the power of n, for -126 <= n <= 127. */
INLINE float NAME_two_to(int32_t n)
{
    const uint32_t bits = (uint32_t)(n + 127) << 23;
    float result;
    (void)memcpy(&result, &bits, sizeof result);
    return result;
}
""",
    "exp": """
/* Exponential: a series over half an octave. */
INLINE float NAME_exp(float x)
{
    float n;
    float r;
    float low;
    float y;
    int32_t half;
    if (!(x < 88.73f)) {
        return x >= 88.73f ? INFINITY : x;
    }
    if (x < -104.0f) {
        return 0.0f;
    }
    half = (int32_t)(x * 1.442695f + (x < 0.0f ? -0.5f : 0.5f));
    n = (float)half;
    r = x - n * 0.693359375f;
    low = n * -2.12194440e-4f;
    y = r - low;
    /* What rounding took from y. */
    low = (r - y) - low;
    y = y + (low + y * (low + y * (1.0f / 2.0f + y * (1.0f / 6.0f + y * (1.0f / 24.0f
        + y * (1.0f / 120.0f + y * (1.0f / 720.0f + y * (1.0f / 5040.0f))))))));
    half = half / 2;
    return (1.0f + y) * NAME_two_to(half) * NAME_two_to((int32_t)n - half);
}
""",
    "log_parts": """
/* Natural logarithm of a positive number as a sum of two numbers, the second one small. */
INLINE void NAME_log_parts(float x, float *high, float *low)
{
    uint32_t bits;
    int32_t n = 0;
    float m = x;
    double s;
    double square;
    double sum;
    if (m < 1.17549435e-38f) {
        m = m * 33554432.0f;
        n = -25;
    }
    (void)memcpy(&bits, &m, sizeof bits);
    n += (int32_t)(bits >> 23) - 127;
    bits = (bits & UINT32_C(0x7FFFFF)) | UINT32_C(0x3F800000);
    (void)memcpy(&m, &bits, sizeof m);
    if (m > 1.4142135f) {
        m = m * 0.5f;
        ++n;
    }
    /* log m = 2 (s + s^3/3 + ...), s = (m - 1)/(m + 1). */
    s = ((double)m - 1.0) / ((double)m + 1.0);
    square = s * s;
    sum = (double)n * 0.6931471805599453 + 2.0 * s * (1.0 + square * (1.0 / 3.0
        + square * (1.0 / 5.0 + square * (1.0 / 7.0 + square * (1.0 / 9.0
        + square * (1.0 / 11.0 + square * (1.0 / 13.0)))))));
    *high = (float)sum;
    *low = (float)(sum - (double)*high);
}
""",
    "pow": """
/* x to the power of y; NaN for a negative x and a y that is not whole. */
INLINE float NAME_pow(float x, float y)
{
    const float size = x < 0.0f ? -x : x;
    const bool huge = y >= 16777216.0f || y <= -16777216.0f;
    const bool even = huge || (y == y && (float)((int32_t)y / 2 * 2) == y);
    const bool whole = huge || (y == y && (float)(int32_t)y == y);
    float high;
    float low;
    float result;
    double product;
    if (y == 0.0f || x == 1.0f) {
        return 1.0f;
    }
    if (!(x == x && y == y) || (x < 0.0f && !whole && size < INFINITY)) {
        return NAN;
    }
    if (size == 0.0f || size == INFINITY) {
        result = (size == 0.0f) == (y < 0.0f) ? INFINITY : 0.0f;
    } else if (size == 1.0f) {
        result = 1.0f;
    } else if (y == INFINITY || y == -INFINITY) {
        result = (size > 1.0f) == (y > 0.0f) ? INFINITY : 0.0f;
    } else {
        NAME_log_parts(size, &high, &low);
        product = (double)y * ((double)high + (double)low);
        if (product > 200.0 || product < -200.0) {
            result = product > 0.0 ? INFINITY : 0.0f;
        } else {
            high = (float)product;
            low = (float)(product - (double)high);
            result = NAME_exp(high);
            result = result < INFINITY ? result + result * low : result;
        }
    }
    return (x < 0.0f || (x == 0.0f && 1.0f / x < 0.0f)) && whole && !even ? -result : result;
}
""",
}

_WORDS = {
    "double": {
        "ZERO": "0.0", "ONE": "1.0", "HALF": "0.5",
        "LIMIT": "9223372036854775808.0", "LARGE": "4503599627370496.0",
    },
    "float": {
        "ZERO": "0.0f", "ONE": "1.0f", "HALF": "0.5f",
        "LIMIT": "9223372036854775808.0f", "LARGE": "8388608.0f",
    },
}  # fmt: skip


def arithmetic(names: Iterable[str], number: str, prefix: str) -> str:
    """Text of functions and of those that they call, each once, before it is called.

    Parameters
    ----------
    names : iterable of str
        ``sqrt``, ``exp`` and so on.
    number : {"double", "float"}
    prefix : str
        What their names begin with.
    """
    wanted: dict[str, None] = {}

    def want(name: str) -> None:
        for needed in NEEDS.get(name, ()):
            want(needed)
        wanted[name] = None

    for name in sorted(names):
        want(name)
    texts = {**_SHARED, **(_DOUBLE if number == "double" else _FLOAT)}
    text = "".join(texts[name] for name in wanted)
    words = {"INLINE": "FUZZYTRACK_INLINE", "TYPE": TYPES[number], "NAME_": f"{prefix}_"}
    words |= _WORDS[number]
    return re.sub(rf"NAME_|\b(?:{'|'.join(words)})\b", lambda found: words[found[0]], text)
