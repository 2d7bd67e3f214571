"""Brownian motion of a large particle in a gas: paths, displacement, velocity autocorrelation, friction.

The scene's only single particle is tracked; the gas is its only species. A heavy particle is compared with
Langevin's equation, a light one with the linear Boltzmann equation. The unit of time of theory is the
friction time, from the density of the gas outside the particle.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.analysis.estimate import Estimate
from gaspart.analysis.motion import correlate
from gaspart.analysis.statistics import bootstrap, means_of
from gaspart.errors import SceneError
from gaspart.keys import count
from gaspart.rendering import style
from gaspart.rendering.style import Axes, Figure
from gaspart.reproduction.claims import Claim
from gaspart.reproduction.figure import Parts, runs
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Row, Table, table
from gaspart.theory.boltzmann import relaxing_speeds, tagged_paths
from gaspart.theory.brownian import friction_rate, langevin_msd, langevin_msd_from_rest, tagged_diffusion

TITLE, CHAPTER = "A large particle in a gas", "Motion and its memory"
# Largest mass ratio at which the linear Boltzmann equation is solved. Langevin's is exact in the limit; at
# equal masses the velocity autocorrelation decays 0.6 % more slowly, up to half a friction time.
HEAVY = 10.0
# Groups of paths of that equation, with a path for each replica of the point, at most MOST: theory's error is
# the measurement's over sqrt(200), or the error of 60 000 paths.
GROUPS, MOST = 200, 300
GAS = 100_000  # particles from whose speeds the speeds of hitting particles are drawn
LONGEST, LONGEST_DRAWN = 8.0, 3.2  # friction times of the curves, and of the drawn autocorrelation
FRICTION_TO, DIFFUSION_AT = 0.5, 5.0  # friction times: decay of C up to the first, displacement at the second

Path = tuple[np.ndarray, np.ndarray, np.ndarray]
"""Times (T,), displacements and velocities (T, N, 3)."""


class Sphere:
    """Large particle and its gas; `share` of the total mass, 0 if walls take momentum."""

    def __init__(self, point: Point) -> None:
        scene = point.scene
        if len(scene.particles) != 1 or len(scene.species) != 1:
            rule = "must have one entry of particles and one species"
            raise SceneError(f"experiments.{point.experiment}.scene", point.settings.get("scene"), rule)
        particle, gas = scene.particles[0], scene.species[0]
        self.point, self.gas = point, gas
        self.mass, self.gas_mass, self.radius = particle.mass, gas.mass, particle.radius
        self.temperature, self.contact = gas.initial_temperature(3), particle.radius + gas.radius
        lower, upper = scene.reach(gas.radius)
        room = math.prod(b - a for a, b in zip(lower, upper, strict=True))
        density = gas.count / (room - theory.particle_volume(3, 2.0 * self.contact))
        of = self.mass, self.gas_mass, self.temperature
        self.friction = float(friction_rate(density, self.contact, *of))
        self.diffusion = float(tagged_diffusion(self.friction, *of))
        self.share = self.mass / (self.mass + gas.count * gas.mass) if scene.is_periodic else 0.0
        self.mean_free_path = 1.0 / (math.sqrt(2.0) * math.pi * density * (2.0 * gas.radius) ** 2)
        self.is_light = self.mass <= HEAVY * self.gas_mass
        self.equal_speeds, self.stepped = gas.speed is not None, point.settings.get("engine") == "step"
        self.replicas = point.replicas

    def facts(self) -> dict[str, Any]:
        """Return the columns that every row has."""
        return {name: value for name, value in vars(self).items() if name not in ("point", "gas")}

    def light_paths(self) -> Iterator[Path]:
        """Yield groups of paths of the linear Boltzmann equation from rest, sampled like the runs. A gas of
        equal speeds relaxes meanwhile, by its own collisions.
        """
        schedule = self.point.schedule
        interval, frames = schedule.sample_interval, schedule.equilibration_frames + schedule.samples
        # n pi d^2, from the mean free path 1 / (sqrt(2) n pi d^2) of a gas with Maxwell's distribution
        own = 1.0 / (math.sqrt(2.0) * self.mean_free_path)
        if self.gas.speed is not None:
            middle = interval * (np.arange(frames) + 0.5)
            speeds = self.gas.speed * relaxing_speeds(GAS, self.gas.speed * middle, own)
        else:
            thermal = math.sqrt(self.temperature / self.gas_mass)
            even = (np.arange(GAS) + 0.5) / GAS
            speeds = [np.asarray(theory.maxwell_ppf(even, 3, thermal**2))] * frames
        hits = own * (self.contact / (2.0 * self.gas.radius)) ** 2
        number = GROUPS * min(self.replicas, MOST)
        paths = tagged_paths(speeds, interval, hits, self.mass / self.gas_mass, number)
        for group in np.split(np.arange(number), GROUPS):
            time = interval * np.arange(frames + 1)
            yield time, paths.displacements[:, group], paths.velocities[:, group]

    def end_variance(self, duration: float) -> float:
        """Compute the mean square of a component of the final displacement, from rest. A periodic gas drifts
        with the mean square (1 - share) share k_B T / M along each axis, because the particle's momentum is
        drawn with the others.
        """
        if self.is_light:
            return float(np.mean([(moved[-1] ** 2).mean() for _, moved, _ in self.light_paths()]))
        rest = 1.0 - self.share
        slowed = rest**2 * self.diffusion, self.friction / rest
        variance = langevin_msd_from_rest(duration, *slowed, dimension=1)
        return float(variance + rest * self.share * self.temperature / self.mass * duration**2)

    def reduce(self, paths: Iterable[Path], share: float) -> tuple[dict[str, Any], dict[str, Estimate]]:
        """Return curves in reduced units, and equipartition, friction and diffusion of an infinite gas. A
        periodic gas drifts and absorbs the momentum that the particle loses: with s = `share` and the
        friction g, C(t) = (k_B T / M)(1 - s)(exp(-g' t) + s), g' = g / (1 - s). The constant part is
        subtracted; errors are bootstrap errors.
        """
        rest, equilibrium = 1.0 - share, self.temperature / self.mass
        rate, drop, curves = self.friction / rest, self.point.schedule.equilibration_frames, []
        for times, moved, velocities in paths:
            interval = (times[-1] - times[0]) / (len(times) - 1)
            lags = min(math.ceil(LONGEST / (rate * interval)), (len(times) - drop) // 2) + 1
            curves.append(correlate(moved[drop:], velocities[drop:], interval, lags))
        time, drift = rate * curves[0].time, rest * share * equilibrium
        if time[-1] < DIFFUSION_AT:
            where = f"experiments.{self.point.experiment}[{self.point.name}].duration"
            rule = f"must be {math.ceil(2.0 * DIFFUSION_AT / rate)} or more"
            raise SceneError(where, self.point.settings.get("duration"), rule)
        vacf = np.array([curve.correlation for curve in curves]) - drift
        msd = np.array([curve.msd for curve in curves]) - 3.0 * drift * curves[0].time ** 2
        late = int(np.argmin(np.abs(time - DIFFUSION_AT)))
        early = time[1 : max(2, np.searchsorted(time, FRICTION_TO) + 1)]
        langevin = float(langevin_msd(time[late], self.diffusion, 1.0)) * rest**2 / rate
        both = np.concatenate([vacf[:, : early.size + 1], msd[:, [late]]], axis=1)

        def decay(x: np.ndarray) -> float:
            """Compute the slope of a line through -ln C / C(0), which is 0 at lag 0."""
            logarithm = np.log(x[:, 1:-1].mean(axis=0) / x[:, 0].mean())
            return -float(early @ logarithm / (early @ early))

        derived = {
            "equipartition": lambda x: x[:, 0].mean() / (rest * equilibrium),
            "friction": lambda x: rest * rate * decay(x),
            "diffusion": lambda x: x[:, -1].mean() / langevin * self.diffusion,
        }
        return {
            "time": time,
            "msd": means_of(msd * rate**2 / (6.0 * rest * equilibrium)),
            "vacf": means_of(vacf / (rest * equilibrium)),
        }, {name: bootstrap(function, both) for name, function in derived.items()}


def measured_paths(point: Point) -> Iterator[Path]:
    """Yield the path of the large particle in each replica."""
    if not point.settings.get("displacements", False):
        raise SceneError(f"experiments.{point.experiment}.displacements", False, "must be true")
    for run in runs(point, first=0):
        velocities = run.data["velocities"].values[:, :1].astype(float)
        yield run.time, run.data["displacements"].values[:, :1], velocities


def measure_paths(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure the first `paths` paths, and the final displacements of all replicas."""
    return table("point", points, _ends, settings["paths"], inner=("path", "frame", "axis"))


def _ends(point: Point, paths: int) -> dict[str, Any]:
    sphere, tracks = Sphere(point), list(measured_paths(point))
    ends, duration = np.array([moved[-1, 0] for _, moved, _ in tracks]), float(tracks[0][0][-1])
    variance = sphere.end_variance(duration)
    return sphere.facts() | {
        "duration": duration,
        "way": np.array([moved[:, 0] for _, moved, _ in tracks[:paths]]),
        "end_variance": variance,
        "end_chi_square": float((ends**2).sum() / variance),
        "end_freedom": ends.size,
    }


def measure_msd(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure the curves of each point and the numbers derived from them, beside theory's (expected_...)."""
    return table("point", points, _statistics, inner=("lag",))


def _statistics(point: Point) -> dict[str, Any]:
    sphere = Sphere(point)
    curves, numbers = sphere.reduce(measured_paths(point), sphere.share)
    time, row = curves["time"], sphere.facts() | curves
    row |= {COEFFICIENTS[name][1]: number for name, number in numbers.items()}
    if sphere.is_light:
        solved, expected = sphere.reduce(sphere.light_paths(), 0.0)
        row |= {f"expected_{name}": solved[name][0][: len(time)] for name in ("vacf", "msd")}
    else:
        row |= {"expected_vacf": np.exp(-time), "expected_msd": _langevin(time)}
        exact = {"equipartition": 1.0, "friction": sphere.friction, "diffusion": sphere.diffusion}
        expected = {name: Estimate(value) for name, value in exact.items()}
    return row | {f"expected_{name}": number for name, number in expected.items()}


def _langevin(time: np.ndarray) -> np.ndarray:
    """Compute the mean-squared displacement of the Langevin equation in reduced units."""
    return np.asarray(langevin_msd(time, 1.0 / 6.0, 1.0))


BOLTZMANN = "the linear Boltzmann equation, direct simulation (gaspart.theory.boltzmann)"
COEFFICIENTS = {  # by key of theory: text, measured column, required relative uncertainty, fault
    "equipartition": (
        "equipartition M<V^2>/3kT", "equipartition", 0.03,
        "a particle with another energy than the gas gives it",
    ),
    "friction": ("friction rate", "measured_friction", 0.03, "a wrong momentum exchange"),
    "diffusion": ("diffusion coefficient", "measured_diffusion", 0.05, "memory"),
}  # fmt: skip
BY_BOTH = (  # text, column, required uncertainty of the ratio of both engines
    ("energy of the large particle", "equipartition", 0.04),
    ("friction rate", "measured_friction", 0.04),
    ("diffusion coefficient", "measured_diffusion", 0.08),
)


def _name(row: Row) -> str:
    gas = ", gas of equal speeds" if row.equal_speeds else ""
    steps = "time-stepped, " if row.stepped else ""
    return f"{steps}mass {row.mass / row.gas_mass:g} times a gas particle's{gas}"


def _source(row: Row) -> str:
    if not row.is_light:
        return "the Langevin equation with the friction of a dilute gas ([Chapman 1970])"
    if not row.equal_speeds:
        return BOLTZMANN
    return f"{BOLTZMANN}, in a gas that relaxes from equal speeds (gaspart.theory.boltzmann)"


def claim_paths(dataset: xr.Dataset) -> Iterator[Claim]:
    """Yield the claims on the distances from the start at the end of the paths."""
    for row in Table(dataset, "point"):
        yield Claim.chi_square(
            claim=f"ends of {row.replicas} paths over their variance from rest, {_name(row)}",
            chi_square=row.end_chi_square, degrees_of_freedom=row.end_freedom, source=_source(row),
            fails_if="paths that spread too far or too little, or are cut off by the walls",
        )  # fmt: skip


def claim_msd(dataset: xr.Dataset) -> Iterator[Claim]:
    """Yield the claims on equipartition, friction, diffusion and mean free path, and on both engines."""
    points = Table(dataset, "point")
    for row in points:
        for key, (text, measured, required, fault) in COEFFICIENTS.items():
            expected = row[f"expected_{key}"]
            yield Claim(
                f"{text}, {_name(row)}", row[measured], expected, required * expected.value,
                _source(row), fault,
                allowance_source="the statistical error of the direct simulation",
                alternative=_alternative(row, key),
                follows=key == "diffusion",  # nearly energy divided by friction
            )  # fmt: skip
        yield Claim.at_least(
            f"mean free path over the particle's radius, {_name(row)}",
            Estimate(row.mean_free_path / row.radius), 10.0, 1.0,
            "the friction is that of a gas whose particles do not collide near the large one",
            "a gas so dense that its own flow around the particle matters", kind="identity",
        )  # fmt: skip
    for steps in points[points.stepped]:
        for events in points[~points.stepped]:
            if any(steps[name] != events[name] for name in ("equal_speeds", "mass", "friction")):
                continue
            for text, key, required in BY_BOTH:
                yield Claim(
                    f"{text} by time steps over that by events, {_name(events)}",
                    steps[key] / events[key], 1.0, required,
                    "both engines solve the same equations of motion",
                    "contacts that time steps miss, count twice, or resolve along a wrong normal",
                    follows=True,
                )  # fmt: skip


def _alternative(row: Row, key: str) -> float | None:
    """Return the value in a gas in equilibrium, or, if it is, with the bare radius as contact distance."""
    if row.equal_speeds:
        return 1.0 if key == "equipartition" else float(row[key])
    bare = (row.radius / row.contact) ** 2
    factor = {"friction": bare, "diffusion": 1.0 / bare}.get(key)
    return factor and factor * float(row[f"expected_{key}"].value)


def draw_paths(dataset: xr.Dataset) -> Figure:
    """Draw paths from above, a panel for each point, with the sphere to scale."""
    from matplotlib.patches import Circle

    spheres = Table(dataset, "point")
    figure, axes = style.new(*((3.4,),) * len(spheres))
    for letter, axis, sphere in zip("abcdefgh", axes, spheres, strict=False):
        axis.add_patch(Circle((0.0, 0.0), sphere.radius, color=style.GREY, alpha=0.35, lw=0))
        for path, way in enumerate(sphere.way):
            colour = style.COLOURS[path % len(style.COLOURS)]
            axis.plot(way[:, 0], way[:, 1], color=colour, lw=0.7)
            end = way[np.isfinite(way[:, 0])][-1]
            axis.plot(*end[:2], color=colour, marker=style.MARKERS[path % len(style.MARKERS)], zorder=4)
        axis.plot(0.0, 0.0, color=style.DATA, marker="o", ms=2.5, zorder=5)
        widest = 1.08 * np.nanmax(np.abs(sphere.way[..., :2]))
        axis.set(xlim=(-widest, widest), ylim=(-widest, widest), aspect="equal")
        style.label_axes(axis, "$x$ (length)", "$y$ (length)")
        mass, collisions = sphere.mass / sphere.gas_mass, sphere.duration * sphere.friction
        style.letter(axis, f"({letter}) $M={mass:g}\\,m$, {collisions:.0f} friction times")
    return figure


def draw_msd(dataset: xr.Dataset) -> Figure:
    """Draw displacement and velocity autocorrelation, and their deviations from the Langevin equation."""
    figure, (far, ratio, memory, difference) = style.new((2.4, 1.1), (2.4, 1.1))
    spheres = Table(dataset, "point")
    t = np.geomspace(0.05, 1.05 * np.nanmax(spheres.time), 300)
    far.loglog(t, _langevin(t), color=style.DATA, label="Langevin", zorder=2)
    memory.semilogy(t, np.exp(-t), color=style.DATA, label=r"$e^{-\gamma t}$", zorder=2)
    for residual in (ratio, difference):
        style.level(residual, 0.0)
    for kind, sphere in enumerate(spheres):
        label = f"$M={sphere.mass / sphere.gas_mass:g}\\,m$"
        label += ", equal speeds" * bool(sphere.equal_speeds) + ", steps" * bool(sphere.stepped)
        look: dict[str, Any] = {"kind": kind, "hollow": kind > 0}
        _displacement(far, ratio, sphere, label, look)
        _memory(memory, difference, sphere, label, look)
    style.label_axes(far, y=r"$\langle\Delta r^2\rangle\,M\gamma^2/6k_\mathrm{B}T$", legend="lower right")
    correlation = r"$\langle V(0)\!\cdot\!V(t)\rangle\,M/3k_\mathrm{B}T$"
    style.label_axes(memory, y=correlation, legend="lower left", ylim=(0.02, 1.4))
    for residual, name in ((ratio, "ratio $-$ 1"), (difference, "difference")):
        style.label_axes(residual, r"time $\gamma t$", name, ylim=(-0.25, 0.25))
    for axis in (far, ratio):
        axis.set(xscale="log", xlim=(0.07, t[-1]))
    for axis in (memory, difference):
        axis.set_xlim(-0.05, LONGEST_DRAWN)
    style.letters(far, memory)
    return figure


def _displacement(axis: Axes, residual: Axes, sphere: Row, label: str, look: dict) -> None:
    time = sphere.time[np.isfinite(sphere.time)]
    frames = np.unique(np.round(np.geomspace(1, time.size - 1, 16)).astype(int))
    msd = sphere.msd[frames]
    style.points(axis, time[frames], msd, label=label, **look)
    style.points(residual, time[frames], msd / _langevin(time[frames]) - 1.0, **look)
    if sphere.is_light:
        expected = sphere.expected_msd[1 : time.size] / _langevin(time[1:]) - 1.0
        residual.plot(time[1:], expected, color=style.COLOURS[look["kind"]], lw=0.8, zorder=2)


def _memory(axis: Axes, residual: Axes, sphere: Row, label: str, look: dict) -> None:
    early = np.flatnonzero(sphere.time < LONGEST_DRAWN)
    if sphere.is_light:
        expected = sphere.expected_vacf[early] - np.exp(-sphere.time[early])
        residual.plot(sphere.time[early], expected, color=style.COLOURS[look["kind"]], lw=0.8, zorder=2)
    frames = early[:: max(1, round(early.size / 10))]
    time, vacf = sphere.time[frames], sphere.vacf[frames]
    style.points(axis, time, vacf, label=label, **look)
    style.points(residual, time, vacf - np.exp(-time), **look)


_PATHS = {"paths": count("number of paths that are drawn of each point")}
FIGURES = {
    "brownian_paths": Parts(_PATHS, measure_paths, claim_paths, draw_paths),
    "brownian_msd": Parts({}, measure_msd, claim_msd, draw_msd),
}
