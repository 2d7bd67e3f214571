from reproduction.families.drawn import Points, column, draw, follows, lines, shows, varied
from reproduction.families.reversibility.data import measurement

from gaspart.reproduction.families.reversibility.figure import reversibility


def test_echoes_growth_and_memory(tmp_path):
    ds = varied(measurement(tmp_path), "packing_fraction")
    echoes, growth, memory = draw(reversibility, ds).axes
    for n, one in enumerate(lines(echoes)[:2]):
        follows(one, ds["collisions"][n], ds["echo"][n])
    exact, steps = ds.isel(row=[0]), ds.isel(row=[1])
    shifted = exact.assign(place=1.12 * exact["packing_fraction"])
    shows(
        growth,
        column(exact, "packing_fraction", "growth"),
        column(shifted, "place", "divergence"),
        column(exact, "packing_fraction", "exponent"),
    )
    nothing = Points([], [], [])
    both = (column(one, "packing_fraction", "memory") for one in (exact, steps))
    shows(memory, nothing, next(both), nothing, next(both), nothing, nothing)
