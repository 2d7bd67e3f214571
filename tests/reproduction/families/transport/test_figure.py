import numpy as np
import pytest
from reproduction.families.drawn import Points, draw, shows
from reproduction.families.transport.data import measured

from gaspart.reproduction.families.shared.rows import estimates
from gaspart.reproduction.families.transport import figure as transport


@pytest.mark.parametrize("name", ["viscosity", "conductivity"])
def test_both_forms_and_the_integrals_are_drawn(name):
    ds = measured()
    if name == "conductivity":
        ds = ds.drop_vars("bulk")
    density, running, *_ = draw(getattr(transport, name), ds).axes
    spheres = ds.isel(point=np.flatnonzero(ds["dimension"].values == 3))
    eta = spheres["packing_fraction"].values
    bulk = [Points("bulk", eta, *estimates(spheres, "bulk"))] if name == "viscosity" else []
    shows(
        density, "packing fraction", "spheres",
        Points("Green-Kubo", eta - 0.004, *estimates(spheres, "value")),
        Points("Helfand", eta + 0.004, *estimates(spheres, "growth")),
        *bulk,
    )  # fmt: skip
    parts = ("time", "running", "running_error")
    series = [
        Points(f"{float(one):.3g}", *(spheres[key].isel(point=n) for key in parts))
        for n, one in enumerate(eta)
    ]
    shows(running, "collisions", "spheres", *series)
