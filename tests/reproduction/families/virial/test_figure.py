import numpy as np
import pytest
from reproduction.families.drawn import Points, draw, follows, line, lines, obeys, shows, varied
from reproduction.families.virial.data import equation_of_state

from gaspart import theory
from gaspart.reproduction.families.virial import figure as virial

DRAW = {2: virial.virial_discs, 3: virial.virial_spheres}
LABELS = {
    2: {"tail": lambda x: theory.compressibility_factor(x, 2), "Henderson": theory.henderson},
    3: {"Starling": theory.carnahan_starling, "1986": theory.kolafa_1986},
}


@pytest.mark.parametrize("dimension", [2, 3])
def test_z_its_residuals_and_the_coefficients(dimension):
    ds = varied(equation_of_state(dimension), "up_to")
    state, residuals, coefficients = draw(DRAW[dimension], ds).axes
    eta = ds["packing_fraction"]
    shows(state, "", "compressibility", Points("measured", eta, ds["Z"]))
    for label, curve in LABELS[dimension].items():
        obeys(line(state, label), curve)
    error = 100.0 * np.hypot(ds["Z_error"], ds["reference_error"]) / ds["reference"]
    ratio = Points(None, eta, 100.0 * (ds["Z"] / ds["reference"] - 1.0), error)
    shows(residuals, "packing fraction", "ref", ratio)
    name = "Henderson" if dimension == 2 else "1986"
    curve = lines(residuals)[-1]
    x = curve.get_xdata()
    reference = theory.compressibility_factor(x, dimension)
    follows(curve, x, 100.0 * (LABELS[dimension][name](x) / reference - 1.0))
    fitted = []
    for k, (order, scale) in enumerate({2: 1e-3, 3: 1e-2, 4: 1e-1}.items()):
        at = ds.sel(order=order)
        unit = scale * float(at["exact"])
        fitted.append(
            Points(
                f"B_{order}", np.arange(3) + 0.22 * (k - 1), (at["coefficient"] - at["exact"]) / unit,
                np.hypot(at["coefficient_error"], at["held_error"]) / unit,
            )
        )  # fmt: skip
    shows(coefficients, "free coefficients", "deviation", *fitted)
    names = [label.get_text() for label in coefficients.get_xticklabels()]
    assert names[0] == "$B_2$–$B_4$\n$\\leq$0.35\nheld" and names[2].endswith("0.2\nzero")


def test_it_draws_without_fits():
    axes = draw(virial.virial_discs, equation_of_state(2).isel(fit=slice(0, 0))).axes
    shows(axes[2], "free", "deviation", *(Points(f"B_{order}", [], [], []) for order in (2, 3, 4)))
