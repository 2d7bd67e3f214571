"""Kinds of faces of a container: what happens to a particle that reaches a face.

A face without a kind is hard and follows the collision law of the scene.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar, Protocol

from gaspart.errors import SceneError
from gaspart.keys import (
    choice,
    declare,
    describe,
    fraction,
    from_mapping,
    not_negative,
    positive,
    real,
    schema_of,
    set_fields,
    validate,
    vector,
)
from gaspart.keys.kinds import POSITIVE, Kind
from gaspart.keys.values import one_of, positive_number, size

if TYPE_CHECKING:
    import numpy as np

    from gaspart.scene.container import Container

FACES = ("x_low", "x_high", "y_low", "y_high", "z_low", "z_high")
"""Keys of faces. In results a face has the name of a wall, such as `x low`. Users may write either form."""
COMPONENTS = ("all", "normal")
WAVEFORMS = ("sine", "sawtooth")
FLOW, GRADIENT = 0, 1
"""Axis of the flow of a sheared gas, and axis of its gradient."""


FACE_KINDS: dict[str, type[Surface]] = {}
"""All kinds of faces by name. The class `Surface` registers every derived class here."""


@dataclass(frozen=True)
class Surface:
    """Kind of face. A derived class is registered by its `kind`.

    `moves` is True if the face moves along its normal. Only the event-driven engine simulates such faces.
    """

    kind: ClassVar[str]
    moves: ClassVar[bool] = False

    def __init_subclass__(cls) -> None:
        FACE_KINDS[cls.kind] = cls

    def __post_init__(self) -> None:
        validate(self)

    @property
    def rule(self) -> tuple[str, float]:
        """Name and parameter of the wall's effect on particles, for the kernels (`kernels.obstacles`).

        The effect may depend on this one number only, which is an energy or a momentum.
        """
        return self.kind, 0.0

    @property
    def smooth(self) -> bool:
        """True if the face acts on particles along its normal only."""
        return True

    @property
    def temperatures(self) -> tuple[float, ...]:
        """Temperature of the face, or the temperatures of its two ends; () without a temperature."""
        return ()


def _check_temperature(key: str, value: Any) -> float | dict[str, float]:
    """Return a checked temperature, or the temperatures at two opposite faces, the low face first."""
    if not isinstance(value, Mapping):
        return positive_number(key, value)
    ends = {
        key_of(face): positive_number(f"{key}.{face}", temperature) for face, temperature in value.items()
    }
    if sorted(ends, reverse=True) not in ([f"{axis}_low", f"{axis}_high"] for axis in "xyz"):
        rule = "must be of two opposite faces, such as {y_low: 1.0, y_high: 2.0}"
        raise SceneError(key, value, rule)
    return {face: ends[face] for face in sorted(ends, reverse=True)}


_ENDS = {
    "type": "object",
    "propertyNames": {"enum": list(FACES)},
    "additionalProperties": POSITIVE,
    "minProperties": 2,
    "maxProperties": 2,
}
_TEMPERATURE = Kind({"anyOf": [POSITIVE, _ENDS]}, _check_temperature)


@dataclass(frozen=True)
class Thermal(Surface):
    """A wall at a temperature; velocities of particles that leave it are drawn for this temperature.

    Parameters
    ----------
    temperature : float or dict of str to float, [energy]
        Temperature k_B T of the wall. With one value at each of two opposite faces, as in {"y_low": 1.0,
        "y_high": 2.0}, the temperature varies linearly between these faces.
    components : {"all", "normal"}, default "all"
        Velocity components that are drawn at random. "all": all components are drawn, and the spins of rough
        particles (a diffuse wall with full accommodation). "normal": only the normal component is drawn; the
        tangential components and the spins are unchanged [1]_.
    velocity : sequence of float, shape (d,), [length/time], optional
        Velocity of the wall parallel to its surface. This velocity is the mean of the drawn tangential
        velocities. Default: the wall is at rest.
    accommodation : float, [1], optional
        Fraction of hits after which velocities are drawn. In the other hits the particle is reflected
        specularly [2]_. Default: 1.

    Raises
    ------
    SceneError
        If a value is invalid, or a wall with components "normal" has a velocity.

    Notes
    -----
    The normal velocity v is drawn from the flux-weighted distribution: v = sqrt(-2 kT/m ln U), where U is
    uniform in (0, 1). If the temperature varies along the face, the temperature at the point of the hit is
    used.

    References
    ----------
    .. [1] R. Frederickx and P. Meerts (2010), section 4.4.
    .. [2] J. C. Maxwell, Phil. Trans. R. Soc. 170, 231 (1879).

    Examples
    --------
    >>> import gaspart as gp
    >>> cold, hot = gp.Thermal(temperature=1.0), gp.Thermal(temperature=2.0)
    >>> scene = gp.Scene(gp.Container((10.0, 10.0)), faces={"x_low": cold, "x_high": hot})
    >>> sorted(scene.face_temperatures)
    [1.0, 2.0]
    """

    temperature: float | dict[str, float] = field(
        hash=False,
        metadata=declare(
            describe(_TEMPERATURE, "temperature of the wall, or those where it ends, at two opposite faces")
        ),
    )
    components: str = field(
        default="all",
        metadata=declare(choice("velocity components that are drawn", *COMPONENTS)),
    )
    velocity: tuple[float, ...] | None = field(
        default=None,
        metadata=declare(vector("velocity of the wall, along itself; without it the wall is at rest")),
    )
    accommodation: float | None = field(
        default=None,
        metadata=declare(
            fraction("fraction of hits after which velocities are drawn, of mirrored others; 1 without it")
        ),
    )

    kind: ClassVar[str] = "thermal"

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.components == "normal" and self.slides:
            raise SceneError("velocity", self.velocity, 'requires components "all"')
        if self.accommodation == 1.0:  # absent everywhere, so that no other code has to test for this value
            set_fields(self, accommodation=None)

    @property
    def slides(self) -> bool:
        """True if the wall moves parallel to its surface.

        Examples
        --------
        >>> import gaspart as gp
        >>> gp.Thermal(temperature=1.0, velocity=(0.5, 0.0)).slides
        True
        """
        return any(self.velocity or ())

    @property
    def rule(self) -> tuple[str, float]:
        """Name of the effect in the kernels, and the temperature.

        If the temperature varies along the face, the temperature at the low end is used.

        Examples
        --------
        >>> import gaspart as gp
        >>> gp.Thermal(temperature=1.0, components="normal").rule
        ('thermal_normal', 1.0)
        """
        return "thermal" if self.components == "all" else "thermal_normal", self.temperatures[0]

    @property
    def varies_along(self) -> int | None:
        """Axis along which the temperature varies; None for a uniform temperature.

        Examples
        --------
        >>> import gaspart as gp
        >>> gp.Thermal(temperature={"y_low": 1.0, "y_high": 2.0}).varies_along
        1
        """
        return FACES.index(next(iter(self.temperature))) // 2 if isinstance(self.temperature, dict) else None

    @property
    def temperatures(self) -> tuple[float, ...]:
        """Temperature of the wall, or the temperatures of its low end and its high end.

        Examples
        --------
        >>> import gaspart as gp
        >>> gp.Thermal(temperature={"y_low": 1.0, "y_high": 2.0}).temperatures
        (1.0, 2.0)
        """
        return tuple(self.temperature.values()) if isinstance(self.temperature, dict) else (self.temperature,)

    @property
    def smooth(self) -> bool:
        """True unless all components of the velocity are drawn.

        Examples
        --------
        >>> import gaspart as gp
        >>> gp.Thermal(temperature=1.0).smooth
        False
        """
        return self.components == "normal"


@dataclass(frozen=True)
class Well(Surface):
    """A wall with an attractive square well: the energy is -`depth` closer than `width` to it.

    Parameters
    ----------
    depth : float, [energy]
        Depth of the well.
    width : float, [length]
        Width of the well. A particle is in the well if its surface is at most this far from the wall.
    temperature : float, [energy], optional
        Temperature of the wall behind the well, see `Thermal`. Default: the wall is hard.

    Raises
    ------
    SceneError
        If a value is not positive.

    Notes
    -----
    A particle leaves the well if the energy of its normal velocity, m v_n^2 / 2, exceeds `depth`. Otherwise
    it is reflected back into the well.

    Examples
    --------
    >>> import gaspart as gp
    >>> well = gp.Well(depth=2.0, width=0.5)
    >>> scene = gp.Scene(gp.Container((10.0, 10.0)), faces={"y_low": well})
    >>> scene.faces["y_low"].rule
    ('hard', 0.0)
    """

    depth: float = field(metadata=declare(positive("depth of the well: an energy")))
    width: float = field(
        metadata=declare(positive("distance of a particle's surface from the wall up to which it lies"))
    )
    temperature: float | None = field(
        default=None, metadata=declare(positive("temperature of the wall; without it the wall is hard"))
    )

    kind: ClassVar[str] = "well"

    @property
    def rule(self) -> tuple[str, float]:
        """Name in the kernels of the effect of the wall behind the well, and its temperature.

        Examples
        --------
        >>> import gaspart as gp
        >>> gp.Well(depth=2.0, width=0.5, temperature=1.0).rule
        ('thermal', 1.0)
        """
        return ("hard", 0.0) if self.temperature is None else ("thermal", self.temperature)

    @property
    def smooth(self) -> bool:
        """True unless the wall behind the well is thermal.

        Examples
        --------
        >>> import gaspart as gp
        >>> gp.Well(depth=2.0, width=0.5).smooth
        True
        """
        return self.temperature is None

    @property
    def temperatures(self) -> tuple[float, ...]:
        """Temperature of the wall behind the well; () if this wall has no temperature.

        Examples
        --------
        >>> import gaspart as gp
        >>> gp.Well(depth=2.0, width=0.5).temperatures
        ()
        """
        return () if self.temperature is None else (self.temperature,)


@dataclass(frozen=True)
class Sticky(Surface):
    """A wall to which slow particles stick, after Frederickx & Meerts (2010), section 4.5.

    Parameters
    ----------
    momentum : float, [mass length/time]
        Normal momentum p below which an arriving particle sticks to the wall.

    Raises
    ------
    SceneError
        If the momentum is not positive.

    Notes
    -----
    The normal kinetic energy of a particle that sticks becomes energy of its vibration, and the particle
    slides along the wall. If a contact with another particle gives it a normal velocity, the energy of this
    velocity is added to the vibration. Once the energy of the vibration reaches p^2 / 2m, the particle leaves
    the wall with this energy. No potential binds the particle, so that sticking is not the exact reverse of
    leaving: detailed balance is broken.

    Examples
    --------
    >>> import gaspart as gp
    >>> gp.Sticky(momentum=0.5).rule
    ('sticky', 0.5)
    """

    momentum: float = field(metadata=declare(positive("normal momentum below which a particle stays")))

    kind: ClassVar[str] = "sticky"

    @property
    def rule(self) -> tuple[str, float]:
        """Name of the wall's effect in the kernels, and the momentum.

        Examples
        --------
        >>> import gaspart as gp
        >>> gp.Sticky(momentum=0.5).rule
        ('sticky', 0.5)
        """
        return "sticky", self.momentum


@dataclass(frozen=True)
class Vibrating(Surface):
    """A hard wall with a prescribed vibration, which gives energy to particles or takes it.

    Parameters
    ----------
    amplitude : float, [length]
        Amplitude A: half of the distance between the two turning points of the wall.
    period : float, [time]
        Duration of one vibration.
    waveform : {"sine", "sawtooth"}, default "sine"
        Displacement as a function of time.

    Raises
    ------
    SceneError
        If a value is invalid.

    Notes
    -----
    The wall is at the side of the container at time 0, and moves inwards from this side by at most 2 A. The
    sine has the inward displacement A (1 - cos(2 pi t / period)). The sawtooth moves inwards at the speed 2 A
    / period. At the end of each period it returns instantaneously. Contacts follow the collision law of the
    scene in the frame of the wall.

    Examples
    --------
    >>> import gaspart as gp
    >>> floor = gp.Vibrating(amplitude=0.1, period=2.0)
    >>> floor.places([0.0, 1.0])
    array([0. , 0.2])
    """

    amplitude: float = field(metadata=declare(positive("half the distance that the wall moves")))
    period: float = field(metadata=declare(positive("duration of one vibration")))
    waveform: str = field(default="sine", metadata=declare(choice("how the wall moves", *WAVEFORMS)))

    kind: ClassVar[str] = "vibrating"
    moves: ClassVar[bool] = True

    def __post_init__(self) -> None:
        super().__post_init__()
        size("period", self.greatest_speed)
        size("period", self.greatest_acceleration)

    @property
    def greatest_speed(self) -> float:
        """Maximum speed of the wall, except during the return of the sawtooth.

        Examples
        --------
        >>> import gaspart as gp
        >>> gp.Vibrating(amplitude=0.1, period=2.0, waveform="sawtooth").greatest_speed
        0.1
        """
        return (2.0 * math.pi if self.waveform == "sine" else 2.0) * self.amplitude / self.period

    @property
    def greatest_acceleration(self) -> float:
        """Maximum acceleration of the wall, except during the return of the sawtooth.

        Examples
        --------
        >>> import gaspart as gp
        >>> gp.Vibrating(amplitude=0.1, period=2.0, waveform="sawtooth").greatest_acceleration
        0.0
        """
        return 2.0 * math.pi * self.greatest_speed / self.period if self.waveform == "sine" else 0.0

    def places(self, times: np.ndarray) -> np.ndarray:
        """Compute the inward displacement of the wall.

        Parameters
        ----------
        times : array_like, [time]
            Times.

        Returns
        -------
        ndarray, same shape as `times`, [length]
            Displacement from the side of the container.

        Examples
        --------
        >>> import gaspart as gp
        >>> gp.Vibrating(amplitude=0.1, period=2.0, waveform="sawtooth").places([0.0, 1.0])
        array([0. , 0.1])
        """
        import numpy as np

        turns = np.fmod(times, self.period) / self.period
        if self.waveform == "sawtooth":
            return 2.0 * self.amplitude * turns
        return self.amplitude * (1.0 - np.cos(2.0 * math.pi * turns))


class _HasContainer(Protocol):
    @property
    def container(self) -> Container: ...


@dataclass(frozen=True)
class Piston(Surface):
    """A smooth wall that particles and an external pressure move, or that has a constant speed.

    In a scene with a piston, all particles must be smooth and elastic, and there must be no fixed particles
    or interior walls.

    Parameters
    ----------
    mass : float, [mass], optional
        Mass of the piston. Requires `pressure`.
    pressure : float, [energy/length^d], optional
        Constant external pressure (force divided by area), which pushes the piston inwards. Requires `mass`.
    speed : float, [length/time], optional
        Prescribed inward speed, which hits do not change. Cannot be combined with `mass` and `pressure`.

    Raises
    ------
    SceneError
        Unless the piston has either both `mass` and `pressure`, or only `speed`.

    Notes
    -----
    The piston starts at the side of the container. With a mass and a pressure it starts at rest. The side is
    its outermost position, where it bounces back without loss. The sum of three energies is conserved: the
    kinetic energy of the piston, `pressure` times the volume, and the energy of the particles. A light piston
    samples the ensemble of constant pressure and enthalpy [1]_, and a heavy one compresses a gas
    adiabatically. A piston with a prescribed speed compresses a gas if it is slow and drives a shock if it is
    fast. The work of the piston becomes energy of the particles.

    References
    ----------
    .. [1] H. C. Andersen, J. Chem. Phys. 72, 2384 (1980).

    Examples
    --------
    >>> import gaspart as gp
    >>> piston = gp.Piston(mass=10.0, pressure=0.5)
    >>> scene = gp.Scene(gp.Container((10.0, 8.0)), faces={"x_high": piston})
    >>> piston.acceleration(scene, axis=0)
    0.4
    """

    mass: float | None = field(
        default=None, metadata=declare(positive("mass of the piston, with a pressure"))
    )
    pressure: float | None = field(
        default=None,
        metadata=declare(not_negative("external pressure: the force on the piston over its area")),
    )
    speed: float | None = field(
        default=None,
        metadata=declare(positive("speed at which it moves inwards, instead of a mass and a pressure")),
    )

    kind: ClassVar[str] = "piston"
    moves: ClassVar[bool] = True

    def __post_init__(self) -> None:
        super().__post_init__()
        loaded = [value is not None for value in (self.mass, self.pressure)]
        if any(loaded) if self.speed is not None else not all(loaded):
            stated = {key: value for key, value in vars(self).items() if value is not None}
            raise SceneError("speed", stated, "must be mass and pressure, or speed alone")

    def acceleration(self, scene: _HasContainer, axis: int) -> float:
        """Return the inward acceleration due to the external pressure, or 0 for a prescribed speed.

        Parameters
        ----------
        scene : Scene
            The scene of the piston.
        axis : int
            Axis along which the piston moves.

        Returns
        -------
        float
            The acceleration, in [length/time^2].

        Examples
        --------
        >>> import gaspart as gp
        >>> scene = gp.Scene(gp.Container((10.0, 8.0)))
        >>> gp.Piston(mass=10.0, pressure=0.5).acceleration(scene, axis=0)
        0.4
        """
        if self.mass is None or self.pressure is None:
            return 0.0
        container = scene.container
        return self.pressure / self.mass * (container.volume / container.lengths[axis])

    def initial_velocity(self, number: int) -> float:
        """Return the velocity of the piston along its axis at time 0.

        Parameters
        ----------
        number : int
            Index of the face: 2 * axis for a low face, 2 * axis + 1 for a high face.

        Returns
        -------
        float
            The velocity, in [length/time], or 0 without a prescribed speed.

        Examples
        --------
        >>> import gaspart as gp
        >>> gp.Piston(speed=2.0).initial_velocity(number=1)
        -2.0
        """
        return (-1.0 if number % 2 else 1.0) * (self.speed or 0.0)


@dataclass(frozen=True)
class Open(Surface):
    """An opening as wide as the face, through which particles leave, and enter from a reservoir.

    A particle that reaches the face leaves for good. With an `activity` and a `temperature`, particles from a
    reservoir enter through the face, and the scene must have `centres_to_walls`. Otherwise there is a vacuum
    outside, and the container may have interior walls. The scene must have one species.

    Parameters
    ----------
    activity : float, [1], optional
        Activity eta exp(mu_excess / k_B T) of the reservoir; eta is its packing fraction, and mu_excess its
        excess chemical potential. Requires `temperature`. Default: a vacuum.
    temperature : float, [energy], optional
        Temperature k_B T of the reservoir. Requires `activity`.

    Raises
    ------
    SceneError
        If a value is invalid, or only one of `activity` and `temperature` is given.

    See Also
    --------
    gaspart.theory.activity : Activity of a gas of a packing fraction.

    Notes
    -----
    The reservoir is a gas at rest. In the dilute limit its activity is eta. Let z be the number density that
    is equivalent to the activity. The reservoir sends z (k_B T / 2 pi m)^(1/2) particles per area and time,
    uniformly over the face, with the velocities of particles that pass a plane in one direction. An arriving
    particle that would overlap a particle inside is rejected. If all reservoirs are identical, the particles
    in equilibrium are therefore exactly a grand-canonical ensemble of centres between the faces. The reason
    is detailed balance: an entry is the time reversal of an exit, and a state with N particles and energy E
    has the weight z^N exp(-E / k_B T). The density equals the density of the reservoir only at distances of
    several diameters from a face.

    The Boltzmann model of the DSMC engine has no excluded volume, so that it rejects no particle: in this
    model the reservoir is an ideal gas with the packing fraction `activity`.

    Examples
    --------
    >>> import gaspart as gp
    >>> reservoir = gp.Open(activity=0.1, temperature=1.0)
    >>> scene = gp.Scene(
    ...     gp.Container((10.0, 10.0)),
    ...     species=[gp.Species(count=5, radius=0.5, temperature=1.0)],
    ...     centres_to_walls=True,
    ...     faces={"x_low": reservoir, "x_high": reservoir},
    ... )
    >>> scene.is_open
    True
    """

    activity: float | None = field(
        default=None, metadata=declare(positive("of the reservoir outside; without it a vacuum"))
    )
    temperature: float | None = field(
        default=None, metadata=declare(positive("of the reservoir, which has an activity too"))
    )

    kind: ClassVar[str] = "open"

    def __post_init__(self) -> None:
        super().__post_init__()
        if (self.activity is None) != (self.temperature is None):
            raise SceneError("temperature", self.temperature, "must be given together with activity")

    @property
    def smooth(self) -> bool:
        """False, because particles that leave and enter carry momentum parallel to the face.

        Examples
        --------
        >>> import gaspart as gp
        >>> gp.Open().smooth
        False
        """
        return False

    @property
    def temperatures(self) -> tuple[float, ...]:
        """Temperature of the reservoir; () if there is no reservoir.

        Examples
        --------
        >>> import gaspart as gp
        >>> gp.Open(activity=0.1, temperature=1.0).temperatures
        (1.0,)
        """
        return () if self.temperature is None else (self.temperature,)


@dataclass(frozen=True)
class LeesEdwards(Surface):
    """Pair of periodic faces whose images slide, for shear flow without walls.

    The mean velocity of the gas is u_x = shear_rate (y - L_y / 2).

    Parameters
    ----------
    shear_rate : float, [1/time]
        Gradient of the flow, du_x / dy.

    Raises
    ------
    SceneError
        If the shear rate is not a finite number.

    Notes
    -----
    The boundary condition was introduced by Lees and Edwards [1]_. It must be set for y_high of a container
    that is periodic along all axes, and then applies to y_low, too. A particle that leaves at y_high at time
    t enters at y_low. Its x is then displaced by -shear_rate L_y t, and its v_x is reduced by shear_rate L_y.
    For a particle that leaves at y_low the signs are reversed. The initial velocities are the sum of the
    velocity of the flow and random velocities with mean 0. The faces do work, which heats an elastic gas.

    References
    ----------
    .. [1] A. W. Lees and S. F. Edwards, J. Phys. C 5, 1921 (1972).

    Examples
    --------
    >>> import gaspart as gp
    >>> box = gp.Container((10.0, 10.0), boundary="periodic")
    >>> gp.Scene(box, faces={"y_high": gp.LeesEdwards(shear_rate=0.5)}).shear_rate
    0.5
    """

    shear_rate: float = field(metadata=declare(real("gradient of the flow, du_x / dy")))

    kind: ClassVar[str] = "lees_edwards"
    moves: ClassVar[bool] = True


SCHEMA = {
    "type": "object",
    "propertyNames": {"enum": list(FACES)},
    "additionalProperties": {
        "anyOf": [
            schema_of(face, kind=describe({"const": name}, "the kind of face"))
            for name, face in FACE_KINDS.items()
        ]
    },
}
"""JSON schema of the faces of a scene, by name."""


def surface_from_dict(mapping: object, where: str) -> Surface:
    """Return the face from a mapping {"kind": one of `FACE_KINDS`, setting: value, ...}."""
    if not isinstance(mapping, dict):
        raise SceneError(where, mapping, "must be a mapping with a kind")
    settings = dict(mapping)
    kind = one_of(f"{where}.kind", settings.pop("kind", None), FACE_KINDS)
    return from_mapping(FACE_KINDS[kind], settings, where)


def surface_to_dict(surface: Surface) -> dict:
    """Return the mapping that describes a face, the inverse of `surface_from_dict`."""
    return {"kind": surface.kind, **asdict(surface)}


def key_of(face: Any) -> Any:
    """Return the key of a face for its key or its name as a wall.

    Other values are returned unchanged.
    """
    return face.strip().replace(" ", "_") if isinstance(face, str) else face


def wall_of(face: Any) -> Any:
    """Return the name of a face as a wall, `x low`. Other values are returned unchanged."""
    if isinstance(face, list | tuple):
        return [wall_of(name) for name in face]
    return face.strip().replace("_", " ") if isinstance(face, str) else face
