import numpy as np
import pytest
from reproduction.families.drawn import Points, column, draw, follows, lines, shows, varied
from reproduction.families.freezing.data import discs, spheres

from gaspart.reproduction.families.freezing import figure as freezing

ETA = "packing_fraction"


def filled_and_hollow(starts, name):
    """For each start the points in equilibrium, and those that are not."""
    chosen = [(one, (one["disagreement"] <= freezing.EQUILIBRATED).values) for one in starts]
    parts = [one.isel({ETA: part}) for one, filled in chosen for part in (filled, ~filled)]
    return [column(part, ETA, name) for part in parts if part.sizes[ETA]]


def test_discs_with_plateau_order_and_structure():
    ds = varied(discs(), "disagreement")
    ds["g"] = ds["g"] * np.linspace(0.5, 1.5, 20)
    pressure, order, g, *pictures = draw(freezing.freezing_discs, ds).axes
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
    pressure = draw(freezing.freezing_discs, data).axes[0]
    shows(pressure, column(data.isel(start=0), ETA, "pressure"))


def test_spheres_and_the_slab():
    ds = varied(spheres(), "disagreement")
    pressure, residual, order, slab, density = draw(freezing.freezing_spheres, ds).axes
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
    drawn = draw(freezing.freezing_discs, data).axes[0].lines
    faces = {line.get_markerfacecolor() for line in drawn if line.get_marker() in ("o", "s")}
    assert faces == {"white"}
