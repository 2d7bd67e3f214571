#!/usr/bin/env bash
# scipy.optimize.curve_fit returns its starting values where one error is NaN or 0.
#
# Usual guess: ValueError, because check_finite is True, or at least a warning that names the error.
#
# What happens: check_finite looks at x and y, not at sigma. One NaN, or one 0, spoils all residuals: the
# parameters come back as they were given. The covariance is infinite, with a warning about the covariance
# only. Where the start is a textbook value, a figure then "agrees" with it.
#
# Way out: refuse errors that are not positive before the fit.
#
# Seen with scipy 1.17.1 (the right values are 3 and 1, the start 1 and 2):
#
#     error 0.01  [3.0, 1.0]
#     error nan   [1.0, 2.0]
#     error 0.0   [1.0, 2.0]
set -euo pipefail

packages=(scipy==1.17.1 numpy==2.4.6)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder"
"$folder/bin/python" -m pip --disable-pip-version-check install --quiet --no-compile "${packages[@]}"
cd "$folder"
PATH=$folder/bin:$PATH python - <<'PYTHON'
import warnings

import numpy as np
from scipy.optimize import curve_fit


def law(x, amplitude, rate):
    return amplitude * np.exp(-rate * x)


x, start, found = np.linspace(0.1, 2.0, 20), [1.0, 2.0], []
for error in (0.01, np.nan, 0.0):
    errors = np.full(20, 0.01)
    errors[7] = error
    with warnings.catch_warnings(action="ignore"):
        values, _ = curve_fit(law, x, 3.0 * np.exp(-x), start, sigma=errors, absolute_sigma=True)
    found.append(values.tolist())
    print(f"error {error:<5} ", found[-1])
assert np.allclose(found[0], [3.0, 1.0])
assert found[1] == found[2] == start, "the behaviour has changed"
PYTHON
