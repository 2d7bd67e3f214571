#!/usr/bin/env bash
# On a logarithmic axis of matplotlib, one error bar that reaches below 0 cuts the lower ends of the others.
#
# Usual guess: the bar below 0 is clipped at the axis, and the automatic limits show the ends of the other
# bars.
#
# What happens: with one lower end at or below 0, the limits are chosen by the values alone. The bar of the
# point 0.02 +- 0.019, which ends at 0.001, is cut at 0.0155; it seems to be a fifth as long downwards.
#
# Way out: set the lower limit to the smallest positive end.
#
# Seen with matplotlib 3.11.2:
#
#     lower limit 0.000667 without the bar, 0.0155 with it
set -euo pipefail

packages=(matplotlib==3.11.2)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder"
"$folder/bin/python" -m pip --disable-pip-version-check install --quiet --no-compile "${packages[@]}"
cd "$folder"
PATH=$folder/bin:$PATH python - <<'PYTHON'
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

values, errors, limits = [1.0, 0.5, 0.02, 3.0], [0.2, 0.1, 0.019, 0.3], []
for more in ([], [(0.3, 0.4)]):
    figure, axis = plt.subplots()
    y, error = values + [one for one, _ in more], errors + [one for _, one in more]
    axis.errorbar(range(len(y)), y, error)
    axis.set_yscale("log")
    figure.canvas.draw()
    limits.append(axis.get_ylim()[0])
print(f"lower limit {limits[0]:.3g} without the bar, {limits[1]:.3g} with it")
assert limits[0] < 0.001 < 0.01 < limits[1], "the behaviour has changed"
PYTHON
