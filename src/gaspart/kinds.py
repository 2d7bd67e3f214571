"""Kinds of values that a key of a file may have, each as a part of a JSON schema (draft 2020-12).

A key is declared by a kind with its meaning, as in `count("bins of the histogram")`; validation, messages,
the schemas for editors and the reference page follow from these declarations.
"""

from __future__ import annotations

from typing import Any

Kind = dict[str, Any]
"""A JSON schema: the type, the rules that are checked, `description` and, for an optional key, `default`."""

POSITIVE: Kind = {"type": "number", "exclusiveMinimum": 0}
NOT_NEGATIVE: Kind = {"type": "number", "minimum": 0}
COUNT: Kind = {"type": "integer", "minimum": 1}
FLAG: Kind = {"type": "boolean"}
TEXT: Kind = {"type": "string"}


def described(kind: Kind, meaning: str, **more: Any) -> Kind:
    """A kind with its meaning, and what else the schema is to state, such as `default` or `maximum`."""
    return {**kind, **more} | ({"description": meaning} if meaning else {})


def positive(meaning: str, **more: Any) -> Kind:
    """A number above 0."""
    return described(POSITIVE, meaning, **more)


def count(meaning: str, minimum: int = 1, **more: Any) -> Kind:
    """A whole number."""
    return described(COUNT, meaning, minimum=minimum, **more)


def flag(meaning: str, **more: Any) -> Kind:
    """True or false."""
    return described(FLAG, meaning, **more)


def choice(meaning: str, *values: Any, **more: Any) -> Kind:
    """One of some values."""
    return described({"enum": list(values)}, meaning, **more)


def listed(item: Kind, meaning: str = "", least: int = 1, most: int | None = None, **more: Any) -> Kind:
    """A list of `least` to `most` values of one kind."""
    ends = {"minItems": least} | ({} if most is None else {"maxItems": most})
    return described({"type": "array", **ends, "items": item}, meaning, **more)


def names(meaning: str, **more: Any) -> Kind:
    """A list of names, none of them twice."""
    return listed(TEXT, meaning, uniqueItems=True, **more)


def record(keys: dict[str, Kind], meaning: str = "", **more: Any) -> Kind:
    """A mapping of these keys and no others; all are required but those with a default."""
    required = [name for name, kind in keys.items() if "default" not in kind]
    closed = {"type": "object", "additionalProperties": False, "properties": keys}
    return described(closed | ({"required": required} if required else {}), meaning, **more)


def nullable(kind: Kind) -> Kind:
    """A kind or null, which counts as absent."""
    key, none = ("enum", None) if "enum" in kind else ("type", "null")
    values = [kind[key]] if isinstance(kind[key], str) else kind[key]
    return kind if none in values else {**kind, key: [*values, none]}
