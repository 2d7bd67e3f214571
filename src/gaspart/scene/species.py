"""Particles of a scene: species and single particles."""

from __future__ import annotations

import math
from dataclasses import KW_ONLY, dataclass, field
from typing import TYPE_CHECKING, ClassVar

from gaspart.errors import SceneError
from gaspart.keys import (
    POSITIVE,
    choice,
    count,
    declare,
    describe,
    documented,
    flag,
    in_range,
    not_negative,
    positive,
    set_fields,
    two_vectors,
    validate,
    vector,
)
from gaspart.keys.values import (
    LARGEST,
    MOST_PARTICLES,
    SMALLEST,
    finite_vector,
    number,
    positive_number,
    size,
)
from gaspart.scene.sizes import DISTRIBUTIONS, MOST_UNIFORM, relative_radii

if TYPE_CHECKING:
    import numpy as np

LATTICES = ("lattice", "slab")
SHARED = (*LATTICES, "compressed")
"""Arrangements that apply to all particles of a scene together."""
ARRANGEMENTS = ("random", *SHARED)


def _radius(name: str, value: object) -> float:
    """Return a radius; raise SceneError unless it is positive."""
    if isinstance(value, int | float) and value == 0.0:
        rule = "must be positive; points are particles with a radius of 1e-9 of the container"
        raise SceneError(name, value, rule)
    return positive_number(name, value)


_RADIUS = declare(describe(POSITIVE, "radius [length]", _radius))
_MASS = declare(positive("mass [mass]"))
_MOMENT = declare(
    describe(
        POSITIVE,
        "moment of inertia [mass length^2]; by default that of a uniform disc or sphere",
        lambda name, value: number(name, value, "must be positive", above=0.0),
    )
)
_FIXED = declare(flag("the particle never moves: it has infinite mass"))
_SPIN: dict = {"type": ["number", "array"], "items": {"type": "number"}, "minItems": 3, "maxItems": 3}


def _check_matter(particle: Species | Particle) -> None:
    """Check the rules that combine several keys, and that apply to species and single particles."""
    if particle.moment_of_inertia is not None:
        if not SMALLEST <= particle.moment_of_inertia / particle.mass / particle.radius**2 <= LARGEST:
            rule = f"must be from {SMALLEST:g} to {LARGEST:g} times the mass times the radius squared"
            raise SceneError("moment_of_inertia", particle.moment_of_inertia, rule)
    if particle.vibration is not None and not particle.fixed:
        raise SceneError("vibration", particle.vibration, "requires fixed: true")


