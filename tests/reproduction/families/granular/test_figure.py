import numpy as np
import pytest
from reproduction.families.drawn import Points, column, draw, shows, varied
from reproduction.families.granular.data import inelastic, rough

from gaspart.reproduction.families.granular import figure as granular


def test_temperatures_differences_and_steady_ratios():
    ds = varied(rough(), "equilibrium_inertia", "cooling_inertia", "inertia", "wall_inertia")
    both, difference, ratio, walls = draw(granular.equipartition, ds).axes
    temperatures, differences, ratios = [], [], []
    for k in range(ds.sizes["start"]):
        row = ds.isel(start=k)
        q = float(row["inertia"])
        temperatures += [column(row, "collisions", "translation"), column(row, "collisions", "rotation")]
        decay = np.exp(-3.0 * q / (1.0 + q) ** 2 * row["collisions"])
        deviation = 100.0 * (row["translation"] - row["rotation"] - decay)
        differences.append(Points(row["collisions"], deviation, 150.0 * row["rotation_error"]))
        cooled = ds.isel(cooling=(ds["cooling_inertia"] == q).values)
        still = ds.isel(equilibrium=[k]).assign(elastic=("equilibrium", [1.0]))
        ratios += [
            column(cooled, "tangential", "steady_ratio"),
            column(still, "elastic", "equilibrium_ratio"),
        ]
    shows(both, *temperatures)
    shows(difference, *differences)
    shows(ratio, *ratios)
    mixing = []
    for k in range(2):
        row = ds.isel(walls=k)
        mixing += [column(row, "wall_time", "wall_translation"), column(row, "wall_time", "wall_rotation")]
    shows(walls, *mixing)


def test_cooling_rates_clusters_and_their_picture():
    ds = varied(inelastic(), "cluster_restitution")
    haff, rates, leaving, picture = draw(granular.cooling, ds).axes
    gases = []
    for dimension in (2, 3):
        own = ds.isel(gas=(ds["dimension"] == dimension).values).sortby("restitution", ascending=False)
        for k in range(own.sizes["gas"]):
            row = own.isel(gas=k)
            since = 1.0 + row["time"]
            ratio, error = (row[name] * since**2 for name in ("temperature", "temperature_error"))
            gases.append(Points(since, ratio, error))
    shows(haff, *gases)
    expected = []
    for dimension in (2, 3):
        own = ds.isel(gas=(ds["dimension"] == dimension).values)
        unit = (1.0 - own["restitution"] ** 2) / dimension
        expected.append(Points(own["restitution"], own["rate"] / unit, own["rate_error"] / unit))
    shows(rates, *expected)
    row, elastic = ds.isel(clusters=0), ds.isel(clusters=1)
    lost = (1.0 - 0.8**2) * row["cluster_collisions"]
    usual = float(elastic["variance"][1:].mean())
    shows(leaving, Points(lost, row["variance"] / usual, row["variance_error"] / usual, some=True))
    (discs,) = picture.collections
    assert discs.get_offsets() == pytest.approx(np.stack([ds["x"], ds["y"]], axis=1))
