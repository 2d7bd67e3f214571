"""Kinds of values, and dataclasses whose fields have them: JSON schemas with checks."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import MISSING, fields
from functools import cache, partial
from typing import TYPE_CHECKING, Any, TypeVar

from gaspart.errors import SceneError, unknown_word
from gaspart.keys import values

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

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


# Dataclasses whose fields are keys of files: checks of fields, and schemas of mappings.


T = TypeVar("T", bound="DataclassInstance")


def declare(kind: Kind) -> dict[str, Any]:
    """Return the metadata of a field of a dataclass."""
    return {"kind": kind}


def documented(cls: type[T]) -> type[T]:
    """Add the declared fields of a dataclass to its docstring: they are described in `declare` alone."""
    rows = []
    for item in fields(cls):
        kind = item.metadata["kind"]
        words = f"{{{', '.join(map(repr, kind['enum']))}}}" if "enum" in kind else item.type
        required = item.default is item.default_factory  # both MISSING
        default = (
            ""
            if required
            else ", optional"
            if item.default in (None, MISSING)
            else f", default {item.default!r}"
        )
        rows.append(f"    {item.name} : {words}{default}\n        {kind['description']}\n")
    cls.__doc__ = f"{cls.__doc__}\n    Parameters\n    ----------\n{''.join(rows)}    "
    return cls


def validate(instance: Any) -> None:
    """Check and convert every field of a frozen dataclass during its construction."""
    for name, check, optional in _checks(instance.__class__):
        value = getattr(instance, name)
        if value is not None or not optional:
            object.__setattr__(instance, name, check(name, value))


@cache
def _checks(cls: Any) -> tuple[tuple[str, Check, bool], ...]:
    """Return the name, the check and a flag of each field of a dataclass.

    The flag is True if the field has the default None.
    """
    return tuple((item.name, item.metadata["kind"].check, item.default is None) for item in fields(cls))


def set_fields(instance: Any, **checked: object) -> None:
    """Write checked values into a frozen dataclass during its construction."""
    for name, value in checked.items():
        object.__setattr__(instance, name, value)
    for name in set(vars(instance)) - {item.name for item in fields(instance)}:
        del vars(instance)[name]  # properties computed from the earlier values


def field_values(instance: Any) -> dict[str, Any]:
    """Return the values of the fields of a dataclass by name, without cached properties."""
    return {item.name: getattr(instance, item.name) for item in fields(instance)}


def schema_of(cls: Any, **more: Kind) -> Kind:
    """Return the JSON schema of a mapping whose keys are the fields of a dataclass."""
    keys = dict(more)
    for item in fields(cls):
        kind = item.metadata["kind"]
        if item.default_factory is not MISSING:
            kind = kind.stating(default=item.default_factory())
        elif item.default is not MISSING:
            kind = (kind if item.default is not None else nullable(kind)).stating(default=item.default)
        keys[item.name] = kind
    purpose = " ".join(cls.__doc__.split("\n\n")[0].split())
    return Kind({"title": cls.__name__, **record(keys, purpose)})


def from_mapping(cls: type[T], mapping: object, where: str) -> T:
    """Make a dataclass from a mapping whose keys are its fields."""
    if not isinstance(mapping, dict):
        raise SceneError(where, mapping, "must be a mapping of keys to values")
    refuse_unknown(cls, mapping, where)
    for field in fields(cls):
        name = field.name
        if name not in mapping and field.default is field.default_factory:  # both MISSING: no default
            raise SceneError(f"{where}.{name}", None, "is required")
    try:
        return cls(**mapping)
    except SceneError as error:
        raise error.inside(where) from None


def refuse_unknown(cls: Any, mapping: dict, where: str) -> None:
    """Raise SceneError for a key that is not a field of a dataclass."""
    names = [item.name for item in fields(cls)]
    for key, value in mapping.items():
        if key not in names:
            raise SceneError(f"{where}.{key}", value, unknown_word(key, names))


def instance_of(cls: type, meaning: str) -> Kind:
    """Return the kind of values that are instances of a dataclass."""

    def check(key: str, value: Any) -> Any:
        if not isinstance(value, cls):
            raise SceneError(key, value, f"must be a {cls.__name__}")
        return value

    return describe(schema_of(cls), meaning, check)


def instances_of(meaning: str, *classes: type, rule: str) -> Kind:
    """Return the kind of lists that contain instances of these dataclasses."""
    items = [schema_of(cls) for cls in classes]
    schema = {"type": "array", "items": items[0] if len(items) == 1 else {"anyOf": items}}

    def check(key: str, value: Any) -> tuple:
        return values.instances(key, value, classes, rule)

    return describe(schema, meaning, check)


# Values of a file, compared with the schema of their keys.


def require(kind: Mapping[str, Any], value: object, where: str) -> None:
    """Raise SceneError if a value in a file breaks a schema."""
    from jsonschema.exceptions import best_match

    error = best_match(_validator()(kind).iter_errors(value))
    if error is None:
        return
    key = ".".join(part for part in (where, *(str(part) for part in error.absolute_path)) if part)
    if error.validator == "additionalProperties":
        properties, patterns = error.schema.get("properties", {}), error.schema.get("patternProperties", {})
        unknown = next(
            name
            for name in error.instance
            if name not in properties and not any(re.search(pattern, name) for pattern in patterns)
        )
        raise SceneError(
            f"{key}.{unknown}".lstrip("."), error.instance[unknown], unknown_word(unknown, properties)
        )
    if error.validator == "required":
        missing = next(name for name in error.validator_value if name not in error.instance)
        raise SceneError(f"{key}.{missing}".lstrip("."), None, "is required")
    raise SceneError(key or "config", error.instance, _rule(error.validator, error.validator_value))


@cache
def _validator() -> Any:
    """Return the validator of JSON schemas.

    Its test that all items of a list differ takes a time proportional to the length of the list.
    """
    from jsonschema import Draft202012Validator, ValidationError
    from jsonschema.validators import extend

    def unique(validator: object, required: bool, items: object, schema: dict) -> Iterable[ValidationError]:
        words = [item for item in items if isinstance(item, str)] if isinstance(items, list) else []
        if required and len(set(words)) < len(words):
            yield ValidationError("not unique")

    return extend(Draft202012Validator, {"uniqueItems": unique})


def _rule(validator: str, expected: Any) -> str:
    """Return in words the rule that a keyword of a JSON schema expresses."""
    if validator == "type":
        types = [expected] if isinstance(expected, str) else expected
        return f"must be of type {' or '.join(types)}"
    words = {
        "exclusiveMinimum": "must be greater than",
        "minimum": "must be at least",
        "exclusiveMaximum": "must be less than",
        "maximum": "must be at most",
        "enum": "must be one of",
        "minItems": "must have this many items at least:",
        "maxItems": "must have this many items at most:",
        "minProperties": "must have this many entries at least:",
        "uniqueItems": "must not name anything twice",
        "maxLength": "must have this many characters at most:",
        "pattern": "must match",
    }
    bound = "" if validator == "uniqueItems" else f" {expected}"
    return words.get(validator, f"breaks the schema's {validator}:") + bound
