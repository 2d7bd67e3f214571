"""Sine and cosine with the same bits on every machine.

Both functions are computed with only +, -, x and /.
"""

from math import floor

from gaspart.kernels.compile.policy import helper

TURN = 6.283185307179586
SINE_SERIES = (
    1.0, -1.0 / 6.0, 1.0 / 120.0, -1.0 / 5040.0, 1.0 / 362880.0, -1.0 / 39916800.0, 1.0 / 6227020800.0,
    -1.0 / 1307674368000.0,
)  # fmt: skip
COSINE_SERIES = (
    1.0, -1.0 / 2.0, 1.0 / 24.0, -1.0 / 720.0, 1.0 / 40320.0, -1.0 / 3628800.0, 1.0 / 479001600.0,
    -1.0 / 87178291200.0, 1.0 / 20922789888000.0,
)  # fmt: skip
"""Coefficients of the series in even powers. The series of the sine must be multiplied by x.

Within an eighth of a turn around 0 the truncation error is below 1e-16.
"""


@helper
def sine_cosine(turns):
    """Compute sin and cos of 2 pi turns, to 3e-16, relative to the nearest quarter of a turn."""
    quarter = floor(4.0 * turns + 0.5)
    x = TURN * (turns - 0.25 * quarter)
    square = x * x
    sine = cosine = 0.0
    for n in range(len(SINE_SERIES) - 1, -1, -1):
        sine = sine * square + SINE_SERIES[n]
    for n in range(len(COSINE_SERIES) - 1, -1, -1):
        cosine = cosine * square + COSINE_SERIES[n]
    sine = sine * x
    which = quarter - 4.0 * floor(0.25 * quarter)
    if which == 0.0:
        return sine, cosine
    if which == 1.0:
        return cosine, -sine
    if which == 2.0:
        return -sine, -cosine
    return -cosine, sine
