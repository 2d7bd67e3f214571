"""MDAnalysis, mdtraj and freud: g(r) and mean-squared displacement from the file."""

import freud
import MDAnalysis
import mdtraj
import numpy as np
from finding import PART, Finding
from MDAnalysis.analysis.msd import EinsteinMSD
from MDAnalysis.analysis.rdf import InterRDF
from MDAnalysis.transformations import NoJump

AT_PEAK = 0.005
"""Allowed difference of g(r), over its largest value: single precision moves pairs across ends of bins."""
OF_MSD = 1e-3
"""Allowed relative difference of a mean-squared displacement of the same frames."""


def universe(folder, **options):
    frames = folder / "gas.nc"
    number = np.load(folder / "gas.npz")["positions"].shape[1]
    made = MDAnalysis.Universe.empty(number, trajectory=True)
    made.load_new(str(frames), format="NCDF", convert_units=False, **options)
    return made


def rdf(folder, distance, theirs):
    """The largest difference from gaspart's g(r), over its largest value."""
    ours = np.load(folder / "gas.npz")
    assert np.allclose(distance, ours["distance"], atol=1e-5)
    peak = int(np.argmax(ours["rdf"]))
    difference = np.abs(theirs - ours["rdf"]).max() / ours["rdf"][peak]
    at = f"{{:.4f}} at {distance[peak]:.3f}"
    return Finding(at.format(ours["rdf"][peak]), at.format(theirs[peak]), float(difference), AT_PEAK, PART)


def mdanalysis_rdf(folder):
    ours = np.load(folder / "gas.npz")["distance"]
    made = universe(folder)
    end = ours[-1] + 0.5 * (ours[1] - ours[0])
    # a particle is no neighbour of its own
    found = InterRDF(made.atoms, made.atoms, nbins=ours.size, range=(0.0, end), exclusion_block=(1, 1)).run()
    return rdf(folder, found.results.bins, found.results.rdf)


def mdtraj_rdf(folder):
    ours = np.load(folder / "gas.npz")["distance"]
    with mdtraj.formats.NetCDFTrajectoryFile(str(folder / "gas.nc")) as file:
        positions, time, lengths, angles = file.read()
    topology = mdtraj.Topology()
    chain = topology.add_chain()
    for _ in range(positions.shape[1]):
        topology.add_atom("A", mdtraj.element.argon, topology.add_residue("A", chain))
    frames = mdtraj.Trajectory(positions, topology, time, lengths, angles)
    end = ours[-1] + 0.5 * (ours[1] - ours[0])
    pairs = topology.select_pairs("all", "all")
    distance, found = mdtraj.compute_rdf(frames, pairs, r_range=(0.0, end), n_bins=ours.size)
    return rdf(folder, distance, found)


def msd(folder, theirs):
    """The largest relative difference from gaspart's mean-squared displacement, over all lags but 0."""
    ours = np.load(folder / "gas.npz")
    number, lags = ours["positions"].shape[1], ours["msd"].size
    theirs = theirs[:lags] * number / (number - 1.0)  # which gaspart applies about the centre of mass
    difference = np.abs(theirs[1:] / ours["msd"][1:] - 1.0).max()
    last = f"{{:.4f}} after {ours['times'][lags - 1]:g}"
    return Finding(last.format(ours["msd"][-1]), last.format(theirs[-1]), float(difference), OF_MSD, PART)


def mdanalysis_msd(folder):
    made = universe(folder)
    made.trajectory.add_transformations(NoJump(check_continuity=False), about_centre)
    return msd(folder, EinsteinMSD(made, select="all", fft=False).run().results.timeseries)


def about_centre(frame):
    """A transformation of MDAnalysis: positions about the centre of mass, of equal particles."""
    frame.positions -= frame.positions.mean(axis=0)
    return frame


def freud_msd(folder):
    """From positions about the centre of mass, continued here by the shortest way from frame to frame."""
    with mdtraj.formats.NetCDFTrajectoryFile(str(folder / "gas.nc")) as file:
        positions, _, lengths, _ = file.read()
    steps = np.diff(positions.astype(float), axis=0)
    steps -= lengths[0] * np.round(steps / lengths[0])
    paths = np.concatenate([np.zeros((1, *steps.shape[1:])), np.cumsum(steps, axis=0)])
    paths -= paths.mean(axis=1, keepdims=True)
    return msd(folder, freud.msd.MSD(mode="window").compute(paths).msd)
