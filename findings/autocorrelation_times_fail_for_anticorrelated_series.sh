#!/usr/bin/env bash
# Integrated autocorrelation times of three packages are negative, cut at 1, or several times too large.
#
# Usual guess: for a stationary series of known correlations, such as those of a flux that alternates or of
# an order parameter that oscillates, all give the sum over the autocorrelation function.
#
# What happens: where neighbours are anticorrelated, emcee's window ends too early and the time can be
# negative; pymbar's statistical inefficiency is never below 1. Where the correlation oscillates, pymbar and
# arviz sum up to its first zero and give several times the exact time. Error bars of a mean then are
# imaginary, 4 times or 2 times too large.
#
# Way out: block averages with enough blocks, or an autoregressive fit; test with a series of known time.
#
# Seen with emcee 3.1.6, pymbar 4.0.3, arviz 0.23.4, numpy 2.4.6 (samples per independent sample):
#
#     series            exact   emcee  pymbar   arviz
#     AR(1), -0.9      0.0526   -0.80    1.00    0.23
#     AR(2), period 50   4.98    4.74   16.90   16.90
set -euo pipefail

packages=(emcee==3.1.6 pymbar==4.0.3 arviz==0.23.4 scipy==1.17.1 numpy==2.4.6)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder"
"$folder/bin/python" -m pip --disable-pip-version-check install --quiet --no-compile "${packages[@]}"
cd "$folder"
PATH=$folder/bin:$PATH python - <<'PYTHON'
import logging
import warnings

import numpy as np
from scipy.signal import lfilter

logging.disable(logging.WARNING)
warnings.simplefilter("ignore")
import arviz
import emcee
from pymbar.timeseries import statistical_inefficiency

COUNT = 20000
random = np.random.default_rng(1)


def times(coefficients, discarded):
    """Mean time of ten series by each package."""
    noise = random.normal(size=(10, COUNT + discarded))
    series = lfilter([1.0], [1.0, *(-c for c in coefficients)], noise)[:, discarded:]
    found = [
        (
            emcee.autocorr.integrated_time(one, quiet=True)[0],
            statistical_inefficiency(one),
            one.size / float(arviz.ess(one[None], method="mean")),
        )
        for one in series
    ]
    return np.mean(found, axis=0)


decay, angle = 0.98, 2.0 * np.pi / 50
a, b = 2.0 * decay * np.cos(angle), -(decay**2)
variance = (1.0 - b) / ((1.0 + b) * ((1.0 - b) ** 2 - a**2))
alternating, oscillating = times([-0.9], 500), times([a, b], 4000)
print("series            exact   emcee  pymbar   arviz")
print(f"AR(1), -0.9      {0.1 / 1.9:6.4f}", *(f"{one:7.2f}" for one in alternating))
print(f"AR(2), period 50 {1 / (1 - a - b) ** 2 / variance:6.2f}", *(f"{one:7.2f}" for one in oscillating))
right = alternating[0] < 0.0 and alternating[1] == 1.0 and alternating[2] > 0.15
assert right and oscillating[1] > 12.0 and oscillating[2] > 12.0, "the behaviour has changed"
PYTHON
