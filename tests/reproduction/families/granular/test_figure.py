import numpy as np
import pytest
from reproduction.families.drawn import Points, column, draw, follows, line, lines, obeys, shows, varied
from reproduction.families.granular.data import inelastic, rough

from gaspart import theory
from gaspart.reproduction.families.granular import figure as granular


def test_temperatures_differences_and_steady_ratios():
    ds = varied(rough(), "equilibrium_inertia", "cooling_inertia", "inertia", "wall_inertia")
    both, difference, ratio, walls = draw(granular.equipartition, ds).axes
    temperatures, differences, ratios = [], [], []
    for k in range(ds.sizes["start"]):
        row = ds.isel(start=k)
        q = float(row["inertia"])
        temperatures += [
            column(row, f"$q={q:g}$", "collisions", "translation"),
            column(row, None, "collisions", "rotation"),
        ]
        decay = np.exp(-3.0 * q / (1.0 + q) ** 2 * row["collisions"])
        deviation = 100.0 * (row["translation"] - row["rotation"] - decay)
        differences.append(Points(None, row["collisions"], deviation, 150.0 * row["rotation_error"]))
        cooled = ds.isel(cooling=(ds["cooling_inertia"] == q).values)
        still = ds.isel(equilibrium=[k]).assign(elastic=("equilibrium", [1.0]))
        ratios += [
            column(cooled, None, "tangential", "steady_ratio"),
            column(still, None, "elastic", "equilibrium_ratio"),
        ]
    shows(both, "", "T_\\mathrm{tr}", *temperatures)
    shows(difference, "collisions per particle", "minus theory", *differences)
    shows(ratio, "tangential restitution", "steady", *ratios)
    mixing = []
    for k, name in enumerate(("discs, $q=0.5$", "spheres, $q=0.4$")):
        row = ds.isel(walls=k)
        mixing += [
            column(row, name, "wall_time", "wall_translation"),
            column(row, None, "wall_time", "wall_rotation"),
        ]
    shows(walls, "rough walls", "parallel", *mixing)
    obeys(lines(walls)[3], lambda t: 0.5 - 0.5 * theory.rough_wall_difference(t, 0.4))
    obeys(lines(both)[1], lambda s: theory.rough_temperatures(s, 0.1, 1.0)[1])
    obeys(line(ratio, "q=0.5"), lambda x: np.array([theory.rough_ratio(0.5, e) for e in x]))


def test_cooling_rates_clusters_and_their_picture():
    ds = varied(inelastic(), "cluster_restitution")
    haff, rates, leaving, picture = draw(granular.cooling, ds).axes
    gases = []
    for dimension, name in ((2, "discs"), (3, "spheres")):
        own = ds.isel(gas=(ds["dimension"] == dimension).values).sortby("restitution", ascending=False)
        for k in range(own.sizes["gas"]):
            row = own.isel(gas=k)
            since = 1.0 + row["time"]
            ratio, error = (row[name] * since**2 for name in ("temperature", "temperature_error"))
            gases.append(Points(name, since, ratio, error))
    shows(haff, "t_\\mathrm{H}", "Haff", *gases)
    expected = []
    for dimension, name in ((2, "discs"), (3, "spheres")):
        own = ds.isel(gas=(ds["dimension"] == dimension).values)
        unit = (1.0 - own["restitution"] ** 2) / dimension
        expected.append(Points(name, own["restitution"], own["rate"] / unit, own["rate_error"] / unit))
    shows(rates, "restitution", "ln T", *expected)
    obeys(lines(rates)[1], lambda e: 1.0 + 0.25 * theory.fourth_cumulant(e, 3))
    row, elastic = ds.isel(clusters=0), ds.isel(clusters=1)
    lost = (1.0 - 0.8**2) * row["cluster_collisions"]
    usual = float(elastic["variance"][1:].mean())
    variance = Points("variance", lost, row["variance"] / usual, row["variance_error"] / usual, some=True)
    shows(leaving, "epsilon^2", "homogeneous", variance)
    follows(line(leaving, "Haff"), lost, row["cluster_excess"])
    (discs,) = picture.collections
    assert discs.get_offsets() == pytest.approx(np.stack([ds["x"], ds["y"]], axis=1))
    assert "epsilon=0.8$" in picture.get_title(loc="left")
    assert picture.get_xlim() == picture.get_ylim() == (0.0, ds.attrs["side"])
