"""Made-up runs through freezing with known answers, in the form that `measure.freezing` gives."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr
from reproduction.claims.data import judged
from reproduction.families.drawn import Points, column, draw, follows, lines, shows, varied

from gaspart import run, theory
from gaspart.reproduction.families.freezing import claims, figure
from gaspart.reproduction.families.freezing.measure import (
    STARTS,
    _disagreement,
    freezing_discs,
    freezing_spheres,
)
from gaspart.reproduction.points.points import points
from gaspart.scene.scene import Scene

DISCS = np.array([0.68, 0.69, 0.70, 0.71, 0.72, theory.CRYSTAL_OF_1024_DISCS[0]])
SPHERES = np.array([0.4, 0.45, 0.5, 0.56, 0.6])


def _table(eta, pressure, order, error, seed):
    """Both starts with Gaussian scatter and no drift."""
    rng = np.random.default_rng(seed)
    shape = (2, eta.size)
    table = {}
    for name, values, scale in (("pressure", pressure, error), ("order", order, 0.002)):
        noise = 0.5 * scale * rng.standard_normal((2, *shape))
        table |= {
            name: values + noise[0],
            f"{name}_error": np.full(shape, scale),
            f"{name}_drift": noise[1],
            f"{name}_drift_error": np.full(shape, 2.0 * scale),
        }
    dataset = xr.Dataset(
        {
            name: (("start", "packing_fraction"), np.broadcast_to(v, shape).copy())
            for name, v in table.items()
        },
        coords={"start": list(STARTS.values()), "packing_fraction": eta},
    )
    dataset["count"] = "packing_fraction", np.full(eta.size, 1024)
    return dataset


def discs(error=0.005, seed=1):
    """A loop about 9.1 with both branches as the literature has them."""
    area = np.pi / 4.0
    crystal = theory.CRYSTAL_OF_1024_DISCS[1]
    pressure = np.array([8.514, 8.98, 9.13, 9.06, 9.1, crystal])
    dataset = _table(DISCS, pressure, np.array([0.08, 0.2, 0.4, 0.65, 0.76, 0.8]), error, seed)
    dataset["density"] = "packing_fraction", DISCS / area
    for name, value in (
        ("plateau", 9.1),
        ("plateau_error", 0.02),
        ("plateau_low", 0.698),
        ("plateau_high", 0.72),
    ):
        dataset[name] = "start", np.full(2, value)
    rng = np.random.default_rng(seed)
    shown, particles = 3, 64
    waves = np.linspace(-12.0, 12.0, 9)
    pictures = xr.Dataset(
        {
            "x": (("shown", "particle"), 10.0 * rng.random((shown, particles))),
            "y": (("shown", "particle"), 9.0 * rng.random((shown, particles))),
            "angle": (("shown", "particle"), rng.uniform(-np.pi, np.pi, (shown, particles))),
            "g": (("shown", "distance"), np.ones((shown, 20))),
            "wave_x": (("shown", "mode_x"), np.tile(waves, (shown, 1))),
            "wave_y": (("shown", "mode_y"), np.tile(waves, (shown, 1))),
            "structure_factor": (("shown", "mode_x", "mode_y"), rng.exponential(1.0, (shown, 9, 9))),
        },
        coords={"shown": DISCS[[0, 2, 5]], "distance": np.linspace(0.2, 8.0, 20)},
    )
    return dataset.assign(disagreement=_disagreement(dataset)).merge(pictures).merge(_compared(seed))


def _compared(seed):
    """The pressures of 870 discs, as published."""
    known = theory.literature("pressure", 2)
    known = known[(known.container == "29 x 30") & np.isin(known.packing_fraction, [0.68, 0.7])]
    eta, pressure = known.packing_fraction, known.value
    dataset = _table(eta, pressure, np.full(eta.size, 0.1), 0.0015, seed + 1)
    names = [f"pressure{name}" for name in ("", "_error", "_drift", "_drift_error")]
    renamed = {name: f"compared_{name}" for name in (*names, "packing_fraction")}
    return dataset[names].rename(renamed)


def spheres(error=0.005, seed=1):
    """The crystal melts below 0.5; a fluid start stays fluid to 0.5."""
    volume = np.pi / 6.0
    fluid = theory.compressibility_factor(np.minimum(SPHERES, 0.5), 3)
    crystal = np.where(SPHERES >= 0.5, theory.etomica_crystal(np.maximum(SPHERES, 0.5)), fluid)
    z = np.stack([crystal, fluid])
    order = np.array([[0.02, 0.02, 0.4, 0.5, 0.52], [0.02, 0.02, 0.02, np.nan, np.nan]])
    dataset = _table(SPHERES, z * SPHERES / volume, order, error, seed)
    dataset["density"] = "packing_fraction", SPHERES / volume
    dataset["crystalline"] = (dataset["order"] > 0.3).astype(int)
    both = "start", "packing_fraction"
    dataset["Z"] = dataset["pressure"] / dataset["density"]
    dataset["Z_error"] = dataset["pressure_error"] / dataset["density"]
    dataset["finite_size"] = both, np.full(order.shape, -0.01)
    dataset["reference"] = both, np.where(np.isfinite(order), z, np.nan)
    position = np.linspace(0.5, 30.5, 31)
    solid = (position < 15.0).astype(float)
    profiles = xr.Dataset(
        {
            "slab_pressure": 11.55,
            "slab_error": 0.03,
            "slab_drift": 0.02,
            "slab_drift_error": 0.06,
            "slab_length": 31.0,
            "slab_count": 2743,
            "crystal_fraction": ("half", [0.52, 0.5]),
            "slab_order": (("half", "position"), np.tile(0.15 + 0.33 * solid, (2, 1))),
            "slab_density": (("half", "position"), np.tile(0.939 + 0.1 * solid, (2, 1))),
        },
        coords={"position": position},
        attrs={"slab_packing_fraction": 0.517},
    )
    merged = dataset.assign(disagreement=_disagreement(dataset)).merge(profiles)
    return merged.assign_attrs(profiles.attrs)


DISC_POINT = {
    "dimension": 2, "count": 64, "side": [8, 8 * 0.8660254037844386], "boundary": "periodic",
    "temperature": 1.0, "arrangement": "lattice", "duration": 8, "equilibration": 2, "samples": 32,
}  # fmt: skip
SPHERE_POINT = {
    "dimension": 3, "radius": 0.5, "boundary": "periodic", "temperature": 1.0, "arrangement": "lattice",
    "count": 108, "duration": 8, "equilibration": 4, "samples": 16,
}  # fmt: skip
EDGE = (4.0 / 1.0375) ** (1.0 / 3.0)
SLAB = {"count": 305, "side": [4 * EDGE, 4 * EDGE, 5 * EDGE], "arrangement": "slab"}


def simulated(folder, experiments):
    """The points of made-up experiments, run."""
    found = []
    for name, (point, grid) in experiments.items():
        config = {"seed": 1, "points": str(folder), "experiments": {name: {"point": point, "grid": grid}}}
        for one in points(config, name):
            recipe = one.parameters
            (folder / one.experiment / one.name).mkdir(parents=True)
            for path, seed in zip(one.replica_paths, recipe["seeds"], strict=True):
                times = recipe["duration"], recipe["sample_interval"]
                run(Scene.from_dict(recipe["scene"]), one.engine, tuple(seed), *times, path)
            found.append(one)
    return found


def test_discs_melt_and_stay(tmp_path):
    points = simulated(tmp_path, {"discs": (DISC_POINT, {"packing_fraction": [0.74, 0.5]})})
    settings = {"shown": [0.5, 0.74], "furthest": 3, "bins": 30, "highest": 8}
    dataset = freezing_discs(points, settings)
    assert dataset["start"].values.tolist() == ["crystal"]
    assert dataset["packing_fraction"].values == pytest.approx([0.5, 0.74])
    low, high = dataset["order"].values[0]
    assert low < 0.4 and high > 0.7
    assert dataset["density"].values == pytest.approx(np.array([0.5, 0.74]) * 4.0 / np.pi)
    z = (dataset["pressure"] / dataset["density"]).values[0]
    assert z == pytest.approx([4.2, 11.1], rel=0.06)  # Santos and others; Alder, Hoover and Young
    assert np.isnan(dataset["plateau"]).all()  # two points have no loop
    assert dataset["structure_factor"].dims == ("shown", "mode_x", "mode_y")
    bragg = dataset["structure_factor"].max(("mode_x", "mode_y")).values
    assert bragg[1] > 4.0 * bragg[0]


def test_discs_of_the_published_number_are_compared_and_not_drawn(tmp_path):
    long = {"equilibration": 40, "duration": 60}  # of a lattice that melts
    peer = {**DISC_POINT, **long, "count": 870, "side": [29, 30 * 0.8660254037844386]}
    made = {
        "discs": (DISC_POINT, {"packing_fraction": [0.5, 0.74]}),
        "peers": (peer, {"packing_fraction": [0.68]}),
    }
    settings = {"shown": [0.74], "furthest": 3, "bins": 30, "highest": 8}
    dataset = freezing_discs(simulated(tmp_path, made), settings)
    assert dataset["packing_fraction"].values == pytest.approx([0.5, 0.74])
    assert dataset["compared_packing_fraction"].values == pytest.approx([0.68])
    assert dataset["compared_pressure"].item() == pytest.approx(8.51, rel=0.03)
    assert dataset["compared_pressure_error"].item() > 0.0


def test_spheres_keep_to_their_branches(tmp_path):
    slab = {**SPHERE_POINT, **SLAB}
    points = simulated(
        tmp_path, {"bulk": (SPHERE_POINT, {"packing_fraction": [0.4, 0.6]}), "slab": (slab, {})}
    )
    dataset = freezing_spheres(points, {})
    assert dataset["crystalline"].values.tolist() == [[0, 1]]
    assert (dataset["Z"] / dataset["reference"]).values[0] == pytest.approx(1.0, abs=0.02)
    assert dataset["finite_size"].values[0, 1] == pytest.approx(-(15.4 - 1.0) / 108, rel=0.05)
    assert float(dataset["slab_pressure"]) == pytest.approx(11.5, abs=1.0)
    assert dataset["slab_density"].mean() == pytest.approx(305 / (80 * EDGE**3), rel=1e-6)


def verdict(found, text):
    return next(verdict for claim, verdict in found.items() if text in claim)


def test_discs_as_the_literature_has_them_agree():
    found = judged(claims.freezing_discs(discs()))
    assert len(found) == 9
    plateaus = [found.pop(text) for text in list(found) if text.startswith("plateau pressure of discs in")]
    assert plateaus == ["no verdict"] * 2  # of 1024 discs, beside the literature's 10^6
    assert set(found.values()) == {"agrees"}


def test_the_crystal_of_discs_is_compared_in_a_system_of_the_same_size():
    data = discs()
    data["count"] = data["count"] * 4
    assert not any("1024" in text for text in judged(claims.freezing_discs(data)))


def test_the_liquid_of_discs_is_compared_where_it_is_published():
    data = discs()
    elsewhere = data.assign_coords(compared_packing_fraction=data["compared_packing_fraction"] + 0.001)
    without = data.drop_dims("compared_packing_fraction")
    for changed in (elsewhere, without):
        assert not any("870" in text for text in judged(claims.freezing_discs(changed)))


def test_the_liquid_of_discs_must_be_known_well():
    data = discs()
    data["compared_pressure_error"] = data["compared_pressure_error"] * 4
    found = judged(claims.freezing_discs(data))
    assert {verdict(found, f"870 discs at packing fraction {eta}") for eta in (0.68, 0.7)} == {"inconclusive"}


def test_spheres_as_the_literature_has_them_agree():
    found = judged(claims.freezing_spheres(spheres()))
    assert sum("Z of the crystal" in text for text in found) == 3
    assert (
        found.pop("Z of the crystal at packing fraction 0.5, from the crystal") == "no verdict"
    )  # superheated
    assert sum("Z of the fluid" in text for text in found) == 5
    assert set(found.values()) == {"agrees"}


def test_a_wrong_pressure_of_coexistence_disagrees():
    data = spheres()
    data["slab_pressure"] = data["slab_pressure"] * 1.05
    assert verdict(judged(claims.freezing_spheres(data)), "k_B T / sigma^3 (within") == "disagrees"


def changed(dataset, name, value, **where):
    dataset = dataset.copy(deep=True)
    dataset[name].loc[where] = value
    return dataset


@pytest.mark.parametrize(
    ("name", "value", "where", "text"),
    [
        ("plateau", 9.35, {"start": "fluid"}, "from the crystal minus"),
        (
            "compared_pressure",
            8.53,
            {"compared_packing_fraction": 0.68, "start": "crystal"},
            "870 discs at p",
        ),
        ("compared_pressure", 8.53, {"compared_packing_fraction": 0.68, "start": "fluid"}, "870 discs at p"),
        ("compared_pressure", 9.15, {"compared_packing_fraction": 0.7, "start": "fluid"}, "fraction 0.7,"),
        ("pressure", 9.6, {"packing_fraction": 0.725, "start": "crystal"}, "crystal of 1024"),
        ("order", 0.6, {"packing_fraction": 0.68, "start": "crystal"}, "most ordered"),
        ("order", 0.3, {"packing_fraction": 0.725, "start": "fluid"}, "least ordered"),
    ],
)
def test_each_claim_about_discs_can_fail(name, value, where, text):
    data = discs()
    if "packing_fraction" in where:
        eta = float(
            data["packing_fraction"].sel(packing_fraction=where["packing_fraction"], method="nearest")
        )
        where = {**where, "packing_fraction": eta}
    found = judged(claims.freezing_discs(changed(data, name, value, **where)))
    assert verdict(found, text) == "disagrees"


def test_discs_out_of_equilibrium_are_inconclusive():
    data = discs()
    data["plateau_error"] = data["plateau_error"] * 10
    data["disagreement"] = data["disagreement"] + 5.0
    found = judged(claims.freezing_discs(data))
    assert verdict(found, "from the crystal minus") == "inconclusive"
    assert verdict(found, "starts or halves differ") in ("inconclusive", "disagrees")


@pytest.mark.parametrize(
    ("name", "value", "where", "text"),
    [
        ("order", 0.35, {"packing_fraction": 0.45, "start": "crystal"}, "largest global"),
        ("order", 0.3, {"packing_fraction": 0.56, "start": "crystal"}, "smallest global"),
        ("Z", 12.0, {"packing_fraction": 0.56, "start": "crystal"}, "crystal at packing fraction 0.56"),
        ("Z", 12.0, {"packing_fraction": 0.5, "start": "fluid"}, "fluid at packing fraction 0.5"),
        ("slab_drift", 0.6, {}, "second half"),
        ("crystal_fraction", 0.95, {}, "crystalline at the end"),
    ],
)
def test_each_claim_about_spheres_can_fail(name, value, where, text):
    found = judged(claims.freezing_spheres(changed(spheres(), name, value, **where)))
    assert verdict(found, text) == "disagrees"


def test_a_crystal_that_creeps_is_less_certain():
    data = changed(spheres(), "pressure_drift", 0.5, packing_fraction=0.56, start="crystal")
    found = judged(claims.freezing_spheres(data))
    assert verdict(found, "crystal at packing fraction 0.56") == "inconclusive"


ETA = "packing_fraction"


def filled_and_hollow(starts, name):
    """For each start the points in equilibrium, and those that are not."""
    chosen = [(one, (one["disagreement"] <= figure.EQUILIBRATED).values) for one in starts]
    parts = [one.isel({ETA: part}) for one, filled in chosen for part in (filled, ~filled)]
    return [column(part, ETA, name) for part in parts if part.sizes[ETA]]


def test_discs_with_plateau_order_and_structure():
    ds = varied(discs(), "disagreement")
    ds["g"] = ds["g"] * np.linspace(0.5, 1.5, 20)
    pressure, order, g, *pictures = draw(figure.freezing_discs, ds).axes
    starts = [ds.sel(start=name) for name in ds["start"].values]
    shows(pressure, *(column(one, ETA, "pressure") for one in starts))
    shows(order, *(column(one, ETA, "order") for one in starts))
    for k, one in enumerate(lines(g)):
        follows(one, ds["distance"], ds["g"][k] + 2.0 * k)
    for k in range(3):
        at, (snapshot, scattering) = ds.isel(shown=k), pictures[2 * k : 2 * k + 2]
        (particles,) = snapshot.collections
        assert particles.get_offsets() == pytest.approx(np.stack([at["x"], at["y"]], axis=1))
        angle = np.mod(at["angle"].values / np.pi + 0.5, 2.0)
        assert np.asarray(particles.get_array()) == pytest.approx(angle)
        (mesh,) = scattering.collections
        assert np.asarray(mesh.get_array()) == pytest.approx(at["structure_factor"].values.T)


def test_it_draws_discs_from_one_side_and_without_a_plateau():
    data = discs().isel(start=[0])
    data["plateau"] = data["plateau"] * np.nan
    pressure = draw(figure.freezing_discs, data).axes[0]
    shows(pressure, column(data.isel(start=0), ETA, "pressure"))


def test_spheres_and_the_slab():
    ds = varied(spheres(), "disagreement")
    pressure, residual, order, slab, density = draw(figure.freezing_spheres, ds).axes
    starts = [ds.sel(start=name).dropna(ETA, subset=["pressure"]) for name in ds["start"].values]
    slab_point = Points([0.517], [ds["slab_pressure"]], [ds["slab_error"]])
    shows(pressure, *filled_and_hollow(starts, "pressure"), slab_point)
    ratios = []
    for one in (start.dropna(ETA, subset=["reference"]) for start in starts):
        percent, error = (
            100.0 * (one["Z"] / one["reference"] - 1.0),
            100.0 * one["Z_error"] / one["reference"],
        )
        ratios.append(one.assign(percent=percent, percent_error=error))
    shows(residual, *filled_and_hollow(ratios, "percent"))
    shows(order, *filled_and_hollow(starts, "order"))
    for half in (0, 1):
        follows(lines(slab)[half], ds["position"], ds["slab_order"][half])
        follows(lines(density)[half], ds["position"], ds["slab_density"][half])


def test_points_out_of_equilibrium_are_hollow():
    data = discs()
    data["disagreement"] = data["disagreement"] + 5.0
    drawn = draw(figure.freezing_discs, data).axes[0].lines
    faces = {line.get_markerfacecolor() for line in drawn if line.get_marker() in ("o", "s")}
    assert faces == {"white"}
