"""Stochastic thermostat."""

from __future__ import annotations

from dataclasses import dataclass, field

from gaspart.keys import declare, positive, validate


@dataclass(frozen=True)
class Thermostat:
    """Random kicks of all particles at regular times.

    The kicks add energy, so that a dissipative gas can reach a steady state [1]_.

    Parameters
    ----------
    power : float, [energy/time]
        Mean energy that each particle receives per unit of time.
    interval : float, [time]
        Time between kicks. It should be short compared with the time between contacts.

    Raises
    ------
    SceneError
        If a value is not positive.

    Notes
    -----
    At each multiple of `interval`, a normal random number is added to every velocity component of a particle
    of mass m. Its variance is 2 power interval/(d m). Then the same velocity is subtracted from all
    particles, so that the total momentum is conserved. For short intervals this is white noise of strength
    xi_0^2 = 2 power/(d m).

    References
    ----------
    .. [1] D. R. M. Williams and F. C. MacKintosh, Phys. Rev. E 54, R9 (1996).

    Examples
    --------
    >>> import gaspart as gp
    >>> gas = gp.Species(count=100, radius=0.5, temperature=1.0)
    >>> heated = gp.Scene(
    ...     gp.Container((30.0, 30.0), boundary="periodic"),
    ...     species=[gas],
    ...     restitution=gp.Restitution(normal=0.9),
    ...     thermostat=gp.Thermostat(power=0.1, interval=0.01),
    ... )
    >>> heated.thermostat.power
    0.1
    """

    power: float = field(metadata=declare(positive("mean energy per time that a particle is given")))
    interval: float = field(
        metadata=declare(positive("time between kicks: short compared with that between contacts"))
    )

    def __post_init__(self) -> None:
        validate(self)
