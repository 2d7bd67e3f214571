import numpy as np
import pytest
from reproduction.families.drawn import Points, draw, shows, varied
from reproduction.families.virial.data import equation_of_state

from gaspart.reproduction.families.virial import figure as virial

DRAW = {2: virial.virial_discs, 3: virial.virial_spheres}


@pytest.mark.parametrize("dimension", [2, 3])
def test_z_its_residuals_and_the_coefficients(dimension):
    ds = varied(equation_of_state(dimension), "up_to")
    state, residuals, coefficients = draw(DRAW[dimension], ds).axes
    eta = ds["packing_fraction"]
    shows(state, Points(eta, ds["Z"]))
    error = 100.0 * np.hypot(ds["Z_error"], ds["reference_error"]) / ds["reference"]
    shows(residuals, Points(eta, 100.0 * (ds["Z"] / ds["reference"] - 1.0), error))
    fitted = []
    for k, (order, scale) in enumerate({2: 1e-3, 3: 1e-2, 4: 1e-1}.items()):
        at = ds.sel(order=order)
        unit = scale * float(at["exact"])
        error = np.hypot(at["coefficient_error"], at["held_error"]) / unit
        fitted.append(Points(np.arange(3) + 0.22 * (k - 1), (at["coefficient"] - at["exact"]) / unit, error))
    shows(coefficients, *fitted)
    *_, coefficients = draw(DRAW[dimension], ds.isel(fit=slice(0, 0))).axes  # without fits
    shows(coefficients, *[Points([], [], [])] * 3)
