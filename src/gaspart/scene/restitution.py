"""The law of contacts."""

from __future__ import annotations

from dataclasses import dataclass, field

from gaspart.errors import SceneError
from gaspart.keys import between, declared, not_negative, positive, validate


@dataclass(frozen=True)
class Restitution:
    """Effect of a contact on the relative velocity of the two surfaces (Spencer 2022, Eq. 22)."""

    normal: float = field(
        default=1.0,
        metadata=declared(
            between(
                "the normal part is multiplied by minus this: from 0 (they stick) to 1 (elastic)", 0.0, 1.0
            )
        ),
    )
    tangential: float = field(
        default=-1.0,
        metadata=declared(
            between(
                "likewise the tangential part: from -1 (perfectly smooth) to 1 (perfectly rough)", -1.0, 1.0
            )
        ),
    )

    contact_duration: float | None = field(
        default=None,
        metadata=declared(
            not_negative(
                "a contact of a particle less than this after its last one is elastic; 0: none is; default: "
                "under gravity 0.01 of the time scale of a fall through the smallest diameter, else 0"
            )
        ),
    )

    reference_speed: float | None = field(
        default=None,
        metadata=declared(
            positive(
                "with it particles are viscoelastic: `normal` is the restitution of two particles of the "
                "first species that approach at this normal speed; slower contacts take less"
            )
        ),
    )

    def __post_init__(self) -> None:
        validate(self)
        if self.reference_speed is not None and not 0.0 < self.normal < 1.0:
            rule = "must be between 0 and 1, both excluded, with a reference_speed"
            raise SceneError("normal", self.normal, rule)

    @property
    def smooth_and_elastic(self) -> bool:
        """Whether contacts are those of a scene without a Restitution."""
        return self.normal == 1.0 and self.tangential == -1.0

    @property
    def dissipative(self) -> bool:
        """Whether contacts may lose energy."""
        return self.normal < 1.0 or -1.0 < self.tangential < 1.0

    @property
    def rough(self) -> bool:
        """Whether contacts change spins."""
        return self.tangential > -1.0