@documented
@dataclass(frozen=True)
class Species:
    """Particles of one kind, whose positions the program chooses.

    Without a `polydispersity` the particles are identical. Velocities have random directions. All particles
    have the same `speed`, or a Maxwellian distribution at `temperature`. If neither key is set, the particles
    start at rest.

    With `arrangement` "random" particles are inserted one after another. "lattice": sites of a triangular or
    face-centred cubic lattice, which all species with this value share; "random" species fill the space
    between them. "slab": a lattice whose vacancies are all in one half, so that this half melts.
    "compressed": growth to a density that insertion cannot reach (see `compress`).

    Initial velocities are random: the kinetic temperature of N particles in d dimensions fluctuates about
    `temperature` with the relative standard deviation sqrt(2 / (d N)), unless `exact_temperature` is set.

    A fixed particle with a `vibration` or a `temperature` has one mode of vibration. A contact exchanges
    energy between this mode and the normal motion of the other particle.

    The N radii of a polydisperse species are the quantiles of the distribution at N equally spaced
    probabilities, in descending order. The radii do not depend on the seed, so every run has the same packing
    fraction.

    Raises
    ------
    SceneError
        If a value is invalid, or two values contradict each other.

    See Also
    --------
    Particle : A single particle at a given position.

    Examples
    --------
    >>> import gaspart as gp
    >>> grains = gp.Species(count=500, radius=0.5, polydispersity=0.1, temperature=1.0)
    >>> grains.radii[:2].round(4)
    array([0.6772, 0.6544])
    """

    count: int = field(metadata=declare(count("number of particles", 0, maximum=MOST_PARTICLES)))
    radius: float = field(
        metadata=declare(
            describe(POSITIVE, "radius [length]; the mean, if there is a `polydispersity`", _radius)
        )
    )
    _: KW_ONLY
    mass: float = field(default=1.0, metadata=_MASS)
    speed: float | None = field(
        default=None,
        metadata=declare(
            not_negative("initial speed of every particle [length/time], instead of `temperature`")
        ),
    )
    temperature: float | None = field(
        default=None,
        metadata=declare(
            not_negative(
                "temperature of the initial velocities [energy], or of the vibrations of fixed particles"
            )
        ),
    )
    exact_temperature: bool = field(
        default=False,
        metadata=declare(
            flag(
                "the initial velocities are scaled to exactly the `temperature`, after the mean velocity "
                "along axes on which momentum is conserved was taken off; all such species whose regions "
                "overlap share one factor, and only their common energy is exact"
            )
        ),
    )
    arrangement: str = field(default="random", metadata=declare(choice("initial positions", *ARRANGEMENTS)))
    region: tuple[tuple[float, ...], ...] | None = field(
        default=None,
        metadata=declare(
            two_vectors(
                "lower and upper corner [length], (2, d), of the box in which all particles start; "
                "default: the container"
            )
        ),
    )
    moment_of_inertia: float | None = field(default=None, metadata=_MOMENT)
    fixed: bool = field(default=False, metadata=_FIXED)
    vibration: float | None = field(
        default=None,
        metadata=declare(
            not_negative("initial vibrational energy of fixed particles [energy], instead of `temperature`")
        ),
    )
    polydispersity: float | None = field(
        default=None,
        metadata=declare(
            in_range("standard deviation of the radii over their mean; default: all are equal", 0.0, 1.0)
        ),
    )
    radius_distribution: str | None = field(
        default=None,
        metadata=declare(
            choice("distribution of the radii, with a `polydispersity`; default: lognormal", *DISTRIBUTIONS)
        ),
    )

    def __post_init__(self) -> None:
        validate(self)
        _check_matter(self)
        if self.region is not None and self.arrangement != "random":
            raise SceneError("region", self.region, "needs arrangement: random")
        if self.speed is not None and self.temperature is not None:
            raise SceneError("temperature", self.temperature, "give speed or temperature, not both")
        if self.fixed and self.speed:
            raise SceneError("speed", self.speed, "must be 0 for a fixed species")
        if self.exact_temperature and (self.temperature is None or self.fixed):
            raise SceneError("exact_temperature", True, "needs the temperature of a species that moves")
        if self.vibration is not None and self.temperature is not None:
            raise SceneError("temperature", self.temperature, "give vibration or temperature, not both")
        if self.polydispersity == 0.0:  # absent everywhere, so that no other code has to test for this value
            set_fields(self, polydispersity=None, radius_distribution=None)
        self._check_sizes()

    def _check_sizes(self) -> None:
        """Check the rules of a polydisperse species."""
        if self.polydispersity is None:
            if self.radius_distribution is not None:
                raise SceneError("radius_distribution", self.radius_distribution, "needs a polydispersity")
        elif self.radius_distribution == "uniform" and not self.polydispersity < MOST_UNIFORM:
            rule = f"must be below {MOST_UNIFORM:.4g} for a uniform distribution; radii must be positive"
            raise SceneError("polydispersity", self.polydispersity, rule)
        elif self.moment_of_inertia is not None:
            rule = "must be absent for a polydisperse species, whose particles are uniform discs or spheres"
            raise SceneError("moment_of_inertia", self.moment_of_inertia, rule)

    @property
    def alike(self) -> bool:
        """True if all particles have the same radius."""
        return self.polydispersity is None

    @property
    def radii(self) -> np.ndarray:
        """Radii of the particles, shape (count,)."""
        import numpy as np

        if self.polydispersity is None:
            return np.full(self.count, self.radius)
        distribution = self.radius_distribution or DISTRIBUTIONS[0]
        return self.radius * relative_radii(self.count, self.polydispersity, distribution)

    @property
    def largest_radius(self) -> float:
        """Largest radius of a particle."""
        return self.radius if self.alike or not self.count else float(self.radii[0])

    @property
    def smallest_radius(self) -> float:
        """Smallest radius of a particle."""
        return self.radius if self.alike or not self.count else float(self.radii[-1])

    def total_power(self, dimension: int) -> float:
        """Return the sum of radius^dimension over the particles.

        Parameters
        ----------
        dimension : {2, 3}
            Exponent.

        Returns
        -------
        float
            The sum, in [length^dimension].
        """
        if self.alike:
            return self.count * self.radius**dimension
        return math.fsum(radius**dimension for radius in self.radii.tolist())

    @property
    def vibrates(self) -> bool:
        """True if the particles have a mode of vibration."""
        return self.fixed and (self.vibration is not None or self.temperature is not None)

    def initial_temperature(self, dimension: int) -> float:
        """Return the temperature m <v^2> / d of the distribution of initial velocities.

        Parameters
        ----------
        dimension : {2, 3}
            Number of dimensions d.

        Returns
        -------
        float
            The temperature, in [energy].
        """
        if self.temperature is not None:
            return self.temperature
        return self.mass * (self.speed or 0.0) ** 2 / dimension


