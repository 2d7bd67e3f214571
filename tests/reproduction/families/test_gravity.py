"""Made-up points, stretches and measurements of gases under gravity, with known answers."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from reproduction.claims.data import about, judged
from reproduction.families.drawn import Points, column, draw, shows, varied
from reproduction.families.stored import runs_of

import gaspart as gp
from gaspart.reproduction.families.gravity import claims, figure, measure
from gaspart.reproduction.families.gravity.measure import INNER
from gaspart.reproduction.families.shared import columns
from gaspart.reproduction.families.shared.columns import Field, Stretch
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import table
from gaspart.theory import gravity
from gaspart.theory.gravity import ideal_profile


def point(scene_file, **settings):
    """One point of a grid that has a scene file; nothing of it is run."""
    settings = {"scene": str(scene_file), "duration": 40.0, "samples": 20, "equilibration": 10.0} | settings
    return Point("column", "single", "simulate", settings, "results/points", 1)


def ideal_column(rng, frames, masses, height=4.0, width=3.0, strength=1.0, temperature=1.0):
    """An ideal gas: its field, and a stretch of independent frames of it."""
    masses = np.asarray(masses, dtype=float)
    weights = masses * strength / temperature
    chance = rng.random((frames, masses.size)) * -np.expm1(-weights * height)
    heights = -np.log1p(-chance) / weights
    across = width * rng.random(heights.shape)
    energies = temperature * rng.exponential(size=heights.shape)
    ceiling = temperature * sum(
        gravity.ideal_profile(height, height, weight) for weight in weights
    )  # the pressure there times the width
    place = Field(strength, width, height, 0.01, masses, (masses > masses.min()).astype(int), False)
    floor = float(ceiling + place.weight)
    return place, Stretch(
        np.stack([across, heights], axis=-1), energies, floor, float(ceiling), 0.0, temperature
    )


def profiles(kinds=1, error=0.002):
    """What `measure.gravity.profiles` gives of a dilute and a dense column if theory is right."""
    bins, top, strength, masses = 30, 60.0, 0.05, np.array([1.0, 3.0])[:kinds]
    height = (np.arange(bins) + 0.5) * top / bins
    line, of_bin, of_species = -2.0 * strength * height, np.ones(bins), np.ones(kinds)

    def column(stated):
        name, number, range_ratio = stated
        density = gravity.hydrostatic_profiles(height, [number / kinds] * kinds, masses * strength, 2)
        values = {
            "packing_fraction": density.sum(axis=0) * np.pi / 4.0,
            "temperature": 1.0,
            "temperature_gradient": 0.0,
            **dict.fromkeys(("temperature_ratio", "compressibility", "pressure_ratio"), of_bin),
            **dict.fromkeys(("slope_ratio", "mean_height_ratio", "species_temperature_ratio"), of_species),
            "range_ratio": np.full(2, range_ratio),
            "exchange_ratio": 1.0,
            "log_ratio": line,
        }
        facts = {"column": name, "height": height, "used": of_bin > 0.0, "mass": masses, "imbalance": 1e-11}
        facts |= {"strength": strength, "top": top, "count": 1000, "mean_density": 0.2}
        measured = {name: (value, np.full(np.shape(value), error)) for name, value in values.items()}
        expected = {"density": (density, error * density), "hydrostatic": density, "log_ratio_expected": line}
        return facts | measured | expected

    made = table("point", [("dilute", 0.01, np.nan), ("dense", 16.0, 1.0)], column, inner=INNER)
    ranges = {"range_low": ("range", [0.1, 0.2]), "range_high": ("range", [0.2, 0.3])}
    return made.set_coords("column").assign_coords(ranges)


def with_source(ds):
    """These columns and the source's: in its sample and later, both as the dense one."""
    more = [ds.isel(point=1).assign_coords(column=name) for name in ("source", "later")]
    made = xr.concat([ds, *more], "point")
    reported = np.linspace(0.2, 0.9, 10)
    share = reported + 0.01 * np.sqrt(2.0) * np.tile([1.0, -1.0], 5)  # each one standard deviation off
    only = np.array([np.nan, np.nan, 1.0, np.nan])
    numbers = {"collisions": 1e7, "ringing": 0.002, "ringing_error": 0.001}
    return made.assign(
        {name: ("point", value * only) for name, value in numbers.items()}
        | {
            "share": (("point", "layer"), np.outer(only, share)),
            "share_error": (("point", "layer"), np.outer(only, np.full(10, 0.01))),
        }
    ).assign_attrs(source_collisions=1e7, source_temperature=1.0, source_shares=reported.tolist())


