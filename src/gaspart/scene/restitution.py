"""Law of contacts, which take energy from a gas, and the thermostat that gives it."""

from __future__ import annotations

from dataclasses import dataclass, field

from gaspart.errors import SceneError
from gaspart.keys import declare, documented, in_range, not_negative, positive, validate


@documented
@dataclass(frozen=True)
class Restitution:
    """Effect of a contact on the relative velocity of the two surfaces (Spencer 2022, Eq. 22).

    Raises
    ------
    SceneError
        If a value is invalid, or if a `reference_speed` is set and `normal` is 0 or 1.

    Examples
    --------
    >>> import gaspart as gp
    >>> grains = gp.Restitution(normal=0.9)
    >>> grains.dissipative, grains.rough
    (True, False)
    """

    normal: float = field(
        default=1.0,
        metadata=declare(
            in_range(
                "coefficient e_n: a contact multiplies the normal relative velocity by -e_n; 0 (no "
                "rebound) to 1 (elastic)",
                0.0,
                1.0,
            )
        ),
    )
    tangential: float = field(
        default=-1.0,
        metadata=declare(
            in_range(
                "coefficient e_t: likewise the tangential components; -1 (perfectly smooth) to 1 "
                "(perfectly rough)",
                -1.0,
                1.0,
            )
        ),
    )

    contact_duration: float | None = field(
        default=None,
        metadata=declare(
            not_negative(
                "duration t_c [time]: a contact of a particle less than t_c after its last one is "
                "elastic; 0: none is; default: under gravity 0.01 of the time scale of a fall through"
                " the smallest diameter, else 0"
            )
        ),
    )

    reference_speed: float | None = field(
        default=None,
        metadata=declare(
            positive(
                "with it particles are viscoelastic [length/time]: `normal` is the coefficient of two"
                " particles of the first species that approach at this normal speed; slower contacts "
                "lose less"
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
        """True if contacts are the same as in a scene without a `Restitution`."""
        return self.normal == 1.0 and self.tangential == -1.0

    @property
    def dissipative(self) -> bool:
        """True if contacts may lose energy."""
        return self.normal < 1.0 or -1.0 < self.tangential < 1.0

    def refuse_loss(self, rule: str) -> None:
        """Raise SceneError if contacts lose energy.

        Parameters
        ----------
        rule : str
            Rule of the error message.

        Raises
        ------
        SceneError
            If contacts lose energy. The message names the coefficient by which they lose it.
        """
        if self.dissipative:
            key = "normal" if self.normal < 1.0 else "tangential"
            raise SceneError(f"restitution.{key}", getattr(self, key), rule)

    @property
    def rough(self) -> bool:
        """True if contacts change spins."""
        return self.tangential > -1.0


@documented
@dataclass(frozen=True)
class Thermostat:
    """Random kicks of all particles at regular times.

    The kicks add energy, so that a dissipative gas can reach a steady state (D. R. M. Williams and F. C.
    MacKintosh, Phys. Rev. E 54, R9 (1996)).

    At each multiple of `interval`, a normal random number is added to every velocity component of a particle
    of mass m. Its variance is 2 power interval/(d m). Then the same velocity is subtracted from all
    particles, so that the total momentum is conserved. For short intervals this is white noise of strength
    xi_0^2 = 2 power/(d m).

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

    power: float = field(
        metadata=declare(positive("mean energy per time that a particle is given [energy/time]"))
    )
    interval: float = field(
        metadata=declare(positive("time between kicks [time]: short compared with that between contacts"))
    )

    def __post_init__(self) -> None:
        validate(self)
