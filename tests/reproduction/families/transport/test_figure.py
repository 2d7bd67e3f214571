import numpy as np
import pytest
from reproduction.families.drawn import Points, draw, estimates, shows
from reproduction.families.transport.data import growing, measured

from gaspart.reproduction.families.transport import figure as transport


@pytest.mark.parametrize("name", ["viscosity", "conductivity"])
def test_both_forms_and_the_integrals_are_drawn(name):
    ds = measured()
    if name == "conductivity":
        ds = ds.drop_vars("bulk")
    density, running, *_ = draw(getattr(transport, name), ds).axes
    spheres = ds.isel(point=np.flatnonzero(ds["dimension"].values == 3))
    eta = spheres["packing_fraction"].values
    bulk = [Points(eta, *estimates(spheres, "bulk"))] if name == "viscosity" else []
    shows(
        density,
        Points(eta - 0.004, *estimates(spheres, "value")),
        Points(eta + 0.004, *estimates(spheres, "growth")),
        *bulk,
    )
    parts = ("time", "running", "running_error")
    series = [Points(*(spheres[key].isel(point=n) for key in parts)) for n in range(eta.size)]
    shows(running, *series)


def test_integrals_of_both_containers_are_drawn():
    ds = growing()
    rows = [ds.isel(point=n) for n in range(2)]
    late = [row.isel(lag=row["time"].values >= transport.SHOWN_FROM) for row in rows]
    axes = draw(transport.logarithmic_growth, ds).axes
    for axis, name in zip(axes, ("viscosity", "conductivity"), strict=True):
        shows(axis, *(Points(row["time"], *estimates(row, name)) for row in late))