def capacities():
    """What `measure.gravity.heat_capacity` gives if theory is right, without and with gravity."""
    x = np.array([0.0, 2.0])
    slope = gravity.ideal_heat_capacity(x, 2)
    both = np.repeat(slope, 2).reshape(2, 2)
    error = np.array([0.0, 0.01])
    return xr.Dataset(
        {
            "x": ("pair", x),
            "gravity": ("pair", [0.0, 0.02]),
            "run_x": (("pair", "run"), np.array([[0.0, 0.0], [1.9, 2.1]])),
            "slope": ("pair", slope),
            "slope_error": ("pair", error),
            "slope_expected": ("pair", slope),
            "fluctuation": (("pair", "run"), both),
            "fluctuation_error": (("pair", "run"), np.repeat(error, 2).reshape(2, 2)),
            "fluctuation_expected": (("pair", "run"), both),
        },
        attrs={"count": 100},
    )


SETTINGS = {"bins": 8, "blocks": 4, "clear": 0.5, "ranges": [[0.001, 0.01]]}
SETTINGS |= {"source_collisions": 100.0, "source_temperature": 1.0, "source_shares": [0.5]}
SETTINGS |= {"columns": {"source": "column_source"}}


def run(point, root):
    """The point with its simulations made."""
    made = replace(point, root=str(root))
    times = made.schedule
    for k, path in enumerate(made.replica_paths):
        Path(path).parent.mkdir(parents=True, exist_ok=True)
        scene, engine = made.scene, made.engine
        gp.run(scene, engine, made.seed(k), times.duration, times.sample_interval, path)
    return made


def test_the_profile_of_an_ideal_column_is_barometric():
    place, stretch = ideal_column(np.random.default_rng(1), 400, np.ones(100))
    profile = columns.profile(place, stretch, 8)
    edges = np.linspace(0.0, 4.0, 9)
    fine = ideal_profile(np.linspace(0.0, 4.0, 8001)[:-1] + 0.25e-3, 4.0, 1.0).reshape(8, 1000).mean(axis=1)
    expected = 100.0 * fine / 3.0
    error = expected / np.sqrt(expected * 400 * 3.0 * np.diff(edges))
    assert np.all(np.abs(profile.density[0] - expected) < 4.0 * error)
    assert profile.temperature == pytest.approx(np.ones(8), abs=0.05)
    assert profile.pressure == pytest.approx(expected, rel=0.03)  # rho kT, T = 1
    assert stretch.energies.mean() == pytest.approx(1.0, abs=0.02)


def test_the_pressure_is_the_mean_over_each_bin_of_the_weight_above():
    place, stretch = ideal_column(np.random.default_rng(2), 1, [1.0, 1.0, 4.0])
    stretch.positions[0, :, 1] = [0.5, 1.0, 3.25]
    pressure = columns.profile(place, stretch, 2).pressure * place.width - stretch.ceiling
    # Below 0.5 all six of mass are above; from 3.25 on nothing is.
    assert pressure == pytest.approx([(0.5 * 6 + 0.5 * 5 + 1.0 * 4) / 2.0, 1.25 * 4 / 2.0])


@pytest.mark.parametrize("boundary", ["wall", "periodic"])
def test_a_column_of_two_kinds_balances_and_separates(tmp_path, boundary):
    scene = gp.Scene(
        gp.Container((6.0, 12.0), (boundary, "wall")),
        [gp.Species(40, 0.05, temperature=0.5), gp.Species(40, 0.05, mass=3.0, temperature=0.5)],
        gravity=(0.0, -0.2),
    )
    scene.to_file(tmp_path / "scene.yaml")
    made = run(point(tmp_path / "scene.yaml", duration=2000.0, equilibration=400.0, samples=400), tmp_path)
    ds = measure.separation([made], SETTINGS | {"blocks": 10}).isel(point=0)
    assert float(ds["imbalance"]) < 1e-9
    assert float(ds["range_ratio"][0]) == pytest.approx(1.0, abs=0.1)
    for name in ("slope_ratio", "exchange_ratio", "mean_height_ratio", "species_temperature_ratio"):
        error = ds[f"{name}_error"].values
        assert np.all(error < 0.15), name
        assert np.all(np.abs(ds[name].values - 1.0) < 4.5 * error + 0.02), name
    assert float(ds["density"].sel(species=1)[0]) > 2.0 * float(ds["density"].sel(species=1)[-1])


