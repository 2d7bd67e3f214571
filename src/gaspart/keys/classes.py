"""Keys that are the fields of a dataclass: their checks, and the schema of a mapping of them."""

from __future__ import annotations

from dataclasses import MISSING, fields
from functools import cache
from typing import TYPE_CHECKING, Any, TypeVar

from gaspart.errors import SceneError, unknown_word
from gaspart.keys import values
from gaspart.keys.kinds import Check, Kind, described, nullable, record

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

T = TypeVar("T", bound="DataclassInstance")


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


def set_fields(instance: Any, **checked: object) -> None:
    """Write checked values into a frozen dataclass that is being made."""
    for name, value in checked.items():
        object.__setattr__(instance, name, value)
    for name in set(vars(instance)) - {item.name for item in fields(instance)}:
        del vars(instance)[name]  # facts of the values before


def stated(instance: Any) -> dict[str, Any]:
    """Return the fields of a dataclass by name, without cached properties."""
    return {item.name: getattr(instance, item.name) for item in fields(instance)}


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
    """Raise SceneError for a key that is no field of a dataclass."""
    known = [item.name for item in fields(cls)]
    for key, value in mapping.items():
        if key not in known:
            raise SceneError(f"{where}.{key}", value, unknown_word(key, known))


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
