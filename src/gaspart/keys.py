"""Declaration of keys, once for files and for classes: the kind of each value, with its meaning.

    RUN = {"replicas": count("independent runs within the point's job", default=1)}
    radius: float = field(metadata=declared(positive("radius of a particle")))

A config is compared with the schemas of its keys (`require`). A class applies the check of each field when an
instance is made, by a program or from a file (`validate`). Messages, the schemas for editors, the options of
the command line and the reference page follow from the declarations; rules that concern several keys are code
of the class.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import MISSING, fields
from functools import cache
from typing import TYPE_CHECKING, Any, TypeVar

from gaspart import values
from gaspart.errors import SceneError, unknown_word

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

T = TypeVar("T", bound="DataclassInstance")
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
        """The same kind, with more in its schema."""
        return Kind({**self, **more}, self.check)


POSITIVE = Kind({"type": "number", "exclusiveMinimum": 0}, values.positive_number)
NOT_NEGATIVE = Kind({"type": "number", "minimum": 0}, values.not_negative_number)
NUMBER = Kind({"type": "number"}, values.sized_number)
COUNT = Kind({"type": "integer", "minimum": 1}, values.count_of)
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


def instance_of(cls: type, meaning: str) -> Kind:
    """An instance of a dataclass; in a file a mapping of its keys."""

    def check(key: str, value: Any) -> Any:
        if not isinstance(value, cls):
            raise SceneError(key, value, f"must be a {cls.__name__}")
        return value

    return described(schema_of(cls), meaning, check)


def instances_of(meaning: str, *classes: type, rule: str) -> Kind:
    """A list of instances of these dataclasses; the rule is that for one item."""
    items = [schema_of(cls) for cls in classes]
    schema = {"type": "array", "items": items[0] if len(items) == 1 else {"anyOf": items}}

    def check(key: str, value: Any) -> tuple:
        return values.instances(key, value, classes, rule)

    return described(schema, meaning, check)


def nullable(kind: Kind) -> Kind:
    """A kind or null, which counts as absent."""
    key, none = ("enum", None) if "enum" in kind else ("type", "null")
    given = [kind[key]] if isinstance(kind[key], str) else kind[key]
    return kind if none in given else kind.stating(**{key: [*given, none]})


# Classes


def declared(kind: Kind) -> dict[str, Any]:
    """The metadata of a field of a dataclass."""
    return {"kind": kind}


def validate(instance: Any) -> None:
    """Check every field of a frozen dataclass that is being made, and write it in its final type.

    None is accepted where it is the default. Raises SceneError with key, value and rule.
    """
    for name, check, optional in _checks(instance.__class__):
        value = getattr(instance, name)
        if value is not None or not optional:
            object.__setattr__(instance, name, check(name, value))


@cache
def _checks(cls: Any) -> tuple[tuple[str, Check, bool], ...]:
    return tuple((item.name, item.metadata["kind"].check, item.default is None) for item in fields(cls))


def set_fields(instance: object, **checked: object) -> None:
    """Write checked values into a frozen dataclass that is being made."""
    for name, value in checked.items():
        object.__setattr__(instance, name, value)


def schema_of(cls: Any, **more: Kind) -> Kind:
    """The JSON schema of a mapping of the keys of a dataclass, with `more` keys before them."""
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
    """Make the dataclass `cls` from a mapping whose keys must all be fields of it. Raises SceneError."""
    if not isinstance(mapping, dict):
        raise SceneError(where, mapping, "must be a mapping of keys to values")
    known = {f.name: f for f in fields(cls)}
    for key in mapping:
        if key not in known:
            raise SceneError(f"{where}.{key}", mapping[key], unknown_word(key, known))
    for name, field in known.items():
        if name not in mapping and field.default is field.default_factory:  # both MISSING: no default
            raise SceneError(f"{where}.{name}", None, "is required")
    try:
        return cls(**mapping)
    except SceneError as error:
        raise error.inside(where) from None


# Files


def require(kind: Mapping[str, Any], value: object, where: str) -> None:
    """Raise SceneError with the most relevant rule of a schema that a value of a file, at the key `where`,
    breaks."""
    from jsonschema.exceptions import best_match

    error = best_match(_validator()(kind).iter_errors(value))
    if error is None:
        return
    key = ".".join(part for part in (where, *(str(part) for part in error.absolute_path)) if part)
    if error.validator == "additionalProperties":
        known, patterns = error.schema.get("properties", {}), error.schema.get("patternProperties", {})
        unknown = next(
            name
            for name in error.instance
            if name not in known and not any(re.search(pattern, name) for pattern in patterns)
        )
        raise SceneError(
            f"{key}.{unknown}".lstrip("."), error.instance[unknown], unknown_word(unknown, known)
        )
    if error.validator == "required":
        missing = next(name for name in error.validator_value if name not in error.instance)
        raise SceneError(f"{key}.{missing}".lstrip("."), None, "is required")
    raise SceneError(key or "config", error.instance, _rule(error.validator, error.validator_value))


@cache
def _validator() -> Any:
    """The validator of JSON schemas, with a test for uniqueness in a time linear in the length of a list."""
    from jsonschema import Draft202012Validator, ValidationError
    from jsonschema.validators import extend

    def unique(validator: object, wanted: bool, items: object, schema: dict) -> Iterable[ValidationError]:
        words = [item for item in items if isinstance(item, str)] if isinstance(items, list) else []
        if wanted and len(set(words)) < len(words):
            yield ValidationError("not unique")

    return extend(Draft202012Validator, {"uniqueItems": unique})


def _rule(validator: str, wanted: Any) -> str:
    """A JSON schema's keyword in words."""
    if validator == "type":
        types = [wanted] if isinstance(wanted, str) else wanted
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
    bound = "" if validator == "uniqueItems" else f" {wanted}"
    return words.get(validator, f"breaks the schema's {validator}:") + bound
