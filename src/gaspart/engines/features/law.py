"""The law of contacts, for all engines, and what particles keep inside: spins and vibrations."""

from __future__ import annotations

import numpy as np

from gaspart.engines.features.part import Part
from gaspart.kernels.model import ContactLaw
from gaspart.scene.restitution import Restitution
from gaspart.scene.scene import Scene
from gaspart.state.insertion import per_particle
from gaspart.state.state import State

_BISECTIONS = 100  # until neighbouring numbers enclose the damping of viscoelastic particles


def contact_law(scene: Scene, state: State) -> ContactLaw | None:
    """The law of contacts, or None if all are elastic, smooth and between particles that can move."""
    rule = scene.restitution or Restitution()
    if rule.smooth_and_elastic and not np.isinf(state.masses).any():
        return None
    spins = np.zeros((state.count, 3))
    if scene.dimension == 2:
        spins[:, 2] = state.spins
    else:
        spins[:] = state.spins
    vibrations = None
    modes = per_particle(scene, "vibrates")
    if modes.any() and state.vibrations is not None:
        vibrations = np.where(modes, state.vibrations, -1.0)
    inverses = 1 / state.masses, 1 / state.moments_of_inertia
    return ContactLaw(rule.normal, rule.tangential, _viscous(scene), *inverses, spins, vibrations, None)


def _viscous(scene: Scene) -> float | None:
    """The constant of viscoelastic particles, from the restitution of two of the first species, or else of
    the first particle; None if the restitution is constant."""
    rule = scene.restitution
    if rule is None or rule.reference_speed is None:
        return None
    from gaspart.kernels.physics.viscoelastic import fifth_root, restitution_of

    first = (scene.species or scene.particles)[0]
    least, most = 0.0, 1.0
    while restitution_of(most) > rule.normal:
        most *= 2.0
    for _ in range(_BISECTIONS):
        middle = 0.5 * (least + most)
        least, most = (middle, most) if restitution_of(middle) > rule.normal else (least, middle)
    return most / fifth_root(rule.reference_speed * 0.5 * first.radius * (2.0 / first.mass) ** 2)


class LawPart(Part):
    """Particles under a law of contacts: their spins (N, 3), and the energies (N,) of those that vibrate."""

    def __init__(self, law: ContactLaw) -> None:
        super().__init__({"spins": law.spins})
        self._inverse_inertia = law.inverse_inertia
        if law.vibrations is not None:
            self.arrays["vibrations"] = law.vibrations

    @property
    def stored(self) -> float:
        """The energy of spins and of vibrations."""
        squares = (self.arrays["spins"] ** 2).sum(axis=1)
        turning = squares > 0.0  # and so not of smooth particles, whose moment of inertia may be infinite
        spins = 0.5 * float((squares[turning] / self._inverse_inertia[turning]).sum())
        vibrations = self.arrays.get("vibrations")
        return spins + (0.0 if vibrations is None else float(np.maximum(vibrations, 0.0).sum()))

    def write(self, state: State, clock: float) -> None:
        """Write the spins, and add the energies of fixed particles that vibrate."""
        spins = self.arrays["spins"]
        state.spins = (spins[:, 2] if state.dimension == 2 else spins).copy()
        if state.vibrations is not None and "vibrations" in self.arrays:
            state.vibrations += np.maximum(self.arrays["vibrations"], 0.0)
