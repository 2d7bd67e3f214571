"""Kinds of values, each a JSON schema with a check for fields of classes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

from gaspart.errors import SceneError
from gaspart.keys import values

Check = Callable[[str, Any], Any]
"""check(key, value) returns the value in its final type, or raises SceneError."""


def _as_given(_: str, value: Any) -> Any:
    return value


class Kind(dict[str, Any]):
    """A JSON schema (draft 2020-12): the type, the rules, `description` and, for an optional key, `default`.

    check: for a field of a class; by default the value is taken as it is, and the class itself checks it.
    """

    def __init__(self, schema: Mapping[str, Any], check: Check = _as_given) -> None:
        super().__init__(schema)
        self.check = check

    def stating(self, **more: Any) -> Kind:
        """This kind with more in its schema."""
        return Kind({**self, **more}, self.check)


POSITIVE = Kind({"type": "number", "exclusiveMinimum": 0}, values.positive_number)
NOT_NEGATIVE = Kind({"type": "number", "minimum": 0}, values.not_negative_number)
NUMBER = Kind({"type": "number"}, values.sized_number)
COUNT = Kind({"type": "integer", "minimum": 1}, partial(values.count_of, least=1))
FLAG = Kind({"type": "boolean"}, values.true_or_false)
TEXT = Kind({"type": "string"})
_PER_AXIS = {"minItems": 2, "maxItems": 3}


def described(kind: Mapping[str, Any], meaning: str, check: Check | None = None, **more: Any) -> Kind:
    """A kind, or a schema, with its meaning, and what else the schema is to state, such as `default`."""
    schema = {**kind, **more} | ({"description": meaning} if meaning else {})
    return Kind(schema, check or (kind.check if isinstance(kind, Kind) else _as_given))


def positive(meaning: str, **more: Any) -> Kind:
    """A number above 0."""
    return described(POSITIVE, meaning, **more)


def not_negative(meaning: str, **more: Any) -> Kind:
    """A number of at least 0."""
    return described(NOT_NEGATIVE, meaning, **more)


def signed(meaning: str) -> Kind:
    """A number of either sign, 0 or of an acceptable size."""
    return described(NUMBER, meaning)


def between(meaning: str, least: float, most: float) -> Kind:
    """A number from `least` to `most`."""
    rule = f"must be from {least:g} to {most:g}"

    def check(key: str, value: Any) -> float:
        return values.number(key, value, rule, least=least, most=most)

    return described({"type": "number"}, meaning, check, minimum=least, maximum=most)


def fraction(meaning: str) -> Kind:
    """A number above 0 and at most 1."""

    def check(key: str, value: Any) -> float:
        return values.number(key, value, "must be above 0 and at most 1", above=0.0, most=1.0)

    return described({"type": "number"}, meaning, check, exclusiveMinimum=0, maximum=1)


def count(meaning: str, minimum: int = 1, **more: Any) -> Kind:
    """A whole number; `maximum` is one of the further rules."""

    def check(key: str, value: Any) -> int:
        return values.count_of(key, value, minimum, more.get("maximum", values.LARGEST_INTEGER))

    return described(COUNT, meaning, check, minimum=minimum, **more)


def flag(meaning: str, **more: Any) -> Kind:
    """True or false."""
    return described(FLAG, meaning, **more)


def choice(meaning: str, *known: Any, **more: Any) -> Kind:
    """One of some values."""

    def check(key: str, value: Any) -> Any:
        return values.one_of(key, value, known)

    return described({"enum": list(known)}, meaning, check, **more)


def vector(meaning: str, dimension: int | None = None, sized: bool = True) -> Kind:
    """A list of `dimension` finite numbers, 2 or 3 where that is not known; sized: the largest is 0 or of an
    acceptable size."""

    def check(key: str, value: Any) -> tuple[float, ...]:
        found = values.finite_vector(key, value, dimension)
        if sized:
            values.size(key, found)
        return found

    return described(_numbers(dimension), meaning, check)


def two_vectors(meaning: str, dimension: int | None = None) -> Kind:
    """Two lists of `dimension` finite numbers, of 2 or 3 where that is not known."""

    def check(key: str, value: Any) -> tuple[tuple[float, ...], ...]:
        if not isinstance(value, (tuple, list)) or len(value) != 2:
            raise SceneError(key, value, f"must be two lists of {dimension or '2 or 3'} numbers")
        return tuple(values.finite_vector(f"{key}[{n}]", item, dimension) for n, item in enumerate(value))

    return described(listed(_numbers(dimension), least=2, most=2), meaning, check)


def _numbers(dimension: int | None) -> Kind:
    least, most = (2, 3) if dimension is None else (dimension, dimension)
    return listed({"type": "number"}, least=least, most=most)


def per_side(meaning: str) -> Kind:
    """Boxes of a partition: a number for all sides, or one for each."""
    types = {"type": ["integer", "array"], "items": COUNT}
    return described({**COUNT, **types, **_PER_AXIS}, meaning, values.partition)


def listed(
    item: Mapping[str, Any], meaning: str = "", least: int = 1, most: int | None = None, **more: Any
) -> Kind:
    """A list of `least` to `most` values of one kind."""
    ends = {"minItems": least} | ({} if most is None else {"maxItems": most})
    return described({"type": "array", **ends, "items": item}, meaning, **more)


def names(meaning: str, **more: Any) -> Kind:
    """A list of names, none of them twice."""
    return listed(TEXT, meaning, uniqueItems=True, **more)


def record(keys: Mapping[str, Mapping[str, Any]], meaning: str = "", **more: Any) -> Kind:
    """A mapping of these keys and no others; all are required but those with a default."""
    required = [name for name, kind in keys.items() if "default" not in kind]
    closed = {"type": "object", "additionalProperties": False, "properties": keys}
    return described(closed | ({"required": required} if required else {}), meaning, **more)


def nullable(kind: Kind) -> Kind:
    """A kind or null, which counts as absent."""
    key, none = ("enum", None) if "enum" in kind else ("type", "null")
    given = [kind[key]] if isinstance(kind[key], str) else kind[key]
    return kind if none in given else kind.stating(**{key: [*given, none]})
