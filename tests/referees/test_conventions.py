"""Rows of docs/conventions.md: the factor between a number of another program and gaspart's."""

from pathlib import Path

import emcee
import freud
import MDAnalysis
import numpy as np
import pytest
from heaps import lammps
from MDAnalysis.analysis.rdf import InterRDF
from pymbar import timeseries

SIDE = 10.0
PAGE = Path(__file__).parents[2] / "docs/conventions.md"


def points(count, seed=1, dimension=3):
    """Independent points in a box about the origin, z = 0 in two dimensions."""
    places = np.random.default_rng(seed).uniform(-0.5 * SIDE, 0.5 * SIDE, (count, 3)).astype(np.float32)
    places[:, dimension:] = 0.0
    return places


def box(dimension=3):
    return freud.box.Box.square(SIDE) if dimension == 2 else freud.box.Box.cube(SIDE)


def test_as_many_rows_are_marked_as_are_tested():
    assert sum(" * |" in line for line in PAGE.read_text(encoding="utf-8").splitlines()) == 8


def test_pairs_of_g_are_those_of_all_squared_in_freud_by_default():
    count, found = 20, {}
    for mode in ("exact", "finite_size"):
        g = freud.density.RDF(bins=4, r_max=4.0, normalization_mode=mode)
        for seed in range(10):
            g.compute((box(), points(count, seed)), reset=False)
        found[mode] = g.rdf
    default = freud.density.RDF(bins=4, r_max=4.0)
    for seed in range(10):
        default.compute((box(), points(count, seed)), reset=False)
    assert np.array_equal(default.rdf, found["exact"])
    assert np.allclose(found["exact"] * count / (count - 1), found["finite_size"], rtol=1e-5)


def test_shells_in_a_slab_are_no_annuli():
    count, height, frames = 200, 12.0, []
    frames = np.array([points(count, seed, 2) for seed in range(40)]) + 0.5 * SIDE
    made = MDAnalysis.Universe.empty(count, trajectory=True)
    made.load_new(frames, dimensions=np.array([SIDE, SIDE, height, 90.0, 90.0, 90.0]))
    found = InterRDF(made.atoms, made.atoms, nbins=20, range=(0.0, 4.0), exclusion_block=(1, 1)).run().results
    edges = np.linspace(0.0, 4.0, 21)
    pairs = np.zeros(20)
    for places in frames:
        apart = places[:, None, :2] - places[None, :, :2]
        apart -= SIDE * np.round(apart / SIDE)
        pairs += np.histogram(np.sqrt((apart**2).sum(axis=2))[np.triu_indices(count, 1)], edges)[0]
    ours = pairs / (len(frames) * 0.5 * count * (count - 1) * np.pi * np.diff(edges**2) / SIDE**2)
    assert ours.mean() == pytest.approx(1.0, abs=0.02)
    inner = found.bins > 1.0  # to first order in the width of a bin
    assert np.allclose((found.rdf * 2.0 * found.bins / height)[inner], ours[inner], rtol=5e-3)


def test_mean_squared_displacements_of_others_are_about_the_origin():
    time = np.arange(30.0)[:, None, None]
    paths = points(50) + 0.1 * time * np.array([1.0, 0.0, 0.0])
    drifting = freud.msd.MSD(mode="window").compute(paths).msd
    assert np.allclose(drifting[1:], 0.01 * np.arange(1, 30) ** 2, rtol=1e-3, atol=1e-4)
    about = paths - (paths.mean(axis=1, keepdims=True) - paths[:1].mean(axis=1, keepdims=True))
    assert np.abs(freud.msd.MSD(mode="window").compute(about - about[:1]).msd).max() < 1e-9


def test_the_structure_factor_of_freud_has_an_octant_and_zero():
    count, step = 600, 2.0 * np.pi / SIDE
    rng, places = np.random.default_rng(2), []
    while len(places) < count:  # a wave along (2, -2, 0)
        place = rng.uniform(-0.5 * SIDE, 0.5 * SIDE, 3)
        if rng.random() < 0.5 * (1.0 + np.cos(2.0 * step * (place[0] - place[1]))):
            places.append(place)
    places = np.array(places)
    wave, mirrored = step * np.array([2.0, -2.0, 0.0]), step * np.array([2.0, 2.0, 0.0])
    along, other = (abs(np.exp(1j * places @ k).sum()) ** 2 / count for k in (wave, mirrored))
    assert along > 50.0 > 10.0 > other
    made = freud.diffraction.StaticStructureFactorDirect(bins=100, k_max=step * 4.0, num_sampled_k_points=0)
    made.compute((box(), places))
    at = np.argmin(np.abs(made.bin_centers - np.linalg.norm(wave)))
    assert np.nanmax(made.S_k[at - 1 : at + 2]) < 10.0  # the wave is in no octant
    assert made.S_k[0] == pytest.approx(count, rel=1e-3)  # k = 0


def test_bonds_of_psi_6_are_the_six_nearest_by_default():
    system = box(2), points(300, dimension=2)
    default = freud.order.Hexatic(6).compute(system).particle_order
    nearest = freud.order.Hexatic(6).compute(system, neighbors={"num_neighbors": 6}).particle_order
    voronoi = freud.order.Hexatic(6).compute(system, neighbors=freud.locality.Voronoi().compute(system).nlist)
    assert np.array_equal(default, nearest)
    assert np.abs(voronoi.particle_order - default).max() > 0.3


@pytest.mark.parametrize(("dimension", "weight"), [(3, 0.25), (2, 1.0 / 12.0)])
def test_local_density_grows_with_the_diameter(dimension, weight):
    diameter, reach, found = 1.0, 2.0, {}
    for size in (0.0, diameter):
        means = []
        for seed in range(30):
            made = freud.density.LocalDensity(reach, size)
            means.append(made.compute((box(dimension), points(500, seed, dimension))).density.mean())
        found[size] = np.mean(means)
    assert found[diameter] / found[0.0] == pytest.approx(1.0 + weight * diameter**2 / reach**2, abs=3e-3)


def test_the_temperature_of_lammps_has_3_n_minus_3_degrees_of_freedom_between_walls(folder):
    made = lammps()
    commands = f"units lj\natom_style sphere\nboundary f f f\nread_data {folder / 'reader_walls.data'}\n"
    made.commands_string(f"{commands}pair_style zero 1.5\npair_coeff * *\nthermo_style custom step temp ke\n")
    made.commands_string("thermo_modify norm no\nrun 0")
    count, energy = made.get_natoms(), made.get_thermo("ke")
    ours = 2.0 * energy / (3.0 * count)
    assert made.get_thermo("temp") * (count - 1.0) / count == pytest.approx(ours, rel=1e-9)


def test_correlation_times_of_others_are_twice_ours():
    memory, size = 0.8, 200_000
    rng = np.random.default_rng(5)
    series = np.zeros(size)
    for n, kick in enumerate(rng.standard_normal(size)):
        series[n] = memory * series[n - 1] + kick
    ours = 0.5 + memory / (1.0 - memory)
    assert timeseries.statistical_inefficiency(series) == pytest.approx(2.0 * ours, rel=0.05)
    assert emcee.autocorr.integrated_time(series, c=5)[0] == pytest.approx(2.0 * ours, rel=0.05)
