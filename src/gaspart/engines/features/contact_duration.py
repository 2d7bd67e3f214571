"""Contacts that last: those within a time of an earlier one of the same particle are elastic."""

from __future__ import annotations

import numpy as np

from gaspart.engines.features.jams import slowest_that_moves
from gaspart.engines.features.part import Part
from gaspart.kernels.model import NONE, ContactDuration, ContactLaw, Gravity
from gaspart.kernels.physics import running_sum
from gaspart.scene.scene import Scene

_ARRAYS = ("latest", "met", "island", "contacts", "elastic", "kept")


def contact_duration(scene: Scene, law: ContactLaw) -> ContactDuration | None:
    """The kernels' rule under this `law`, before the first contact; None if every contact dissipates."""
    if not scene.contact_duration > 0.0:
        return None
    never = np.full(scene.count, -np.inf)
    return ContactDuration(
        length=scene.contact_duration,
        latest=never,
        met=never.copy(),
        island=np.full(scene.count, NONE),
        contacts=np.zeros(scene.count, dtype=np.int64),
        inverse_mass=law.inverse_mass.copy(),
        moving=slowest_that_moves(scene),
        elastic=np.zeros(1, dtype=np.int64),
        kept=np.zeros((1, 2)),
    )


class DurationPart(Part):
    """Contacts that last, and under `gravity` islands at rest, which it does not move, and jams, which
    contacts do not move either."""

    def __init__(self, law: ContactLaw, duration: ContactDuration, gravity: Gravity | None) -> None:
        arrays = {f"contact_{key}": getattr(duration, key) for key in _ARRAYS}
        super().__init__(arrays, times=(duration.latest, duration.met))
        self._duration = duration
        if gravity:
            self.arrays["gravity_fixed"] = gravity.fixed
            self.arrays["inverse_mass"] = law.inverse_mass

    def reset(self, clock: float) -> None:
        """Begin to count from zero."""
        self._duration.elastic[:], self._duration.kept[:] = 0, 0.0

    def counts(self, clock: float) -> dict[str, float]:
        """The elastic contacts, and the energy that they have not dissipated."""
        kept = running_sum.net(self._duration.kept)
        return {"elastic_contacts": int(self._duration.elastic[0]), "retained_energy": kept}
