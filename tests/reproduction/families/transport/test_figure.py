import numpy as np
import pytest
from reproduction.families.drawn import Points, draw, shows
from reproduction.families.transport.data import growing, measured

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


def test_integrals_of_both_containers_are_drawn_with_their_modes():
    ds = growing()
    for axis, name, label in zip(
        draw(transport.logarithmic_growth, ds).axes,
        ("viscosity", "conductivity"),
        ("eta", "lambda"),
        strict=True,
    ):
        rows = [ds.isel(point=n) for n in range(2)]
        late = [row.isel(lag=row["time"].values >= transport.SHOWN_FROM) for row in rows]
        shows(
            axis, "collisions", label,
            *[Points(f"{int(row['count'])} discs", row["time"], *estimates(row, name)) for row in late],
        )  # fmt: skip
        curves = [line.get_ydata() for line in axis.lines if line.get_label().startswith("_child")]
        for row in late:
            assert any(np.array_equal(row[f"{name}_modes"], y, equal_nan=True) for y in curves)
