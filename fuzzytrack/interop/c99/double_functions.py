"""Functions in C of `fuzzytrack.interop.c99.arithmetic` that double precision has of its own."""

__all__ = ["DOUBLE_FUNCTIONS"]

#: Text of each function, by its name.
DOUBLE_FUNCTIONS = {
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
