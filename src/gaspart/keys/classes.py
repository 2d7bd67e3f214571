"""Dataclasses whose fields are keys of files: checks of fields, and schemas of mappings."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import MISSING, fields
from functools import cache
from typing import TYPE_CHECKING, Any, TypeVar

from gaspart.errors import SceneError, unknown_word
from gaspart.keys import values
from gaspart.keys.kinds import Check, Kind, describe, nullable, record

if TYPE_CHECKING:
    from _typeshed import DataclassInstance


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
