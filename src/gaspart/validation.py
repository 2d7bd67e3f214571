"""Values that users give, checked: each function returns what is meant, or says in one line what is wrong."""

from __future__ import annotations

import math
import numbers
from dataclasses import fields
from typing import TYPE_CHECKING, Any, TypeVar

from gaspart.errors import SceneError

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

T = TypeVar("T", bound="DataclassInstance")

SMALLEST, LARGEST = 1e-60, 1e60
"""Sizes of what contacts multiply four of, which must be neither lost nor infinite."""


def number(
    key: str,
    value: Any,
    rule: str,
    *,
    above: float = -math.inf,
    least: float = -math.inf,
    most: float = math.inf,
) -> float:
    """`value` as a finite float above `above` and from `least` to `most`, or a SceneError with `rule`."""
    if isinstance(value, bool) or not isinstance(value, numbers.Real) or not math.isfinite(value):
        raise SceneError(key, value, rule)
    if not (float(value) > above and least <= float(value) <= most):
        raise SceneError(key, value, rule)
    return float(value)


def size(key: str, value: float | tuple[float, ...]) -> None:
    """Raise SceneError for a number, or a vector by its largest component, that is not 0 and so small or
    large that contacts would be lost."""
    largest = max(map(abs, value), default=0.0) if isinstance(value, tuple) else abs(value)
    if largest and not SMALLEST <= largest <= LARGEST:
        rule = f"must be 0 or of a size from {SMALLEST:g} to {LARGEST:g}: choose other units"
        raise SceneError(key, value, rule)


def count_of(key: str, value: Any, least: int = 0) -> int:
    """`value` as an integer of at least `least`."""
    rule = f"must be a whole number of at least {least}"
    if number(key, value, rule, least=least) != int(value):
        raise SceneError(key, value, rule)
    return int(value)


def vector(key: str, value: Any, dimension: int | None = None) -> tuple[float, ...]:
    """`value` as a tuple of finite floats, of length `dimension` where that is known."""
    size = f"{dimension} " if dimension else ""
    rule = f"must be a list of {size}finite numbers"
    if isinstance(value, str) or not hasattr(value, "__iter__"):
        raise SceneError(key, value, rule)
    numbers_ = tuple(number(key, x, rule) for x in value)
    if dimension is not None and len(numbers_) != dimension:
        raise SceneError(key, value, rule)
    return numbers_


def settle(instance: object, **values: object) -> None:
    """Write the validated `values` into a frozen dataclass that is being made."""
    for name, value in values.items():
        object.__setattr__(instance, name, value)


def from_mapping(cls: type[T], mapping: object, where: str) -> T:
    """Make the dataclass `cls` from a mapping whose keys must all be fields of it."""
    if not isinstance(mapping, dict):
        raise SceneError(where, mapping, "must be a mapping of keys to values")
    known = {f.name: f for f in fields(cls)}
    for key in mapping:
        if key not in known:
            raise SceneError(f"{where}.{key}", mapping[key], f"unknown key; known are {', '.join(known)}")
    for name, field in known.items():
        if name not in mapping and field.default is field.default_factory:  # both MISSING: no default
            raise SceneError(f"{where}.{name}", None, "is required")
    try:
        return cls(**mapping)
    except SceneError as error:
        raise error.inside(where) from None
