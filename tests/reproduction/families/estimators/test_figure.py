import numpy as np
from reproduction.families.drawn import Points, draw, shows
from reproduction.families.estimators.data import measured

from gaspart.reproduction.families.estimators.figure import estimators


def test_gains_are_drawn_against_the_packing_fraction():
    ds = measured()
    everywhere, walls = draw(estimators, ds).axes
    for axis, name in ((everywhere, "mixture"), (walls, "at_walls")):
        rows = [ds.isel(case=[0, 2]), ds.isel(case=[1, 3])]
        points = [
            Points(
                f"bins of {width:g} diameters",
                row["packing_fraction"],
                row[name],
                np.asarray(row[f"{name}_error"]),
            )
            for width, row in zip((0.1, 0.5), rows, strict=True)
        ]
        shows(axis, "packing fraction", "variance ratio", *points)
