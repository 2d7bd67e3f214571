"""Made-up rough and inelastic gases with known answers, in the form that `measure.granular` gives."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr
from reproduction.families.drawn import Points, column, draw, shows, varied
from reproduction.families.judged import verdicts
from reproduction.made import made

import gaspart as gp
from gaspart import theory
from gaspart.analysis.run import Run
from gaspart.reproduction.families.granular import figure, measure
from gaspart.reproduction.families.granular.claims import cooling, equipartition
from gaspart.reproduction.families.granular.measure import read


def rough(noise=1.0, rate=1.0, ratio=1.0, steady=1.0, exchange=1.0, mixed=1.0, seed=1):
    """Discs of three moments of inertia; rate, ratio and steady ratio are theirs over theory's; and
    two gases between rough walls, of the exchange and the final ratio over theory's."""
    rng = np.random.default_rng(seed)
    inertia = np.array([0.1, 0.5, 1.0])
    expected = 3.0 * inertia / (1.0 + inertia) ** 2
    s = np.tile(np.linspace(0.0, 4.0, 9), (3, 1))
    error = np.where(s > 0.0, 0.002, 0.0)
    beyond = [np.nan_to_num(theory.rough_start_excess(q, one)) for q, one in zip(inertia, s, strict=True)]
    rotation = 2.0 / 3.0 * (1.0 - np.exp(-rate * expected[:, None] * s) - beyond)
    rotation = rotation + noise * error * rng.standard_normal(s.shape)
    tangential = np.array([-0.5, 0.0, 0.5])
    theoretical = theory.rough_cooling()[:3, 3]
    wall_inertia, crossings = np.array([0.5, 0.4]), np.tile(np.linspace(0.0, 2.0, 11), (2, 1))
    pairs = zip(crossings, wall_inertia, strict=True)
    difference = np.stack([theory.rough_wall_difference(one, q) for one, q in pairs])
    return xr.Dataset({
        "collisions": (("start", "frame"), s),
        "translation": (("start", "frame"), 1.0 - 0.5 * rotation),
        "translation_error": (("start", "frame"), 0.5 * error),
        "rotation": (("start", "frame"), rotation),
        "rotation_error": (("start", "frame"), error),
        "inertia": ("start", inertia),
        "rate": ("start", expected * (rate + 0.004 * noise * rng.standard_normal(3))),
        "rate_error": ("start", 0.004 * expected),
        "equilibrium_inertia": ("equilibrium", inertia),
        "equilibrium_ratio": ("equilibrium", ratio + 0.002 * noise * rng.standard_normal(3)),
        "equilibrium_ratio_error": ("equilibrium", np.full(3, 0.002)),
        "tangential": ("cooling", tangential),
        "cooling_inertia": ("cooling", np.full(3, 0.5)),
        "steady_ratio": ("cooling", steady * theoretical),
        "wall_dimension": ("walls", np.array([2, 3])),
        "wall_inertia": ("walls", wall_inertia),
        "wall_time": (("walls", "moment"), crossings),
        "wall_translation": (("walls", "moment"), 0.5 * (1.0 + difference)),
        "wall_translation_error": (("walls", "moment"), np.full(crossings.shape, 0.002)),
        "wall_rotation": (("walls", "moment"), 0.5 * (1.0 - difference)),
        "wall_rotation_error": (("walls", "moment"), np.full(crossings.shape, 0.002)),
        "exchange": ("walls", exchange + 0.004 * noise * rng.standard_normal(2)),
        "exchange_error": ("walls", np.full(2, 0.004)),
        "exchange_freedom": ("walls", np.full(2, 31)),
        "wall_ratio": ("walls", mixed + 0.004 * noise * rng.standard_normal(2)),
        "wall_ratio_error": ("walls", np.full(2, 0.004)),
        "wall_ratio_freedom": ("walls", np.full(2, 31)),
        "steady_ratio_error": ("cooling", 0.005 * theoretical),
    })  # fmt: skip


