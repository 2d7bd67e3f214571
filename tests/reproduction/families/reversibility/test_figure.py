from reproduction.families.drawn import Points, column, draw, follows, lines, shows, varied
from reproduction.families.reversibility.data import measurement

from gaspart.reproduction.families.reversibility.figure import reversibility


def test_echoes_growth_and_memory(tmp_path):
    ds = varied(measurement(tmp_path), "packing_fraction")
    echoes, growth, memory = draw(reversibility, ds).axes
    assert "collisions" in echoes.get_xlabel() and "echo" in echoes.get_ylabel()
    drawn = lines(echoes)
    assert [one.get_label() for one in drawn[2:]] == ["event-driven", "time-stepped", "time-stepped, float32"]
    for n, one in enumerate(drawn[:2]):
        row = ds.isel(row=n)
        follows(one, row["collisions"], row["echo"])
        assert one.get_linestyle() == {"event": "-", "step": "--"}[row["engine"].item()]
    exact, steps = ds.isel(row=[0]), ds.isel(row=[1])
    shifted = exact.assign(place=1.12 * exact["packing_fraction"])
    shows(
        growth, "packing fraction", "growth",
        column(exact, "spheres, echo", "packing_fraction", "growth"),
        column(shifted, "spheres, two runs", "place", "divergence"),
        column(exact, "tangent space", "packing_fraction", "exponent"),
    )  # fmt: skip
    nothing = Points(None, [], [], [])
    shows(
        memory, "packing fraction", "memory",
        nothing, column(exact, "event-driven", "packing_fraction", "memory"),
        nothing, column(steps, "time-stepped", "packing_fraction", "memory"),
        nothing, Points("float32", [], [], []),
    )  # fmt: skip
