import numpy as np
from reproduction.families.drawn import Points, draw, line, lines, obeys, shows
from reproduction.families.dsmc.data import measured

from gaspart import theory
from gaspart.reproduction.families.dsmc.figure import dsmc_convergence
from gaspart.reproduction.families.shared.rows import estimates
from gaspart.theory.dsmc import cell_factor, step_factor


def of(ds, part):
    return ds.isel(point=np.flatnonzero(ds["part"].values == part))


def test_dense_gases_and_plates_are_drawn_as_measured():
    ds = measured()
    _, _, plates, dense = draw(dsmc_convergence, ds).axes
    event, own = of(ds, "event_plates"), of(ds, "plates")
    shows(
        plates, "Knudsen", "flux",
        Points("event-driven", event["knudsen"], *estimates(event, "flux")),
        Points("DSMC", own["knudsen"], *estimates(own, "flux")),
    )  # fmt: skip
    obeys(line(dense, "Erpenbeck"), theory.erpenbeck_wood_ratio)
    spheres, model = of(ds, "event_paths"), of(ds, "dense")
    eta = model["packing_fraction"].values
    shows(
        dense, "packing fraction", "Enskog",
        Points("Z-1", eta - 0.004, *estimates(model, "excess")),
        Points("collision rate", eta, *estimates(model, "rate")),
        Points("diffusion, DSMC", eta + 0.004, *estimates(model, "diffusion")),
        Points("diffusion, event", spheres["packing_fraction"], *estimates(spheres, "diffusion")),
    )  # fmt: skip


def test_coefficients_are_drawn_without_the_effect_of_the_other_coarseness():
    ds = measured()
    cells, steps, *_ = draw(dsmc_convergence, ds).axes
    obeys(lines(cells)[0], lambda width: cell_factor("viscosity", width))
    obeys(lines(steps)[0], lambda step: step_factor("viscosity", step))
    fine = ds.isel(point=np.flatnonzero(np.isfinite(ds["viscosity"].values) & (ds["width"].values < 0.3)))
    container = next(one for one in steps.containers if one.get_label() == "viscosity")
    x, y = container.lines[0].get_data()
    assert np.allclose(x, fine["step"])
    assert np.allclose(y, fine["viscosity"] / cell_factor("viscosity", fine["width"].values))
