"""Functions in C of `fuzzytrack.interop.c99.arithmetic` that single precision has of its own."""

__all__ = ["FLOAT_FUNCTIONS"]

#: Text of each function, by its name.
FLOAT_FUNCTIONS = {
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