@documented
@dataclass(frozen=True)
class Particle:
    """A single particle at a given position.

    Raises
    ------
    SceneError
        If a value is invalid, or two values contradict each other.

    See Also
    --------
    Species : Identical particles, which the program places.

    Examples
    --------
    >>> import gaspart as gp
    >>> disc = gp.Particle(position=(1.0, 2.0), velocity=(1.0, 0.0), radius=0.5, spin=3.0)
    >>> disc.spin_vector
    (0.0, 0.0, 3.0)
    """

    count: ClassVar[int] = 1
    alike: ClassVar[bool] = True
    position: tuple[float, ...] = field(
        metadata=declare(vector("initial position of its centre [length]", sized=False))
    )
    velocity: tuple[float, ...] = field(metadata=declare(vector("initial velocity [length/time]")))
    radius: float = field(metadata=_RADIUS)
    mass: float = field(default=1.0, metadata=_MASS)
    spin: float | tuple[float, ...] | None = field(
        default=None,
        metadata=declare(describe(_SPIN, "angular velocity [1/time]: a number in 2D, a vector in 3D")),
    )
    moment_of_inertia: float | None = field(default=None, metadata=_MOMENT)
    fixed: bool = field(default=False, metadata=_FIXED)
    vibration: float | None = field(
        default=None,
        metadata=declare(not_negative("of a fixed particle [energy]: initial energy of vibration")),
    )

    def __post_init__(self) -> None:
        validate(self)
        _check_matter(self)
        if self.spin is not None:
            flat = len(self.position) == 2
            spin = (
                number("spin", self.spin, "must be a number") if flat else finite_vector("spin", self.spin, 3)
            )
            size("spin", spin)
            set_fields(self, spin=spin)
        for key, value in (("velocity", self.velocity), ("spin", self.spin_vector)):
            if self.fixed and any(value):
                raise SceneError(key, value, "must be zero for a fixed particle")

    @property
    def radii(self) -> np.ndarray:
        """Radius of the particle as an array, shape (1,)."""
        import numpy as np

        return np.array([self.radius])

    @property
    def largest_radius(self) -> float:
        """Radius of the particle."""
        return self.radius

    smallest_radius = largest_radius

    @property
    def vibrates(self) -> bool:
        """True if the particle has a mode of vibration."""
        return self.vibration is not None

    def initial_temperature(self, dimension: int) -> float:
        """Return the temperature m v^2 / d of the initial velocity.

        Parameters
        ----------
        dimension : {2, 3}
            Number of dimensions d.

        Returns
        -------
        float
            The temperature, in [energy].
        """
        return self.mass * sum(component**2 for component in self.velocity) / dimension

    @property
    def spin_vector(self) -> tuple[float, ...]:
        """Angular velocity as a vector, shape (3,); in 2D it is normal to the plane."""
        if self.spin is None:
            return 0.0, 0.0, 0.0
        return self.spin if isinstance(self.spin, tuple) else (0.0, 0.0, self.spin)
