"""Runs of heat between walls, and what their measurements give if theory is right."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from reproduction.claims.data import about, judged
from reproduction.families.drawn import Points, column, draw, lines, shows, varied

import gaspart as gp
from gaspart.reproduction.families.heat import claims, figure, measure
from gaspart.reproduction.families.heat.gap import FRAMES, Averages, Gap, approach, averages
from gaspart.reproduction.families.heat.measure import INNER
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import from_rows
from gaspart.theory.heat import (
    METAL_BEND,
    METAL_GAP,
    TEMPERATURE_JUMP,
    conducting_slab,
    dilute_fourier_flux,
    free_molecular_flux,
    steady_part,
)


def run(tmp_path, scene, **settings):
    """A point of this scene with its runs made."""
    scene.to_file(tmp_path / "scene.yaml")
    settings |= {"scene": str(tmp_path / "scene.yaml")}
    point = Point("heat", "single", "simulate", settings, str(tmp_path / "points"), 1)
    times = point.schedule
    for k, path in enumerate(point.replica_paths):
        Path(path).parent.mkdir(parents=True, exist_ok=True)
        engine = point.engine
        gp.run(point.scene, engine, point.seed(k), times.duration, times.sample_interval, path)
    return point


def gas(count, radius, components="all"):
    """Spheres between walls at 2 and 1."""
    container = gp.Container((10.0 + 2 * radius, 6.0, 6.0), ("wall", "periodic", "periodic"))
    faces = {"x_low": gp.Thermal(2.0, components), "x_high": gp.Thermal(1.0, components)}
    return gp.Scene(container, [gp.Species(count, radius, temperature=1.4)], faces=faces)


def gases(error=0.002):
    """A dense gas, and thin ones between walls of both rules in two and three dimensions."""
    length, bins = 200.0, 10
    position = (np.arange(bins) + 0.5) * length / bins
    rows = []
    for number, knudsen, dimension, rule in (
        (0.04, 0.03, 3, "all"),
        (0.001, 2000.0, 3, "all"),
        (0.001, 2000.0, 3, "normal"),
        (0.001, 2000.0, 2, "all"),
        (0.001, 2000.0, 2, "normal"),
    ):
        free = free_molecular_flux(number, 2.0, 1.0, dimension, components=rule)
        row = {"dimension": dimension, "normal": rule == "normal", "number": number, "knudsen": knudsen}
        row |= {"length": length, "hot": 2.0, "cold": 1.0, "imbalance": 1e-12, "free": free, "flux": free}
        row |= {"full": free_molecular_flux(number, 2.0, 1.0, dimension), "wall_ratio": 1.0}
        row |= {"fourier": dilute_fourier_flux(length, 2.0, 1.0), "half_ratio": 1.0}
        row |= dict.fromkeys(("slab_flux", "profile_ratio", "jump"), np.nan)
        row |= {"position": position, "used": position > 20.0}
        row |= {"temperature": np.full(bins, 1.4), "density": np.full(bins, number)}
        row |= dict.fromkeys(("slab_temperature", "slab_density"), np.full(bins, np.nan))
        row["approach_time"] = 40.0 * np.arange(FRAMES)
        row |= dict.fromkeys(("approach", "approach_error", "expected_approach"), np.full(FRAMES, np.nan))
        if knudsen < 0.1:
            slab = conducting_slab(length, number, 2.0, 1.0)
            row |= {"flux": slab.flux, "slab_flux": slab.flux}
            row |= {"profile_ratio": 1.0, "jump": TEMPERATURE_JUMP}
            row["approach"] = row["expected_approach"] = 0.45 * steady_part(row["approach_time"], length, 7.0)
            row["approach_error"] = np.full(FRAMES, 0.05)
            for name in ("temperature", "density"):
                row[name] = np.interp(position, slab.position, getattr(slab, name))
                row[f"slab_{name}"] = row[name]
        for name in ("flux", "wall_ratio", "half_ratio", "profile_ratio", "jump", "temperature", "density"):
            row[f"{name}_error"] = np.abs(row[name]) * error
        rows.append(row)
    return from_rows("point", rows, INNER)


def metals(error=0.002):
    """A metal between different walls, between walls at 1 and at 2, and its grid between different walls."""
    ones, bins = np.ones(4), 8
    position = (np.arange(bins) + 0.5) / bins
    values = {
        "share": ones,
        "energy_ratio": ones,
        "log_fluctuation": 0.0 * ones,
        "bend": METAL_BEND * ones,
        "mode_ratio": ones,
        "flux": np.array([0.1, 0.1, 0.1, 0.105]),
    }
    ds = xr.Dataset({name: ("point", value) for name, value in values.items()})
    for name in ("electrons", "modes"):
        ds[name] = (("point", "bin"), np.tile(2.0 - position, (4, 1)))
    for name in list(ds):
        ds[f"{name}_error"] = (
            error * ds[name] if name not in ("log_fluctuation", "bend") else ("point", error * ones)
        )
    ds["position"] = (("point", "bin"), np.tile(position, (4, 1)))
    for name, value in {"hot": [2, 1, 2, 2], "cold": [1, 1, 2, 1], "expected": [360] * 4}.items():
        ds[name] = ("point", np.array(value, dtype=float))
    ds["regular"] = ("point", np.array([False, False, False, True]))
    ds = ds.assign(gap_over_path=("point", METAL_GAP * ones), electrons_part=("point", ones * 5 / 9))
    return ds.assign(slope=1.0, slope_error=error)


def test_the_gap_is_where_centres_can_be():
    assert Gap.of(gas(10, 0.5)) == Gap(length=10.0, area=36.0, hot=2.0, cold=1.0, dimension=3)


def test_what_the_walls_give_is_what_the_particles_gain(tmp_path):
    point = run(tmp_path, gas(20, 0.1), duration=200.0, equilibration=20.0, samples=40)
    found = averages(point, Gap.of(gas(20, 0.1)), blocks=8, bins=4)
    blocks = np.diff(found.stored[0, :, 0]) / 25.0 / 36.0  # of 5 samples, each 5 long
    assert found.heat_in - found.heat_out == pytest.approx(blocks, abs=1e-9)
    assert found.imbalance < 1e-9
    assert found.density.mean(axis=1) == pytest.approx(np.full(8, 20 / 360))
    with pytest.raises(ValueError, match="blocks"):
        averages(point, Gap.of(gas(20, 0.1)), blocks=1000, bins=4)


def test_the_flux_is_without_what_the_particles_store():
    """Blocks whose energy fluctuates around a flux of 3, and is given back in the next."""
    rng = np.random.default_rng(5)
    energy = rng.normal(size=(1, 201))
    moment = rng.normal(size=(1, 201))
    change = np.diff(energy)[0]
    found = Averages(
        3.0 + change, np.full(200, 3.0), *np.ones((2, 200, 1)), 0.0, np.stack([energy, moment], -1), 600.0
    )
    assert found.flux().value == pytest.approx(3.0, abs=1e-12)
    assert found.wall_ratio().value == pytest.approx(600.0 / (600.0 + change.sum()))


def test_the_start_of_a_run_is_shown_from_one_temperature_on(tmp_path):
    """Halves at one temperature; of a run with fewer frames the others are missing."""
    point = run(tmp_path, gas(100, 0.5), duration=20.0, equilibration=5.0, samples=8, boxes_per_side=1)
    slab = conducting_slab(10.0, 100 / 360, 2.0, 1.0)
    found = approach(point, slab)
    frames = int(np.isfinite(found["approach_time"]).sum())
    assert 8 < frames < FRAMES and np.isnan(found["approach"][frames:]).all()
    assert abs(found["approach"][0]) < 4.0 * found["approach_error"][0]
    # two halves of 50 spheres at 1.4, the squares of whose components vary by 2
    assert found["approach_error"][0] == pytest.approx(1.4 * np.sqrt(2.0 * 2.0 / (3.0 * 50.0)), rel=0.15)


def test_a_thin_gas_carries_what_free_flight_does(tmp_path):
    """Uniform too, with the temperature sqrt(T1 T2) of two half Maxwellians."""
    point = run(tmp_path, gas(40, 0.01), duration=6000.0, equilibration=100.0, samples=400)
    ds = measure.heat_conduction_gas([point], {"bins": 5, "blocks": 10, "clear": 3}).isel(point=0)
    assert float(ds["number"]) == pytest.approx(40 / 360)
    assert float(ds["full"]) == pytest.approx(free_molecular_flux(40 / 360, 2.0, 1.0, 3))
    assert float(ds["flux_error"]) < 0.05 * float(ds["full"])
    assert abs(float(ds["flux"] - ds["full"])) < 3.5 * float(ds["flux_error"])
    assert float(ds["imbalance"]) < 1e-9
    sigma = ds["density_error"].values.mean()
    assert np.abs(ds["density"].values / (40 / 360) - 1.0).max() < 4.0 * sigma / (40 / 360)
    assert ds["temperature"].values == pytest.approx(np.full(5, np.sqrt(2.0)), rel=0.05)
    assert np.isnan(ds["slab_flux"]) and np.isnan(ds["approach"]).all()


def test_the_jump_of_a_made_up_profile_comes_back():
    """T^(3/2) linear between 1.9 and 1.05, where the walls have 2 and 1: slopes and paths by hand."""
    gap = Gap(100.0, 1.0, 2.0, 1.0, 3)
    position = np.linspace(5.0, 95.0, 30)
    power = 1.9**1.5 + (1.05**1.5 - 1.9**1.5) * position / 100.0
    temperature, pressure = power ** (2 / 3), 1e-4
    found = measure._jump(gap, position, np.full(30, pressure), pressure / temperature, 1.0)
    slope = (1.9**1.5 - 1.05**1.5) / 100.0
    path = 1.0 / (np.sqrt(2.0) * np.pi * pressure)
    hot = 0.1 / (path * 1.9 * slope / (1.5 * np.sqrt(1.9)))
    cold = 0.05 / (path * 1.05 * slope / (1.5 * np.sqrt(1.05)))
    assert found == pytest.approx(0.5 * (hot + cold), rel=1e-3)


def test_a_dense_gas_is_compared_with_fourier(tmp_path):
    point = run(tmp_path, gas(100, 0.5), duration=300.0, equilibration=100.0, samples=60, boxes_per_side=1)
    ds = measure.heat_conduction_gas([point], {"bins": 5, "blocks": 12, "clear": 1}).isel(point=0)
    assert float(ds["knudsen"]) < measure.FLUID
    assert float(ds["density"].mean()) == pytest.approx(100 / 360, rel=1e-3)
    assert float(ds["profile_ratio"]) == pytest.approx(1.0, abs=0.1)
    assert ds["approach_time"].values == pytest.approx(5.0 * np.arange(FRAMES))
    deviation = (ds["approach"] - ds["expected_approach"]) / ds["approach_error"]
    assert abs(float(deviation.mean())) < 1.0 and float(abs(deviation).max()) < 5.0
    assert float(ds["expected_approach"][-1]) == pytest.approx(0.35, abs=0.1)
    with pytest.raises(ValueError, match="blocks"):
        measure.heat_conduction_gas([point], {"bins": 5, "blocks": 1000, "clear": 1})


def test_modes_and_electrons_have_the_temperature_of_the_walls(tmp_path):
    """Whatever they began with; two temperatures give the heat capacity."""
    points = []
    for warm in (1.0, 2.0):
        faces = dict.fromkeys(("x_low", "x_high"), gp.Thermal(warm))
        species = [gp.Species(30, 0.02, temperature=1.0), gp.Species(10, 0.5, fixed=True, vibration=0.0)]
        scene = gp.Scene(gp.Container((8.0, 8.0), ("wall", "periodic")), species, faces=faces)
        folder = tmp_path / str(warm)
        folder.mkdir()
        points.append(run(folder, scene, duration=6000.0, equilibration=100.0, samples=600))
    ds = measure.heat_conduction_metal(points, {"bins": 2, "blocks": 10})
    assert ds["expected"].values == pytest.approx([40.0, 40.0])
    for name in ("energy_ratio", "mode_ratio"):
        assert (np.abs(ds[name] - 1.0) < 4.0 * ds[f"{name}_error"]).all()
    assert (np.abs(ds["log_fluctuation"]) < 4.0 * ds["log_fluctuation_error"]).all()
    assert np.isnan(ds["bend"]).all()  # of two bins
    assert ds["mode_ratio"].values == pytest.approx([1.0, 1.0], abs=0.05)
    assert float(ds["slope"]) == pytest.approx(1.0, abs=0.05)


def test_scatterers_on_a_grid_are_distinguished_from_electrons(tmp_path):
    """The scatterers come first; they and the electrons take the temperature of the walls."""
    faces = dict.fromkeys(("x_low", "x_high"), gp.Thermal(2.0))
    centres = [(x, y) for x in (2.0, 4.0, 6.0) for y in (1.0, 3.0, 5.0)]
    scatterers = [gp.Particle(centre, (0.0, 0.0), 0.5, fixed=True, vibration=0.0) for centre in centres]
    container = gp.Container((8.0, 6.0), ("wall", "periodic"))
    scene = gp.Scene(container, [gp.Species(20, 0.02, temperature=1.0)], scatterers, faces=faces)
    point = run(tmp_path, scene, duration=6000.0, equilibration=100.0, samples=600)
    row = measure._metal(point, {"bins": 3, "blocks": 10})
    assert row["regular"] and row["expected"] == 29.0
    assert row["electrons_part"] == pytest.approx(20.0 / 29.0)
    for name, value in (("energy_ratio", 1.0), ("mode_ratio", 1.0), ("modes", 2.0), ("electrons", 2.0)):
        found = row[name]
        assert np.all(np.abs(found.value - value) < 4.0 * found.error)
        assert np.all(np.abs(found.value / value - 1.0) < 0.07)


def test_replicas_with_other_places_of_scatterers_are_one_block_each(tmp_path):
    """Their scatter is the uncertainty of the flux, which stretches of one run do not have."""
    faces = {"x_low": gp.Thermal(2.0), "x_high": gp.Thermal(1.0)}
    species = [gp.Species(20, 0.02, temperature=1.4), gp.Species(8, 0.5, fixed=True, vibration=1.4)]
    scene = gp.Scene(gp.Container((8.0, 6.0), ("wall", "periodic")), species, faces=faces)
    point = run(tmp_path, scene, duration=400.0, equilibration=100.0, samples=40, replicas=3)
    both = measure._metal(point, {"bins": 3, "blocks": 10})
    alone = []
    for k in range(3):
        one = Point("heat", "single", "simulate", point.settings | {"replicas": 1}, str(tmp_path / str(k)), 1)
        Path(one.replica_paths[0]).parent.mkdir(parents=True)
        Path(point.replica_paths[k]).rename(one.replica_paths[0])
        alone.append(measure._metal(one, {"bins": 3, "blocks": 10}))
    flux, fluxes = both["flux"], [one["flux"].value for one in alone]
    assert flux.value == pytest.approx(np.mean(fluxes), rel=1e-9)
    assert flux.error == pytest.approx(np.std(fluxes, ddof=1) / 3**0.5, rel=1e-9)
    assert flux.freedom == 2 and alone[0]["flux"].freedom == 9
    # the free area over half the perimeter of 8 discs of 0.52, on 7.96 of 8 by 6
    free = 7.96 * 6.0 - 8 * np.pi * 0.52**2
    assert both["gap_over_path"] == pytest.approx(7.96 * 2.0 * 8 * 0.52 / free)


def test_a_bent_profile_is_distinguished_from_a_straight_one():
    position, number = (np.arange(10) + 0.5) / 10, np.linspace(3.0, 5.0, 10)
    straight, bent = 2.0 - position, 2.0 - position + 0.3 * position**2
    straight[[0, -1]] = 1.5  # next to the walls
    assert measure._bend(straight * number, number) == pytest.approx(0.0, abs=1e-12)
    assert measure._bend(bent * number, number) == pytest.approx(0.3)


def test_theory_agrees_with_itself():
    found = judged(claims.heat_conduction_gas(gases()))
    assert len(found) == 5 * 3 + 4 + 3
    assert set(found.values()) == {"agrees"}


@pytest.mark.parametrize(
    ("name", "factor", "text"),
    [
        ("imbalance", 1e8, "transferred heat"),
        ("wall_ratio", 1.02, "flux into the cold"),
        ("half_ratio", 1.02, "second over that in the first"),
        ("flux", 1.1, "flux over n (d + 1)"),
        ("flux", 1.1, "flux over that of theory"),
        ("profile_ratio", 1.03, "temperature away"),
        ("jump", 1.3, "temperature jump"),
    ],
)
def test_each_claim_can_fail(name, factor, text):
    ds = gases()
    ds[name] = ds[name] * factor
    assert about(claims.heat_conduction_gas(ds), text) == {"disagrees"}


def test_the_shares_of_the_source_are_not_those_of_full_accommodation():
    ds = gases()
    ds["flux"] = ds["full"]
    found = judged(claims.heat_conduction_gas(ds))
    wrong = {claim for claim, verdict in found.items() if verdict == "disagrees" and "normal" in claim}
    assert len(wrong) == 2


def test_too_short_runs_are_inconclusive():
    found = judged(claims.heat_conduction_gas(gases(error=0.3)))
    assert {verdict for claim, verdict in found.items() if "transferred heat" not in claim} == {
        "inconclusive"
    }


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("share", "electrons around it"),
        ("mode_ratio", "mean energy of a mode over kT"),
        ("energy_ratio", "E / T over"),
        ("log_fluctuation", "var E"),
        ("bend", "second-order"),
        ("slope", "dE/dT"),
    ],
)
def test_each_claim_about_metals_can_fail(name, text):
    ds = metals()
    assert set(judged(claims.heat_conduction_metal(ds)).values()) == {"agrees"}
    ds[name] = ds[name] + 0.1
    assert about(claims.heat_conduction_metal(ds), text) == {"disagrees"}


@pytest.mark.parametrize(("ratio", "verdict"), [(0.98, "disagrees"), (1.05, "agrees"), (1.12, "disagrees")])
def test_a_grid_conducts_a_little_better_than_random_scatterers(ratio, verdict):
    ds = metals()
    ds["flux"] = ds["flux"][0] * xr.where(ds["regular"], ratio, 1.0)
    found = judged(claims.heat_conduction_metal(ds))
    assert [got for claim, got in found.items() if claim.startswith("flux among")] == [verdict]


def test_the_profile_of_a_gas_disagrees_and_that_of_other_gaps_is_not_claimed():
    ds = metals()
    ds["bend"] = ds["bend"] - 0.17
    text = "second-order coefficient"
    (found,) = (
        verdict for claim, verdict in judged(claims.heat_conduction_metal(ds)).items() if text in claim
    )
    assert found == "disagrees"
    for name, value in (("gap_over_path", 5.0), ("hot", 1.5)):
        others = metals()
        others[name] = xr.where(others["hot"] > others["cold"], value, others[name])
        assert not [claim for claim in judged(claims.heat_conduction_metal(others)) if text in claim]


def test_random_scatterers_alone_are_not_compared_with_a_grid():
    ds = metals().isel(point=slice(3))
    assert not [claim for claim in judged(claims.heat_conduction_metal(ds)) if "grid" in claim]


def test_fluxes_and_profiles_of_a_gas():
    ds = varied(gases(), "knudsen", "number")
    flux, share, start, warm, deviation, dense = draw(figure.heat_conduction_gas, ds).axes
    row = ds.isel(point=0)
    whole = Points([row["number"]], [1e3 * row["flux"]], [1e3 * row["flux_error"]])
    shows(flux, whole, Points([], [], []))
    number, length = float(row["number"]), float(row["length"])
    shares = []
    for points in ([0, 1], [2], [3], [4]):
        own = ds.isel(point=points)
        infinity = 20.0 * 1.15 ** (own["dimension"] - 2.5)
        x = own["knudsen"].where(own["knudsen"] < 100.0, infinity)
        shares.append(Points(x, own["flux"] / own["full"], own["flux_error"] / own["full"]))
    shows(share, *shares)
    shows(start, Points(row["approach_time"], row["approach"], row["approach_error"]))
    position = row["position"] / length
    temperature, expected = row["temperature"], row["slab_temperature"]
    shows(warm, Points(position, temperature, row["temperature_error"]))
    percent = 100.0 * (temperature / expected - 1.0), 100.0 * row["temperature_error"] / expected
    shows(deviation, Points(position, *percent, some=True))
    assert deviation.containers[0].lines[0].get_xdata().size == int(row["used"].sum())
    shows(dense, Points(position, row["density"] / number, row["density_error"] / number))


def test_a_noisy_density_is_not_drawn():
    ds = gases()
    ds["density_error"] = 0.05 * ds["density"]
    dense = draw(figure.heat_conduction_gas, ds).axes[-1]
    assert not dense.containers and lines(dense)


def test_temperatures_and_energies_of_a_metal():
    ds = varied(metals(), "hot", "cold")
    profiles, energy, deviation = draw(figure.heat_conduction_metal, ds).axes
    row = ds.isel(point=0)
    shows(profiles, column(row, "position", "electrons"), column(row, "position", "modes"))
    still = ds.isel(point=[1, 2])
    warm, level, error = still["hot"], still["energy_ratio"], still["energy_ratio_error"]
    shows(energy, Points(warm, level * warm, error * warm))
    modes, bars = still["mode_ratio"], still["mode_ratio_error"]
    shows(
        deviation,
        Points(warm, 100.0 * (level - 1.0), 100.0 * error),
        Points(1.02 * warm, 100.0 * (modes - 1.0), 100.0 * bars),
    )
