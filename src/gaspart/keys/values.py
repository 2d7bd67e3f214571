"""Checks of single values from a user.

Each check returns the value in its final type, or raises SceneError. All functions can be called with any
object, such as None, text, nan, an integer beyond the range of floats, or an array.
"""

from __future__ import annotations

import math
import numbers
from collections.abc import Iterable, Mapping, Set
from itertools import islice
from typing import Any

from gaspart.errors import SceneError

SMALLEST, LARGEST = 1e-60, 1e60
"""Smallest and largest size of a quantity. Contacts multiply four quantities, and the product must neither
vanish nor overflow."""
MOST_PARTICLES = 2**31 - 1
"""Largest number of particles of a scene or a species; indices have 32 bits."""
MOST_BOXES = 2**26
"""Largest number of boxes of a partition; more exceed the memory of a common machine."""
LARGEST_INTEGER = 2**63 - 1
MOST_LISTED = 50_000
"""Largest number of species, single particles or walls of a scene; each of these is written in the scene's
text."""


def finite(value: object) -> float | None:
    """Return `value` as a finite float, or None for any other object."""
    if isinstance(value, bool) or not isinstance(value, numbers.Real):
        return None
    try:
        result = float(value)
    except (ArithmeticError, TypeError, ValueError):  # an integer or a fraction beyond the range of floats
        return None
    return result if math.isfinite(result) else None


def number(
    key: str,
    value: Any,
    rule: str,
    *,
    above: float = -math.inf,
    least: float = -math.inf,
    most: float = math.inf,
) -> float:
    """Return `value` as a finite float; raise SceneError if it is outside the range."""
    result = finite(value)
    if result is None or not (result > above and least <= result <= most):
        raise SceneError(key, value, rule)
    return result


def size(key: str, value: float | tuple[float, ...]) -> None:
    """Raise SceneError for a number that is too small or too large to compute contacts."""
    largest = max(map(abs, value), default=0.0) if isinstance(value, tuple) else abs(value)
    if largest and not SMALLEST <= largest <= LARGEST:
        rule = f"must be 0 or of a size from {SMALLEST:g} to {LARGEST:g}: choose other units"
        raise SceneError(key, value, rule)


def _refuse_others(key: str, value: Any) -> None:
    """Raise SceneError for text, such as `1.0 K`, and for lists."""
    if isinstance(value, str | bytes):
        raise SceneError(key, value, "must be a number, without a unit")
    if isinstance(value, list | tuple | dict):
        raise SceneError(key, value, "must be a single number")


def positive_number(key: str, value: Any) -> float:
    """Return `value` as a float above 0 of an acceptable `size`."""
    _refuse_others(key, value)
    result = number(key, value, "must be positive", above=0.0)
    if not SMALLEST <= result <= LARGEST:
        raise SceneError(key, value, f"must be from {SMALLEST:g} to {LARGEST:g}: choose other units")
    return result


def not_negative_number(key: str, value: Any) -> float:
    """Return `value` as a float of at least 0 of an acceptable `size`."""
    _refuse_others(key, value)
    result = number(key, value, "must not be negative", least=0.0)
    size(key, result)
    return result


def sized_number(key: str, value: Any) -> float:
    """Return `value` as a float of either sign, which is 0 or of an acceptable `size`."""
    result = number(key, value, "must be a finite number")
    size(key, result)
    return result


def count_of(key: str, value: Any, least: int = 0, most: int = LARGEST_INTEGER) -> int:
    """Return `value` as an integer; raise SceneError if it is outside the range."""
    rule = f"must be a whole number of at least {least}"
    if number(key, value, rule, least=least) != int(value):
        raise SceneError(key, value, rule)
    if int(value) > most:
        raise SceneError(key, value, f"must be at most {most}")
    return int(value)


def finite_vector(key: str, value: Any, dimension: int | None = None) -> tuple[float, ...]:
    """Return `value` as a tuple of finite floats."""
    rule = f"must be a list of {dimension or '2 or 3'} finite numbers"
    components = tuple(number(key, item, rule) for item in _items(key, value, rule, 4))
    if len(components) not in ((2, 3) if dimension is None else (dimension,)):
        raise SceneError(key, value, rule)
    return components


def _items(key: str, value: Any, rule: str, most: int) -> Iterable[Any]:
    """Return the first `most` items of a list, a tuple, an array or an iterator."""
    if isinstance(value, str | bytes | Mapping | Set):
        raise SceneError(key, value, rule)
    try:
        return tuple(islice(value, most))
    except Exception:  # not iterable, or an iterator of the user's code that fails
        raise SceneError(key, value, rule) from None


def instances(key: str, value: Any, kinds: type | tuple[type, ...], rule: str) -> tuple:
    """Return `value` as a tuple of instances of some classes."""
    if isinstance(value, kinds):
        return (value,)
    items: list[Any] = []
    for item in _items(key, value, rule, MOST_LISTED + 1):
        if not isinstance(item, kinds):
            raise SceneError(f"{key}[{len(items)}]", item, rule)
        items.append(item)
    if len(items) > MOST_LISTED:
        raise SceneError(key, len(items), f"must be at most {MOST_LISTED} items")
    return tuple(items)


def true_or_false(key: str, value: Any) -> bool:
    """Return `value` if it is true or false; otherwise raise SceneError."""
    if not isinstance(value, bool):
        raise SceneError(key, value, "must be true or false")
    return value


def one_of(key: str, value: Any, accepted: Iterable[Any]) -> Any:
    """Return `value` if it is an accepted word or number; otherwise raise SceneError."""
    if not any(isinstance(value, type(item)) and value == item for item in accepted):
        raise SceneError(key, value, f"must be one of {tuple(accepted)}")
    return value


def partition(key: str, value: Any) -> int | tuple[int, ...]:
    """Return the number of boxes per side as an integer, or as a tuple."""
    counts = value if isinstance(value, (tuple, list)) else (value,)
    sides = tuple(count_of(key, n, least=1) for n in counts)
    if math.prod(sides) > MOST_BOXES or len(sides) > 3:
        rule = f"must be one number, or one per axis, of at most {MOST_BOXES} boxes"
        raise SceneError(key, value, rule)
    return sides if isinstance(value, (tuple, list)) else sides[0]
