"""Table of the properties of each species of a run."""

from __future__ import annotations

from contextlib import nullcontext
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from gaspart.analysis.flow import mean_motion
from gaspart.analysis.observable import Observable, scalar
from gaspart.analysis.observables import observables_with, selecting
from gaspart.analysis.run import Run, Source, measure_single, open_run, select_particles
from gaspart.analysis.run_data import FLOW
from gaspart.errors import SceneError
from gaspart.trajectory.reading import open_trajectory


def by_species(source: Source, start: float | None = None, about: str = FLOW) -> xr.Dataset:
    """Measure the properties of each moving species.

    Relative to the centre of mass, the mean squared velocity of a particle of mass m is reduced by the factor
    1 - m / M. M is the total mass of the particles whose mean velocity is subtracted. Temperatures and speeds
    are corrected by this factor, which is exact in equilibrium. Call `to_dataframe` on the variables without
    lags to obtain a table with one row per species.

    Parameters
    ----------
    about : {"flow", "rest"}, default "flow"
        Frame of reference. "flow": velocities and paths are relative to the local flow if the gas flows.
        Otherwise they are relative to the centre of mass, along axes on which the total momentum is conserved
        (see `gaspart.analysis.flow`). "rest": relative to the container.

    Returns
    -------
    Dataset
        Properties (species,) with standard uncertainties (suffix _error). The coordinate `species` contains
        the numbers of the scene; single particles have the number after the last species. Variables:

        - `count`, number of moving particles;
        - `temperature` [energy], twice the mean translational energy per degree of freedom;
        - `mean_speed` [length/time];
        - `D` [length^2/time], and the curves `msd` and `vacf` (species, lag), as by `gaspart measure` with a
          species. The value is NaN if the quantity is undefined for a species, such as D between walls, or if
          the species has fewer lags than other species. The attribute `not_measured` states the reason.

    Raises
    ------
    SceneError
        If nothing moves, or there are too few frames.

    Examples
    --------
    >>> import gaspart as gp
    >>> scene = gp.Scene(gp.Container((9.0, 9.0)), [gp.Species(20, 0.2, temperature=1.0)])
    >>> simulation = gp.Simulation(scene, seed=1)
    >>> simulation.advance(40.0)
    >>> gp.analysis.by_species(simulation)["count"].values.tolist()
    [20]
    """
    opened = open_trajectory(source) if isinstance(source, str | Path) else nullcontext(source)
    with opened as run_of_all:
        with open_run(run_of_all, start, about=about) as run:
            kinds = [int(kind) for kind in np.unique(run.species[run.moving])]
            if not kinds:
                raise SceneError("species", [], "none of the particles moves")
            counts = [int((run.species[run.moving] == kind).sum()) for kind in kinds]
            rows: list[dict[str, Observable]] = [_of_velocities(run, kind) for kind in kinds]
        missing = {}
        for kind, row in zip(kinds, rows, strict=True):
            for name in _of_motion():
                try:
                    row[name] = measure_single(run_of_all, name, start, species=kind, about=about)
                except SceneError as error:
                    missing[f"{name} of species {kind}"] = error.rule
    table = xr.Dataset(coords={"species": ("species", kinds, {"long_name": "number of the species"})})
    table["count"] = ("species", counts, {"units": "1", "long_name": "moving particles"})
    for name in ("temperature", "mean_speed", *_of_motion()):
        table = table.merge(
            _column(name, [row.get(name) for row in rows]), join="outer", compat="no_conflicts"
        )
    reasons = "; ".join(f"{subject}: {reason}" for subject, reason in missing.items())
    return table.assign_attrs(not_measured=reasons)


def _of_motion() -> tuple[str, ...]:
    """Return the observables of motion that can be measured for each species."""
    return tuple(name for name in selecting("species") if name in observables_with(scatter="particles"))


def _of_velocities(run: Run, kind: int) -> dict[str, Observable]:
    """Measure the temperature and the mean speed of the moving particles of a species."""
    chosen, masses = select_particles(run, kind, None), run.masses[run.moving]
    peculiar, rows = mean_motion(run), []
    for _, part in run.parts():
        motion = peculiar(part)
        free = np.broadcast_to(motion.freedom, motion.velocities.shape)
        # C order, in which sums have the same bits for any number of frames
        velocities, free = (each.take(chosen, axis=1) for each in (motion.velocities, free))
        energies = (masses[chosen] * (velocities**2).sum(axis=2)).sum(axis=1)
        is_known = (free > 0.0).all(axis=2)  # not alone in its flow cell
        squares = np.divide(velocities**2, free, out=np.zeros(free.shape), where=free > 0.0).sum(axis=2)
        speeds = (np.sqrt(squares) * is_known).sum(axis=1)
        rows.append([energies, free.sum(axis=(1, 2)), speeds, is_known.sum(axis=1)])
    energies, freedoms, speeds, numbers = np.concatenate(rows, axis=1)
    if not freedoms.any():
        raise SceneError("count", len(masses), "a single particle keeps its velocity")
    energies = energies / freedoms.mean()
    speeds = speeds / numbers.mean()
    edges = np.append(run.time, 2.0 * run.time[-1] - run.time[-2])
    about: dict[str, Any] = {"units": "energy", "long_name": "temperature"}
    temperature = scalar("temperature", energies, edges, **about)
    about = {"units": "length / time", "long_name": "mean speed"}
    return {
        "temperature": temperature,
        "mean_speed": scalar("mean_speed", speeds, edges, **about),
    }


def _column(name: str, results: list[Observable | None]) -> xr.Dataset:
    """Combine the values of one observable for all species, with uncertainties. The result is empty if the
    observable could not be measured for any species.
    """
    available = [result for result in results if result is not None]
    if not available:
        return xr.Dataset()
    blank = xr.full_like(available[0].estimate, np.nan)
    parts = {
        name: [blank if result is None else result.estimate for result in results],
        f"{name}_error": [blank if result is None else result.error for result in results],
    }
    columns = {}
    for key, values in parts.items():
        plain = [value.drop_vars("time", errors="ignore") for value in values]
        column = xr.concat(plain, "species", join="outer", compat="equals")  # fewer particles give fewer lags
        columns[key] = column.rename(key).assign_attrs(values[0].attrs)
    columns[name].attrs.update(available[0].estimate.attrs)
    columns[f"{name}_error"].attrs.update(available[0].error.attrs)
    return xr.Dataset(columns)