def inelastic(rate=1.0, exponent=-2.0, clustered=True, seed=1):
    """Two gases of each dimension, and a clustering and an elastic one; rate over theory's."""
    rng = np.random.default_rng(seed)
    dimension, restitution = np.array([2, 2, 3, 3]), np.array([0.9, 0.7, 0.9, 0.7])
    expected = np.array([theory.cooling_rate(e, d) for e, d in zip(restitution, dimension, strict=True)])
    finite = 1024 * dimension / (1023 * dimension + 1)
    time = np.tile(np.linspace(0.0, 5.0, 11), (4, 1))
    s = np.tile(np.linspace(0.0, 100.0, 21), (2, 1))
    excess = np.exp(0.03 * s) if clustered else np.ones_like(s)
    return xr.Dataset(
        {
            "dimension": ("gas", dimension),
            "restitution": ("gas", restitution),
            "collisions": (("gas", "frame"), 2.0 / expected[:, None] * np.log1p(time)),
            "time": (("gas", "frame"), time),
            "temperature": (("gas", "frame"), (1.0 + time) ** -2.0),
            "temperature_error": (("gas", "frame"), np.full(time.shape, 1e-4)),
            "count": ("gas", np.full(4, 1024)),
            "rate": ("gas", finite * expected * (rate + 1e-4 * rng.standard_normal(4))),
            "rate_error": ("gas", 1e-4 * expected),
            "exponent": ("gas", exponent + 0.005 * rng.standard_normal(4)),
            "exponent_error": ("gas", np.full(4, 0.005)),
            "cluster_restitution": ("clusters", np.array([0.8, 1.0])),
            "cluster_collisions": (("clusters", "step"), s),
            "cluster_excess": (("clusters", "step"), np.stack([excess[0], np.ones(21)])),
            "cluster_excess_error": (("clusters", "step"), 0.05 * excess),
            "variance": (("clusters", "step"), 0.5 * np.stack([excess[0], np.ones(21)])),
            "variance_error": (("clusters", "step"), np.full(s.shape, 0.02)),
            "x": ("particle", rng.uniform(0.0, 20.0, 50)),
            "y": ("particle", rng.uniform(0.0, 20.0, 50)),
        },
        attrs={"side": 20.0, "radius": 0.5},
    )


# What is read of rough and inelastic runs: exactly, and what comes out of small ones.


def gas(count=256, dimension=2, packing_fraction=0.02, **scene):
    side = float((count * theory.particle_volume(dimension) / packing_fraction) ** (1 / dimension))
    inertia = {"moment_of_inertia": 0.125} if dimension == 2 else {}
    return gp.Scene(
        gp.Container((side,) * dimension, "periodic"),
        [gp.Species(count, 0.5, temperature=2.0, **inertia)],
        **scene,
    )


def test_rough_discs_share_as_theory_says(tmp_path):
    rough = gas(restitution=gp.Restitution(1.0, 1.0))
    lossy = gas(restitution=gp.Restitution(1.0, 0.5))
    points = [
        made(tmp_path, "start", rough, duration=40.0, samples=10),
        made(tmp_path, "still", rough, duration=400.0, samples=64, equilibration=60.0),
        made(tmp_path, "lossy", lossy, duration=300.0, samples=40),
    ]
    ds = measure.equipartition(points, {"steady_from": 10.0})
    assert ds["inertia"].item() == pytest.approx(0.5)
    assert ds["translation"][0, 0] == 1.0 and ds["rotation"][0, 0] == pytest.approx(0.0, abs=1e-6)
    assert abs(ds["rate"].item() - 2.0 / 3.0) < 4.0 * ds["rate_error"].item() < 0.5
    assert abs(ds["equilibrium_ratio"].item() - 1.0) < 4.0 * ds["equilibrium_ratio_error"].item() < 0.3
    assert abs(ds["steady_ratio"].item() - theory.rough_ratio(0.5, 0.5)) < 0.1
    # the energy of a gas without losses is conserved: 2 (N - 1) T_tr + N T_rot, less the drift's own
    run = read(points[0])[0]
    total = 2.0 * 255 * run.translation + 256 * run.rotation
    assert total == pytest.approx(np.full(11, total[0]), rel=2e-3)


def test_rough_walls_mix_velocity_and_spin_as_theory_says(tmp_path):
    scene = gp.Scene(
        gp.Container((4000.0, 10.0002), ("periodic", "wall")),
        [gp.Species(2048, 0.0001, mass=2.0, temperature=4.0, moment_of_inertia=0.6e-8)],
        restitution=gp.Restitution(1.0, 1.0),
    )
    ds = measure.equipartition(
        [made(tmp_path, "walls", scene, duration=18.0, samples=18)], {"steady_from": 1.0}
    )
    row = ds.isel(walls=0)
    assert float(row["wall_inertia"]) == pytest.approx(0.3)
    assert row["wall_time"][-1] == pytest.approx(18.0 * np.sqrt(2.0) / 10.0)
    assert row["wall_translation"][0] == 1.0 and row["wall_rotation"][0] == pytest.approx(0.0, abs=1e-6)
    total = row["wall_translation"] + row["wall_rotation"]
    assert total.values == pytest.approx(np.ones(19), abs=0.01)  # hardly any collisions
    for name in ("exchange", "wall_ratio"):
        assert abs(row[name] - 1.0) < 4.0 * row[f"{name}_error"] < 0.2, name


