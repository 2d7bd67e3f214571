"""Scenes whose density follows from the impulses of particles, and the rows of their sums."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gaspart.errors import SceneError
from gaspart.scene.features import FEATURES

if TYPE_CHECKING:
    from gaspart.scene.scene import Scene

_DISTURBING = (
    "fixed",
    "thermostat",
    "sticky",
    "vibrating",
    "piston",
    "moving_wall",
    "lees_edwards",
    "sliding",
    "open",
)
"""Features with which there is no equilibrium at one temperature, or fixed particles in the way."""
_STEADY = frozenset(("walls", "polydispersity", "centres_to_walls"))
"""Features with which the kinetic energy of flight is still that of the start."""
FURTHEST = 0.499
"""Largest distance of a pair, divided by the shortest side of a periodic container."""


def require_impulses(scene: Scene) -> None:
    """Raise SceneError, with the reason, if the impulses in a scene give no density.

    They give none if velocities depend on positions, as they do except in equilibrium at one temperature.
    """
    if len({particle.mass for particle in scene.particles}) > 1:
        rule = "must have one mass for an impulse tally, which sums over all single particles"
        raise SceneError("particles.mass", len(scene.particles), rule)
    if scene.restitution is not None and scene.restitution.dissipative:
        rule = "excludes impulses, which require equilibrium; this gas loses energy"
        raise SceneError("restitution", scene.restitution.normal, rule)
    for name in _DISTURBING:
        if FEATURES[name].value(scene) is not None:
            rule = f"excludes impulses, which require equilibrium at rest, not {FEATURES[name].meaning}"
            raise FEATURES[name].refuse(scene, rule)
    if scene.driven_axes:
        raise SceneError(
            "gravity", scene.gravity, "excludes impulses, which require equilibrium; this gas flows"
        )
    temperatures = sorted(scene.face_temperatures)
    if len(temperatures) > 1:
        rule = "excludes impulses, which require equilibrium; heat flows between faces"
        raise SceneError("faces.temperature", temperatures, rule)


def require_pair_impulses(scene: Scene, furthest: float) -> None:
    """Raise SceneError, with the reason, if the impulses give no g(r) up to a distance."""
    if not scene.is_periodic:
        raise SceneError("pair_impulses", furthest, "needs a periodic container; set boundary: periodic")
    diameter, half = 2.0 * scene.largest_radius, FURTHEST * min(scene.container.lengths)
    if not diameter < furthest <= half:
        rule = f"must be from the largest diameter, {diameter:g}, to half of the shortest side, {half:.4g}"
        raise SceneError("pair_impulses.furthest", furthest, rule)
    if scene.count < 2:
        raise SceneError("count", scene.count, "must be at least 2 for pair_impulses")
    require_impulses(scene)


def shares_energy_evenly(scene: Scene) -> bool:
    """Return True if the kinetic energy of flight is constant, and equal for all directions.

    This holds in equilibrium for smooth, elastic particles without a potential or a source of heat.
    """
    return scene.features <= _STEADY


def row_count(scene: Scene) -> int:
    """Return the number of rows of impulses: one per species, one for all single particles."""
    return len(scene.species) + bool(scene.particles)
