import numpy as np
from reproduction.families.drawn import Points, draw, estimates, shows
from reproduction.families.dsmc.data import measured

from gaspart.reproduction.families.dsmc.figure import dsmc_convergence
from gaspart.theory.dsmc import cell_factor


def of(ds, part):
    return ds.isel(point=np.flatnonzero(ds["part"].values == part))


def test_plates_and_dense_gases_and_coefficients_without_the_effect_of_the_other_coarseness():
    ds = measured()
    _, steps, plates, dense = draw(dsmc_convergence, ds).axes
    event, own = of(ds, "event_plates"), of(ds, "plates")
    shows(
        plates,
        Points(event["knudsen"], *estimates(event, "flux")),
        Points(own["knudsen"], *estimates(own, "flux")),
    )
    spheres, model = of(ds, "event_paths"), of(ds, "dense")
    eta = model["packing_fraction"].values
    shows(
        dense,
        Points(eta - 0.004, *estimates(model, "excess")),
        Points(eta, *estimates(model, "rate")),
        Points(eta + 0.004, *estimates(model, "diffusion")),
        Points(spheres["packing_fraction"], *estimates(spheres, "diffusion")),
    )
    fine = ds.isel(point=np.flatnonzero(np.isfinite(ds["viscosity"].values) & (ds["width"].values < 0.3)))
    container = next(one for one in steps.containers if one.get_label() == "viscosity")
    x, y = container.lines[0].get_data()
    assert np.allclose(x, fine["step"])
    assert np.allclose(y, fine["viscosity"] / cell_factor("viscosity", fine["width"].values))