def test_fewer_frames_than_stretches_are_refused(tmp_path):
    scene = gp.Scene(gp.Container((4.0, 4.0)), [gp.Species(5, 0.1, temperature=1.0)], gravity=(0.0, -1.0))
    scene.to_file(tmp_path / "scene.yaml")
    made = run(point(tmp_path / "scene.yaml", samples=3, duration=3.0, equilibration=0.0), tmp_path)
    with pytest.raises(ValueError, match="blocks: 4"):
        measure.barometric([made], SETTINGS)


@pytest.fixture
def boxes(tmp_path, monkeypatch):
    """Pairs of points with made-up kinetic energies: of the right distribution in a very high box."""
    scene = gp.Scene(
        gp.Container((1000.0, 1000.0)), [gp.Species(20, 0.01, temperature=1.0)], gravity=(0.0, -1.0)
    )
    scene.to_file(tmp_path / "scene.yaml")
    settings = {"samples": 4000, "duration": 4000.0, "equilibration": 0.0}
    points = [
        point(tmp_path / "scene.yaml", **settings, **{"scene.species.0.temperature": t, "scene.gravity.1": g})
        for g in (-100.0, 0.0)
        for t in (1.0, 1e5)
    ]
    points = [replace(p, name=f"run-{n}") for n, p in enumerate(points)]
    rng = np.random.default_rng(3)
    stored = {}
    for p in points:
        made = p.scene
        pull = made.gravity[1] if made.gravity else 0.0
        start = gp.Simulation(made, gp.EventDriven(), seed=p.seed(0)).initial_state
        energy = start.kinetic_energy - pull * (start.positions[:, 1] - 0.01).sum()
        share = rng.beta(20, 20, 4001) if pull else np.ones(4001)
        columns = {"kinetic_energy": ("frame", energy * share), "time": ("frame", np.arange(4001.0))}
        stored[p.replica_path(0)] = xr.Dataset(columns)
    monkeypatch.setattr(measure, "runs", runs_of(stored))
    return points


def test_heat_capacity_without_and_with_gravity(boxes):
    # What was made up is the distribution in a box much higher than the one of the scene.
    ds = measure.heat_capacity(boxes, {"blocks": 20})
    high, flat = ds.isel(pair=0), ds.isel(pair=1)
    assert float(flat["slope"]) == pytest.approx(1.0) == float(flat["slope_expected"])
    assert flat["fluctuation"].values == pytest.approx(np.ones(2))
    assert abs(float(high["slope"]) - 2.0) < 4.0 * float(high["slope_error"])
    exact = 41.0 / 21.0  # (2 N + 1) / (N + 1)
    assert np.all(np.abs(high["fluctuation"] - exact) < 4.0 * high["fluctuation_error"])
    assert float(high["fluctuation_error"].max()) < 0.1


def test_points_that_are_not_pairs_are_refused(boxes):
    for chosen in (boxes[:3], boxes[1:3]):
        with pytest.raises(ValueError, match="pair"):
            measure.heat_capacity(chosen, {"blocks": 20})


@pytest.fixture
def source_column(tmp_path):
    """A point of a mixture whose sample begins at 10."""
    scene = gp.Scene(
        gp.Container((6.0, 12.0)),
        [gp.Species(20, 0.1, speed=1.0), gp.Species(20, 0.1, mass=3.0, speed=1.0)],
        gravity=(0.0, -0.2),
    )
    scene.to_file(tmp_path / "scene.yaml")
    return point(tmp_path / "scene.yaml")


def test_the_oscillation_that_is_left_where_the_sample_begins(source_column, monkeypatch):
    time = np.arange(0.0, 13.0, 0.1)
    noise = np.random.default_rng(1).normal(0.0, 0.002, time.size)
    kinetic = 50.0 * (1.0 + 0.2 * np.exp(-time / 5.0) * np.cos(4.0 * time + 1.0) + noise)
    monkeypatch.setattr(
        measure,
        "open_trajectory",
        lambda path: xr.Dataset({"time": ("frame", time), "kinetic_energy": ("frame", kinetic)}),
    )
    found = measure.ringing(source_column)["ringing"]
    assert abs(found.value - 0.2 * np.exp(-2.0)) < 4.0 * found.error
    assert 0.0001 < found.error < 0.002
    assert found.freedom == np.sum(time > 3.0) - 5


