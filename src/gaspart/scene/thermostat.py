"""A stochastic thermostat."""

from __future__ import annotations

from dataclasses import dataclass, field

from gaspart.keys import declared, positive, validate


@dataclass(frozen=True)
class Thermostat:
    """Random kicks of all particles at regular times, which let a dissipative gas reach a steady state
    (Williams & MacKintosh, Phys. Rev. E 54, R9 (1996)).

    At each multiple of `interval` every velocity component of a particle of mass m is changed by a normal
    random number of variance 2 power interval/(d m), and then all velocities by the same, so that the total
    momentum is kept. For short intervals this is white noise of strength xi_0^2 = 2 power/(d m).
    """

    power: float = field(metadata=declared(positive("mean energy per time that a particle is given")))
    interval: float = field(
        metadata=declared(positive("time between kicks: short compared with that between contacts"))
    )

    def __post_init__(self) -> None:
        validate(self)
