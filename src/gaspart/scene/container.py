"""Simulated volume and its boundary conditions."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from gaspart.errors import SceneError
from gaspart.keys import POSITIVE, declare, describe, documented, set_fields, validate
from gaspart.keys.values import finite_vector, one_of, positive_number

BOUNDARIES = ("wall", "periodic")
_PER_AXIS = {"type": "array", "minItems": 2, "maxItems": 3}
_BOUNDARY: dict[str, Any] = {
    "anyOf": [{"enum": list(BOUNDARIES)}, {**_PER_AXIS, "items": {"enum": list(BOUNDARIES)}}]
}


def _lengths(name: str, value: Any) -> tuple[float, ...]:
    """Return the side lengths as a tuple of positive numbers."""
    return tuple(positive_number(name, length) for length in finite_vector(name, value))


@documented
@dataclass(frozen=True)
class Container:
    """The simulated volume [0, L] on each axis, in two or three dimensions.

    Examples
    --------
    >>> import gaspart as gp
    >>> channel = gp.Container(lengths=(20.0, 10.0), boundary=("periodic", "wall"))
    >>> channel.volume, channel.walls
    (200.0, ('y low', 'y high'))
    """

    lengths: tuple[float, ...] = field(
        metadata=declare(
            describe(
                {**_PER_AXIS, "items": POSITIVE},
                "(d,) side lengths [length]; their number, 2 or 3, is the dimension",
                _lengths,
            )
        )
    )
    boundary: str | tuple[str, ...] = field(
        default="wall",
        metadata=declare(describe(_BOUNDARY, "one for all axes, or one for each axis")),
    )

    def __post_init__(self) -> None:
        validate(self)
        value = self.boundary
        boundary = (value,) * self.dimension if isinstance(value, str) else value
        if not isinstance(boundary, (tuple, list)) or len(boundary) != self.dimension:
            raise SceneError("boundary", value, f"must be one of {BOUNDARIES}, or a list of one per axis")
        for kind in boundary:
            one_of("boundary", kind, BOUNDARIES)
        set_fields(self, boundary=tuple(boundary))

    @cached_property
    def dimension(self) -> int:
        """Number of dimensions, 2 or 3."""
        return len(self.lengths)

    @cached_property
    def volume(self) -> float:
        """Volume of the container; in two dimensions its area."""
        return math.prod(self.lengths)

    @cached_property
    def periodic(self) -> tuple[bool, ...]:
        """Periodicity of the axes, shape (d,): True for a periodic axis."""
        return tuple(kind == "periodic" for kind in self.boundary)

    @cached_property
    def walls(self) -> tuple[str, ...]:
        """Names of the walls: `x low`, `x high` and so on."""
        axes = [axis for axis, around in zip("xyz", self.periodic, strict=False) if not around]
        return tuple(f"{axis} {end}" for axis in axes for end in ("low", "high"))