def test_between_rough_walls_the_start_must_be_maxwellian(tmp_path):
    scene = gp.Scene(
        gp.Container((40.0, 10.0), ("periodic", "wall")),
        [gp.Species(2, 0.0001, speed=1.0)],
        restitution=gp.Restitution(1.0, 1.0),
    )
    with pytest.raises(gp.SceneError, match="temperature"):
        measure.equipartition([made(tmp_path, "walls", scene, duration=1.0, samples=1)], {"steady_from": 1.0})


def test_an_inelastic_gas_cools_as_haff_says_and_the_number_variance_is_counted(tmp_path):
    points = [
        made(tmp_path, "haff", gas(restitution=gp.Restitution(0.8)), duration=200.0, samples=16),
        made(
            tmp_path,
            "dense",
            gas(packing_fraction=0.2, restitution=gp.Restitution(0.9)),
            duration=9.0,
            samples=3,
        ),
    ]
    ds = measure.cooling(points, {"clustering": ["dense"], "cells_per_side": 4})
    assert abs(ds["rate"].item() - theory.cooling_rate(0.8, 2)) < 4.0 * ds["rate_error"].item() < 0.05
    assert abs(ds["exponent"].item() + 2.0) < 0.15
    assert ds.sizes["particle"] == 256 and ds.attrs["side"] > 0.0
    assert ds["cluster_excess"].values == pytest.approx(np.ones((1, 4)), rel=0.1)
    assert np.all((ds["variance"].values > 0.1) & (ds["variance"].values < 1.0))


def test_number_variance_of_equal_cells_is_zero_and_of_one_cell_is_largest():
    import xarray as xr

    scene = gp.Scene(gp.Container((4.0, 4.0), "periodic"), [gp.Species(8, 0.1)])
    even = np.array([[x + 0.5, y + 0.5] for x in (0, 1) for y in (0, 1)] * 2)
    frames = np.stack([2.0 * even, np.full((8, 2), 4.0)])  # the last on the upper boundary
    positions = xr.Dataset({"coordinates": (("frame", "atom", "spatial"), frames)})
    assert measure._number_variance(Run(scene, np.arange(2.0), positions), 2) == pytest.approx([0.0, 6.0])


def test_right_data_agree():
    assert verdicts(equipartition(rough())) == {"agrees"}
    assert verdicts(cooling(inelastic())) == {"agrees"}


def test_a_rate_that_does_not_show_the_cumulant_is_inconclusive():
    gases = inelastic()
    gases["rate_error"] = 10.0 * gases["rate_error"]
    undecided = [claim.claim for claim in cooling(gases) if not claim.has_power]
    assert len(undecided) == 2 and all(
        "restitution 0.7" in text for text in undecided
    )  # it is nearly 0 there


@pytest.mark.parametrize(
    ("wrong", "beginning"),
    [
        ({"rate": 1.04}, "initial decay"),
        ({"rate": 1.2}, "T_tr - T_rot minus"),
        ({"ratio": 1.02}, "T_rot / T_tr of rough discs"),
        ({"steady": 0.85}, "T_rot / T_tr of cooling discs"),
        ({"exchange": 0.97}, "energy that the first hits turn into spin"),
        ({"mixed": 1.03}, "T_rot / T_tr along the walls"),
    ],
)
def test_wrong_shares_are_found(wrong, beginning):
    assert "disagrees" in verdicts(equipartition(rough(**wrong)), beginning)


def test_a_gas_with_fewer_frames_than_another_is_judged_too():
    gases = rough()
    frames = gases.sizes["frame"]
    longer = gases.pad(frame=(0, 2))  # as beside one with two more
    assert longer.sizes["frame"] == frames + 2
    assert verdicts(equipartition(longer)) == {"agrees"}


def test_wrong_cooling_is_found():
    assert "disagrees" in verdicts(cooling(inelastic(rate=1.03)), "-d ln T")
    assert "disagrees" in verdicts(cooling(inelastic(exponent=-1.9)), "exponent")
    assert verdicts(cooling(inelastic(clustered=False)), "ln of variance") == {"disagrees"}
    assert verdicts(cooling(inelastic(clustered=False)), "ln of T over") == {"disagrees"}


def test_temperatures_differences_and_steady_ratios():
    ds = varied(rough(), "equilibrium_inertia", "cooling_inertia", "inertia", "wall_inertia")
    both, difference, ratio, walls = draw(figure.equipartition, ds).axes
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
    haff, rates, leaving, picture = draw(figure.cooling, ds).axes
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
