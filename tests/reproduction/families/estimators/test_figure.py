from reproduction.families.drawn import column, draw, shows
from reproduction.families.estimators.data import measured

from gaspart.reproduction.families.estimators.figure import estimators


def test_gains_are_drawn_against_the_packing_fraction():
    ds = measured()
    everywhere, walls, pressure = draw(estimators, ds).axes
    for axis, name in ((everywhere, "mixture"), (walls, "at_walls")):
        rows = ds.isel(case=[0, 2]), ds.isel(case=[1, 3])
        shows(axis, *(column(row, "packing_fraction", name) for row in rows))
    shows(pressure, column(ds.isel(case=[0, 2]), "packing_fraction", "pressure"))