def test_shares_of_the_light_discs_in_layers_of_the_container(source_column, monkeypatch):
    place, sample = ideal_column(np.random.default_rng(2), 1, [1.0, 1.0, 1.0, 3.0])
    place = replace(place, diameter=0.2, height=3.8)  # the container is 4 high
    sample.positions[0, :, 1] = [0.1, 0.2, 3.0, 0.3]
    monkeypatch.setattr(measure, "field", lambda point: place)
    monkeypatch.setattr(measure, "stretches", lambda point, number: [sample])
    share, error = measure.layer_fractions(source_column, 2)["share"]
    assert share == pytest.approx([2.0 / 3.0, 1.0])
    assert error == pytest.approx([np.sqrt(2.0 / 27.0), 0.0])
    sample.positions[0, 3, 1] = 1.95  # just above the middle of the container
    assert measure.layer_fractions(source_column, 2)["share"][0] == pytest.approx([1.0, 0.5])


def test_only_the_source_s_own_run_is_compared_with_its_numbers(source_column, tmp_path):
    settings = SETTINGS | {"blocks": 2, "source_shares": [0.5] * 3}
    own = replace(source_column, experiment="column_source")
    made = [run(p, tmp_path) for p in (source_column, own)]
    ds = measure.separation(made, settings)
    assert np.isnan(ds["collisions"][0]) and np.isnan(ds["share"][0]).all()
    sim = gp.Simulation(own.scene, own.engine, seed=own.seed(0))
    sim.advance(duration=10.0)
    assert ds["collisions"][1] == sim.tally.collisions + sim.tally.wall_hits.sum() > 0
    assert ds["share"][1].sizes == {"layer": 3} and np.isfinite(ds["share"][1]).any()
    assert ds.attrs["source_shares"] == [0.5] * 3 and ds.attrs["source_collisions"] == 100.0


def test_theory_agrees_with_itself():
    for found, count in (
        (claims.barometric(profiles()), 4 + 5),
        (claims.separation(profiles(2)), 7 + 5),
        (claims.heat_capacity(capacities()), 6),
    ):
        assert len(found) == count
        assert set(judged(found).values()) == {"agrees"}


def source_mixture():
    """The source's mixture as theory has it: halfway to equilibrium."""
    ds = with_source(profiles(2)).isel(point=[0, 1, 2])
    ds["exchange_ratio"][2] = 0.6
    return ds


def test_the_source_is_reproduced_by_its_own_numbers():
    for found, before, count in (
        (claims.barometric(with_source(profiles())), 9, 4 + 2),
        (claims.separation(source_mixture()), 12, 5),
    ):
        assert {verdict for claim, verdict in judged(found).items()} == {"agrees", "reproduced"}
        own = found[before : before + count]
        assert {claim.kind for claim in own} >= {"reproduction", "identity"}


@pytest.mark.parametrize(
    ("statement", "name", "change", "text", "verdict"),
    [
        (claims.barometric, "collisions", 2e5, "collisions until", "disagrees"),
        (claims.barometric, "temperature", 0.05, "over the source's, in its sample", "disagrees"),
        (claims.barometric, "ringing", 0.02, "amplitude of the oscillation", "source in error"),
        (claims.separation, "share", 0.04, "share of light discs", "disagrees"),
        (claims.separation, "exchange_ratio", 0.4, "mixture at the end", "disagrees"),
        (
            claims.separation,
            "species_temperature_ratio",
            0.02,
            "temperature of the heavy",
            "disagrees",
        ),
    ],
)
def test_each_claim_about_the_source_can_fail(statement, name, change, text, verdict):
    ds = with_source(profiles()) if statement is claims.barometric else source_mixture()
    ds[name] = ds[name] + change
    found = judged(statement(ds))
    assert verdict in {verdict for claim, verdict in found.items() if text in claim}


@pytest.mark.parametrize(
    ("statement", "name", "change", "text"),
    [
        (claims.barometric, "slope_ratio", 0.02, "slope of the chemical"),
        (claims.barometric, "temperature_gradient", 0.02, "temperature against height"),
        (claims.barometric, "imbalance", 1e-6, "gain of momentum"),
        (claims.barometric, "mean_height_ratio", 0.06, "mean height"),
        (claims.barometric, "range_ratio", -0.02, "pressure that carries"),
        (claims.separation, "exchange_ratio", 0.02, "slope of ln(heavy/light)"),
        (claims.separation, "species_temperature_ratio", 0.02, "temperature of the heavy"),
        (claims.separation, "slope_ratio", 0.02, "of the heavy"),
    ],
)
def test_each_claim_about_columns_can_fail(statement, name, change, text):
    ds = profiles(1 if statement is claims.barometric else 2)
    ds[name] = ds[name] + change
    assert "disagrees" in about(statement(ds), text)


