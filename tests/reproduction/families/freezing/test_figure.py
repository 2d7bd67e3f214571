import numpy as np
import pytest
from reproduction.families.drawn import Points, column, draw, follows, line, lines, obeys, shows, varied
from reproduction.families.freezing.data import discs, spheres

from gaspart import theory
from gaspart.reproduction.families.freezing import figure as freezing

ETA = "packing_fraction"


def filled_and_hollow(start, label, name):
    """The points of a start in equilibrium, and those that are not."""
    chosen = (start["disagreement"] <= freezing.EQUILIBRATED).values
    parts = (start.isel({ETA: chosen}), label), (start.isel({ETA: ~chosen}), None)
    return [column(part, label, ETA, name) for part, label in parts if part.sizes[ETA]]


def test_discs_with_plateau_order_and_structure():
    ds = varied(discs(), "disagreement")
    ds["g"] = ds["g"] * np.linspace(0.5, 1.5, 20)
    pressure, order, g, *pictures = draw(freezing.freezing_discs, ds).axes
    starts = [ds.sel(start=name) for name in ds["start"].values]
    names = [f"from the {name}" for name in ds["start"].values]
    shows(
        pressure, "", "pressure",
        *(column(one, name, ETA, "pressure") for one, name in zip(starts, names, strict=True)),
    )  # fmt: skip
    shows(order, "packing fraction", "psi_6", *(column(one, None, ETA, "order") for one in starts))
    area = np.pi / 4.0
    obeys(line(pressure, "virial"), lambda x: x / area * theory.compressibility_factor(x, 2))
    obeys(line(pressure, "AHY"), lambda x: x / area * theory.alder_hoover_young_crystal(x, 2))
    plateaus = [one for one in lines(pressure) if str(one.get_label()).startswith("_")]
    for one, start in zip(plateaus, starts, strict=True):
        follows(one, [start["plateau_low"], start["plateau_high"]], [start["plateau"]] * 2)
    for k, one in enumerate(lines(g)):
        follows(one, ds["distance"], ds["g"][k] + 2.0 * k)
        assert one.get_label() == f"{float(ds['shown'][k]):.3g}"
    for k in range(3):
        at, (snapshot, scattering) = ds.isel(shown=k), pictures[2 * k : 2 * k + 2]
        (particles,) = snapshot.collections
        assert particles.get_offsets() == pytest.approx(np.stack([at["x"], at["y"]], axis=1))
        assert np.asarray(particles.get_array()) == pytest.approx(
            np.mod(at["angle"].values / np.pi + 0.5, 2.0)
        )
        assert f"{float(at['shown']):.3g}" in snapshot.get_title()
        (mesh,) = scattering.collections
        assert np.asarray(mesh.get_array()) == pytest.approx(at["structure_factor"].values.T)


def test_it_draws_discs_from_one_side_and_without_a_plateau():
    data = discs().isel(start=[0])
    data["plateau"] = data["plateau"] * np.nan
    pressure = draw(freezing.freezing_discs, data).axes[0]
    shows(pressure, "", "pressure", column(data.isel(start=0), "from the", ETA, "pressure"))
    assert all(not str(one.get_label()).startswith("_") for one in lines(pressure))


def test_spheres_and_the_slab():
    ds = varied(spheres(), "disagreement")
    pressure, residual, order, slab, density = draw(freezing.freezing_spheres, ds).axes
    starts = [ds.sel(start=name).dropna(ETA, subset=["pressure"]) for name in ds["start"].values]
    names = [f"from the {name}" for name in ds["start"].values]
    labelled = zip(starts, names, strict=True)
    slab_point = Points("coexistence", [0.517], [ds["slab_pressure"]], [ds["slab_error"]])
    points = [one for start, name in labelled for one in filled_and_hollow(start, name, "pressure")]
    shows(pressure, "", "pressure", *points, slab_point)
    volume = np.pi / 6.0
    obeys(line(pressure, "KLM"), lambda x: x / volume * theory.compressibility_factor(x, 3))
    obeys(line(pressure, "Speedy"), lambda x: x / volume * theory.speedy_crystal(x))
    on_branch = [one.dropna(ETA, subset=["reference"]) for one in starts]
    ratios = [
        one.assign(
            percent=100.0 * (one["Z"] / one["reference"] - 1.0),
            percent_error=100.0 * one["Z_error"] / one["reference"],
        )
        for one in on_branch
    ]
    points = [part for one in ratios for part in filled_and_hollow(one, None, "percent")]
    shows(residual, "", "branch", *points)
    points = [part for one in starts for part in filled_and_hollow(one, None, "order")]
    shows(order, "packing fraction", "Q_6", *points)
    assert "position" in slab.get_xlabel() and "q_6" in slab.get_ylabel()
    assert "density" in density.get_ylabel()
    for half in (0, 1):
        follows(lines(slab)[half], ds["position"], ds["slab_order"][half])
        follows(lines(density)[half], ds["position"], ds["slab_density"][half])


def test_points_out_of_equilibrium_are_hollow():
    data = discs()
    data["disagreement"] = data["disagreement"] + 5.0
    figure = draw(freezing.freezing_discs, data)
    faces = {line.get_markerfacecolor() for line in figure.axes[0].lines if line.get_marker() in ("o", "s")}
    assert faces == {"white"}
