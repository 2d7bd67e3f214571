"""Kinds of values: JSON schemas with checks for fields of classes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

from gaspart.errors import SceneError
from gaspart.keys import values

Check = Callable[[str, Any], Any]
"""Function check(key, value) that returns the value in its final type, or raises SceneError."""


def _identity(_: str, value: Any) -> Any:
    """Return the value unchanged."""
    return value


class Kind(dict[str, Any]):
    """JSON schema (draft 2020-12): the type, the rules, `description` and, for an optional key, `default`."""

    def __init__(self, schema: Mapping[str, Any], check: Check = _identity) -> None:
        super().__init__(schema)
        self.check = check

    def stating(self, **more: Any) -> Kind:
        """Return this kind with further entries in its schema."""
        return Kind({**self, **more}, self.check)


POSITIVE = Kind({"type": "number", "exclusiveMinimum": 0}, values.positive_number)
NOT_NEGATIVE = Kind({"type": "number", "minimum": 0}, values.not_negative_number)
NUMBER = Kind({"type": "number"}, values.sized_number)
COUNT = Kind({"type": "integer", "minimum": 1}, partial(values.count_of, least=1))
FLAG = Kind({"type": "boolean"}, values.true_or_false)
TEXT = Kind({"type": "string"})
_PER_AXIS = {"minItems": 2, "maxItems": 3}


def describe(kind: Mapping[str, Any], meaning: str, check: Check | None = None, **more: Any) -> Kind:
    """Return a copy of a kind with a meaning and further entries in its schema."""
    schema = {**kind, **more} | ({"description": meaning} if meaning else {})
    return Kind(schema, check or (kind.check if isinstance(kind, Kind) else _identity))


def positive(meaning: str, **more: Any) -> Kind:
    """Return the kind of a number above 0."""
    return describe(POSITIVE, meaning, **more)


def not_negative(meaning: str, **more: Any) -> Kind:
    """Return the kind of a number of at least 0."""
    return describe(NOT_NEGATIVE, meaning, **more)


def real(meaning: str) -> Kind:
    """Return the kind of a number of either sign, 0 or with an acceptable size."""
    return describe(NUMBER, meaning)


def in_range(meaning: str, least: float, most: float) -> Kind:
    """Return the kind of a number in a range."""
    rule = f"must be from {least:g} to {most:g}"

    def check(key: str, value: Any) -> float:
        return values.number(key, value, rule, least=least, most=most)

    return describe({"type": "number"}, meaning, check, minimum=least, maximum=most)


def fraction(meaning: str) -> Kind:
    """Return the kind of a number above 0 and at most 1."""

    def check(key: str, value: Any) -> float:
        return values.number(key, value, "must be above 0 and at most 1", above=0.0, most=1.0)

    return describe({"type": "number"}, meaning, check, exclusiveMinimum=0, maximum=1)


def count(meaning: str, minimum: int = 1, **more: Any) -> Kind:
    """Return the kind of an integer."""

    def check(key: str, value: Any) -> int:
        return values.count_of(key, value, minimum, more.get("maximum", values.LARGEST_INTEGER))

    return describe(COUNT, meaning, check, minimum=minimum, **more)


def flag(meaning: str, **more: Any) -> Kind:
    """Return the kind of a boolean."""
    return describe(FLAG, meaning, **more)


def choice(meaning: str, *accepted: Any, **more: Any) -> Kind:
    """Return the kind of a value from a list."""

    def check(key: str, value: Any) -> Any:
        return values.one_of(key, value, accepted)

    return describe({"enum": list(accepted)}, meaning, check, **more)


def vector(meaning: str, dimension: int | None = None, sized: bool = True) -> Kind:
    """Return the kind of a list of finite numbers."""

    def check(key: str, value: Any) -> tuple[float, ...]:
        components = values.finite_vector(key, value, dimension)
        if sized:
            values.size(key, components)
        return components

    return describe(_numbers(dimension), meaning, check)


def two_vectors(meaning: str, dimension: int | None = None) -> Kind:
    """Return the kind of two lists of finite numbers."""

    def check(key: str, value: Any) -> tuple[tuple[float, ...], ...]:
        if not isinstance(value, (tuple, list)) or len(value) != 2:
            raise SceneError(key, value, f"must be two lists of {dimension or '2 or 3'} numbers")
        return tuple(values.finite_vector(f"{key}[{n}]", item, dimension) for n, item in enumerate(value))

    return describe(list_of(_numbers(dimension), least=2, most=2), meaning, check)


def _numbers(dimension: int | None) -> Kind:
    """Return the kind of a list of numbers that is as long as a vector."""
    least, most = (2, 3) if dimension is None else (dimension, dimension)
    return list_of({"type": "number"}, least=least, most=most)


def per_side(meaning: str) -> Kind:
    """Return the kind of the numbers of boxes along the sides of a container."""
    types = {"type": ["integer", "array"], "items": COUNT}
    return describe({**COUNT, **types, **_PER_AXIS}, meaning, values.partition)


def list_of(
    item: Mapping[str, Any], meaning: str = "", least: int = 1, most: int | None = None, **more: Any
) -> Kind:
    """Return the kind of a list of values of the same kind."""
    ends = {"minItems": least} | ({} if most is None else {"maxItems": most})
    return describe({"type": "array", **ends, "items": item}, meaning, **more)


def names(meaning: str, **more: Any) -> Kind:
    """Return the kind of a list of distinct names."""
    return list_of(TEXT, meaning, uniqueItems=True, **more)


def record(keys: Mapping[str, Mapping[str, Any]], meaning: str = "", **more: Any) -> Kind:
    """Return the kind of a mapping that may have these keys only."""
    required = [name for name, kind in keys.items() if "default" not in kind]
    closed = {"type": "object", "additionalProperties": False, "properties": keys}
    return describe(closed | ({"required": required} if required else {}), meaning, **more)


def nullable(kind: Kind) -> Kind:
    """Return a kind that also accepts null, which means that there is no value."""
    key, none = ("enum", None) if "enum" in kind else ("type", "null")
    accepted = [kind[key]] if isinstance(kind[key], str) else kind[key]
    return kind if none in accepted else kind.stating(**{key: [*accepted, none]})
