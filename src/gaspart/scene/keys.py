"""Declaration of the keys of a scene: each field of its dataclasses carries its rule and its meaning.

    radius: float = field(metadata=declared(POSITIVE, "radius of a particle"))

`validate` applies the rules when an instance is made; `schema_of` derives the JSON schema from them. Rules
that concern several keys are code of the class.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import MISSING, fields
from functools import cache, partial
from typing import Any, NamedTuple

from gaspart import kinds
from gaspart.errors import SceneError
from gaspart.kinds import Kind
from gaspart.scene import validation


class Rule(NamedTuple):
    """A rule for one key: check(key, value) returns the value in its final type or raises SceneError."""

    check: Callable[[str, Any], Any]
    kind: Kind


def declared(rule: Rule, meaning: str) -> dict[str, Any]:
    """The metadata of a field."""
    return {"rule": rule, "meaning": meaning}


def _as_given(_: str, value: Any) -> Any:
    """For a key that the class checks itself."""
    return value


def _sized(name: str, value: Any) -> tuple[float, ...]:
    found = validation.vector(name, value)
    validation.size(name, found)
    return found


def _sized_number(name: str, value: Any) -> float:
    found = validation.number(name, value, "must be a finite number")
    validation.size(name, found)
    return found


def _numbers(least: int, most: int) -> Kind:
    return kinds.listed({"type": "number"}, least=least, most=most)


POSITIVE = Rule(validation.positive, kinds.POSITIVE)
NOT_NEGATIVE = Rule(validation.not_negative, kinds.NOT_NEGATIVE)
NUMBER = Rule(_sized_number, {"type": "number"})
"""A number of either sign, 0 or of an acceptable size."""
FLAG = Rule(validation.flag, kinds.FLAG)
POSITION = Rule(validation.vector, _numbers(2, 3))
VECTOR = Rule(_sized, _numbers(2, 3))
"""Like POSITION, with its largest component 0 or of an acceptable size."""
_AXES = {"minItems": 2, "maxItems": 3}
PER_SIDE = Rule(
    validation.per_side, {**kinds.COUNT, "type": ["integer", "array"], "items": kinds.COUNT, **_AXES}
)
"""Boxes of a partition: a number for all sides, or one for each."""


def vector(dimension: int) -> Rule:
    """A list of `dimension` finite numbers."""
    return Rule(partial(validation.vector, dimension=dimension), _numbers(dimension, dimension))


def two_vectors(dimension: int | None = None) -> Rule:
    """Two lists of `dimension` finite numbers, of 2 or 3 where that is not known."""
    least, most = (2, 3) if dimension is None else (dimension, dimension)

    def check(name: str, value: Any) -> tuple[tuple[float, ...], ...]:
        if not isinstance(value, (tuple, list)) or len(value) != 2:
            raise SceneError(name, value, f"must be two lists of {dimension or '2 or 3'} numbers")
        return tuple(validation.vector(f"{name}[{n}]", item, dimension) for n, item in enumerate(value))

    return Rule(check, kinds.listed(_numbers(least, most), least=2, most=2))


def between(least: float, most: float) -> Rule:
    """A number from `least` to `most`."""
    rule = f"must be from {least:g} to {most:g}"
    kind = {"type": "number", "minimum": least, "maximum": most}
    return Rule(partial(validation.number, rule=rule, least=least, most=most), kind)


def count(most: int | None = None, least: int = 0) -> Rule:
    """A whole number from `least` to `most`."""
    if most is None:
        return Rule(partial(validation.count_of, least=least), {"type": "integer", "minimum": least})
    kind = {"type": "integer", "minimum": least, "maximum": most}
    return Rule(partial(validation.count_of, least=least, most=most), kind)


def choice(*words: str) -> Rule:
    """One of some words."""
    return Rule(partial(validation.choice, known=words), {"enum": list(words)})


def instance_of(cls: type) -> Rule:
    """An instance of a dataclass; in a file a mapping of its keys."""

    def check(name: str, value: Any) -> Any:
        if not isinstance(value, cls):
            raise SceneError(name, value, f"must be a {cls.__name__}")
        return value

    return Rule(check, schema_of(cls))


def list_of(*classes: type, rule: str) -> Rule:
    """A list of instances of these dataclasses; the rule is that for one item."""
    items = [schema_of(cls) for cls in classes]
    kind = {"type": "array", "items": items[0] if len(items) == 1 else {"anyOf": items}}
    return Rule(partial(validation.instances, kinds=classes, rule=rule), kind)


def checked_by_class(kind: Kind) -> Rule:
    """A rule that the class itself checks, because it concerns other keys too."""
    return Rule(_as_given, kind)


def validate(instance: Any) -> None:
    """Check every field of a frozen dataclass that is being made, and write it in its final type.

    None is accepted where it is the default. Raises SceneError with key, value and rule.
    """
    for name, check, optional in _checks(instance.__class__):
        value = getattr(instance, name)
        if value is not None or not optional:
            object.__setattr__(instance, name, check(name, value))


@cache
def _checks(cls: Any) -> tuple[tuple[str, Callable[[str, Any], Any], bool], ...]:
    return tuple((item.name, item.metadata["rule"].check, item.default is None) for item in fields(cls))


def schema_of(cls: Any, **more: Kind) -> Kind:
    """The JSON schema of a mapping of the keys of a dataclass, with `more` keys before them."""
    keys = dict(more)
    for item in fields(cls):
        kind = kinds.described(item.metadata["rule"].kind, item.metadata["meaning"])
        if item.default_factory is not MISSING:
            kind["default"] = item.default_factory()
        elif item.default is not MISSING:
            kind = {**(kind if item.default is not None else kinds.nullable(kind)), "default": item.default}
        keys[item.name] = kind
    purpose = " ".join(cls.__doc__.split("\n\n")[0].split())
    return {"title": cls.__name__, **kinds.record(keys, purpose)}