@pytest.mark.parametrize(("name", "text"), [("slope", "dE/dT"), ("fluctuation", "fluctuations")])
def test_each_claim_about_heat_can_fail(name, text):
    ds = capacities()
    ds[name] = ds[name] * 1.1
    assert about(claims.heat_capacity(ds), text) == {"disagrees"}


def test_too_short_runs_are_inconclusive():
    found = judged(claims.barometric(profiles(error=0.05)))
    assert {
        verdict for claim, verdict in found.items() if "balance" not in claim and "gain" not in claim
    } == {"inconclusive"}


def ideal(row, kind):
    """(B,) density of an ideal gas with the mean density, the mass and the temperature of the column's."""
    own = row.isel(species=kind)
    top = float(own["top"])
    weight = float(own["mass"] * own["strength"] / own["temperature"])
    return float(own["density"].mean()) * top * ideal_profile(own["height"].values, top, weight)


def profile(row, kind):
    """Density of a species over the column's mean."""
    mean, own = float(row["mean_density"]), row.isel(species=kind)
    return Points(row["height"], own["density"] / mean, own["density_error"] / mean, some=True)


def percent(x, ratio, error):
    """Deviation of a ratio from 1."""
    return Points(x, 100.0 * (ratio - 1.0), 100.0 * error, some=True)


def test_profiles_and_the_equation_of_state_of_a_column():
    ds = varied(with_source(profiles()))
    density, ratio, temperature, state, deviation, *panels = draw(figure.barometric, ds).axes
    dilute, dense, sample, large = (ds.isel(point=n) for n in range(4))
    shows(density, profile(dilute, 0), profile(dense, 0))
    theory = (ideal(dilute, 0), dense["hydrostatic"].isel(species=0))
    ratios, temperatures = [], []
    for row, expected in zip((dilute, dense), theory, strict=True):
        own = row.isel(species=0)
        ratios.append(percent(row["height"], own["density"] / expected, own["density_error"] / expected))
        temperatures.append(percent(row["height"], row["temperature_ratio"], row["temperature_ratio_error"]))
    shows(ratio, *ratios)
    shows(temperature, *temperatures)
    eta, z = dense["packing_fraction"], dense["compressibility"]
    shows(state, Points(eta, z, dense["compressibility_error"]))
    shows(deviation, percent(eta, dense["pressure_ratio"], dense["pressure_ratio_error"]))
    own = (large, sample)
    shows(panels[0], *(profile(row, 0) for row in own))
    ratios = [(row["height"], row["temperature_ratio"], row["temperature_ratio_error"]) for row in own]
    shows(panels[1], *(percent(*values) for values in ratios))
    assert len(draw(figure.barometric, varied(profiles())).axes) == 5  # without the source's columns


def test_densities_of_two_species_and_their_ratio():
    ds = varied(with_source(profiles(2)))
    *densities, ratio, residual, shares = draw(figure.separation, ds).axes
    for n, axis in enumerate(densities):
        row = ds.isel(point=n)
        shows(axis, profile(row, 0), profile(row, 1))
    logarithms, residuals = [], []
    for row in (ds.isel(point=n) for n in range(2)):
        logarithms.append(Points(row["height"], row["log_ratio"], row["log_ratio_error"]))
        sigmas = (row["log_ratio"] - row["log_ratio_expected"]) / row["log_ratio_error"]
        residuals.append(Points(row["height"], sigmas))
    shows(ratio, *logarithms)
    shows(residual, *residuals)
    own, top = ds.isel(point=2), float(ds["top"][2])
    middles = (np.arange(10) + 0.5) * top / 10
    shows(shares, Points(middles, own["share"], own["share_error"]))
    [steps] = (patch for patch in shares.patches if patch.get_label() == "source's run")
    assert list(steps.get_data().values) == ds.attrs["source_shares"]
    assert len(draw(figure.separation, varied(profiles(2))).axes) == 4  # without the source's columns


def test_heat_capacities_from_slopes_and_from_fluctuations():
    ds = varied(capacities())
    capacity, deviation = draw(figure.heat_capacity, ds).axes
    values, deviations = [], []
    for name, x in (("slope", "x"), ("fluctuation", "run_x")):
        expected = ds[f"{name}_expected"]
        values.append(column(ds, x, name))
        ratio, error = ds[name] / expected, ds[f"{name}_error"] / expected
        deviations.append(Points(ds[x], 100.0 * (ratio - 1.0), 100.0 * error))
    shows(capacity, *values)
    shows(deviation, *deviations)
