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
    """JSON schema (draft 2020-12): the type, the rules, `description` and, for an optional key, `default`.

    Parameters
    ----------
    schema : mapping
        Entries of the schema.
    check : Check, optional
        Check of a field of a class. Default: no check, because the class itself checks the value.
    """

    def __init__(self, schema: Mapping[str, Any], check: Check = _identity) -> None:
        super().__init__(schema)
        self.check = check

    def stating(self, **more: Any) -> Kind:
        """Return this kind with further entries in its schema.

        Parameters
        ----------
        **more : object
            Entries. They replace existing entries of the same name.

        Returns
        -------
        Kind
            New kind with the same check.
        """
        return Kind({**self, **more}, self.check)


POSITIVE = Kind({"type": "number", "exclusiveMinimum": 0}, values.positive_number)
NOT_NEGATIVE = Kind({"type": "number", "minimum": 0}, values.not_negative_number)
NUMBER = Kind({"type": "number"}, values.sized_number)
COUNT = Kind({"type": "integer", "minimum": 1}, partial(values.count_of, least=1))
FLAG = Kind({"type": "boolean"}, values.true_or_false)
TEXT = Kind({"type": "string"})
_PER_AXIS = {"minItems": 2, "maxItems": 3}


def describe(kind: Mapping[str, Any], meaning: str, check: Check | None = None, **more: Any) -> Kind:
    """Return a copy of a kind with a meaning and further entries in its schema.

    Parameters
    ----------
    kind : Kind or mapping
        Kind or JSON schema.
    meaning : str
        Description; "" for no description.
    check : Check, optional
        Check for a field of a class. Default: the check of `kind`.
    **more : object
        Further entries of the schema, such as `default`.

    Returns
    -------
    Kind
        New kind.
    """
    schema = {**kind, **more} | ({"description": meaning} if meaning else {})
    return Kind(schema, check or (kind.check if isinstance(kind, Kind) else _identity))


def positive(meaning: str, **more: Any) -> Kind:
    """Return the kind of a number above 0.

    Parameters
    ----------
    meaning : str
        Description.
    **more : object
        Further entries of the schema.

    Returns
    -------
    Kind
        The kind; its check returns a float.
    """
    return describe(POSITIVE, meaning, **more)


def not_negative(meaning: str, **more: Any) -> Kind:
    """Return the kind of a number of at least 0.

    Parameters
    ----------
    meaning : str
        Description.
    **more : object
        Further entries of the schema.

    Returns
    -------
    Kind
        The kind; its check returns a float.
    """
    return describe(NOT_NEGATIVE, meaning, **more)


def real(meaning: str) -> Kind:
    """Return the kind of a number of either sign, 0 or with an acceptable size.

    Parameters
    ----------
    meaning : str
        Description.

    Returns
    -------
    Kind
        The kind; its check returns a float.
    """
    return describe(NUMBER, meaning)


def in_range(meaning: str, least: float, most: float) -> Kind:
    """Return the kind of a number in a range.

    Parameters
    ----------
    meaning : str
        Description.
    least, most : float
        Ends of the range, which belong to it.

    Returns
    -------
    Kind
        The kind; its check returns a float.
    """
    rule = f"must be from {least:g} to {most:g}"

    def check(key: str, value: Any) -> float:
        return values.number(key, value, rule, least=least, most=most)

    return describe({"type": "number"}, meaning, check, minimum=least, maximum=most)


def fraction(meaning: str) -> Kind:
    """Return the kind of a number above 0 and at most 1.

    Parameters
    ----------
    meaning : str
        Description.

    Returns
    -------
    Kind
        The kind; its check returns a float.
    """

    def check(key: str, value: Any) -> float:
        return values.number(key, value, "must be above 0 and at most 1", above=0.0, most=1.0)

    return describe({"type": "number"}, meaning, check, exclusiveMinimum=0, maximum=1)


def count(meaning: str, minimum: int = 1, **more: Any) -> Kind:
    """Return the kind of an integer.

    Parameters
    ----------
    meaning : str
        Description.
    minimum : int, default 1
        Smallest value.
    **more : object
        Further entries of the schema, such as `maximum`.

    Returns
    -------
    Kind
        The kind; its check returns an int.
    """

    def check(key: str, value: Any) -> int:
        return values.count_of(key, value, minimum, more.get("maximum", values.LARGEST_INTEGER))

    return describe(COUNT, meaning, check, minimum=minimum, **more)


def flag(meaning: str, **more: Any) -> Kind:
    """Return the kind of a boolean.

    Parameters
    ----------
    meaning : str
        Description.
    **more : object
        Further entries of the schema.

    Returns
    -------
    Kind
        The kind; its check returns a bool.
    """
    return describe(FLAG, meaning, **more)


def choice(meaning: str, *accepted: Any, **more: Any) -> Kind:
    """Return the kind of a value from a list.

    Parameters
    ----------
    meaning : str
        Description.
    *accepted : object
        Accepted values.
    **more : object
        Further entries of the schema.

    Returns
    -------
    Kind
        The kind; its check returns the value.
    """

    def check(key: str, value: Any) -> Any:
        return values.one_of(key, value, accepted)

    return describe({"enum": list(accepted)}, meaning, check, **more)


def vector(meaning: str, dimension: int | None = None, sized: bool = True) -> Kind:
    """Return the kind of a list of finite numbers.

    Parameters
    ----------
    meaning : str
        Description.
    dimension : int, optional
        Number of components. Default: 2 or 3 are both accepted.
    sized : bool, default True
        Require that the largest component is 0 or of an acceptable size.

    Returns
    -------
    Kind
        The kind; its check returns a tuple of float.
    """

    def check(key: str, value: Any) -> tuple[float, ...]:
        components = values.finite_vector(key, value, dimension)
        if sized:
            values.size(key, components)
        return components

    return describe(_numbers(dimension), meaning, check)


def two_vectors(meaning: str, dimension: int | None = None) -> Kind:
    """Return the kind of two lists of finite numbers.

    Parameters
    ----------
    meaning : str
        Description.
    dimension : int, optional
        Number of components of each list. Default: 2 or 3 are both accepted.

    Returns
    -------
    Kind
        The kind; its check returns a tuple of tuples of float.
    """

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
    """Return the kind of the numbers of boxes along the sides of a container.

    Parameters
    ----------
    meaning : str
        Description.

    Returns
    -------
    Kind
        Kind of a number for all sides, or of a list with a number for each side. Its check is
        `values.partition`.
    """
    types = {"type": ["integer", "array"], "items": COUNT}
    return describe({**COUNT, **types, **_PER_AXIS}, meaning, values.partition)


def list_of(
    item: Mapping[str, Any], meaning: str = "", least: int = 1, most: int | None = None, **more: Any
) -> Kind:
    """Return the kind of a list of values of the same kind.

    Parameters
    ----------
    item : mapping
        Kind or JSON schema of an item.
    meaning : str, default ""
        Description.
    least : int, default 1
        Smallest number of items.
    most : int, optional
        Largest number of items. Default: no limit.
    **more : object
        Further entries of the schema.

    Returns
    -------
    Kind
        New kind, without a check.
    """
    ends = {"minItems": least} | ({} if most is None else {"maxItems": most})
    return describe({"type": "array", **ends, "items": item}, meaning, **more)


def names(meaning: str, **more: Any) -> Kind:
    """Return the kind of a list of distinct names.

    Parameters
    ----------
    meaning : str
        Description.
    **more : object
        Further entries of the schema.

    Returns
    -------
    Kind
        New kind, without a check.
    """
    return list_of(TEXT, meaning, uniqueItems=True, **more)


def record(keys: Mapping[str, Mapping[str, Any]], meaning: str = "", **more: Any) -> Kind:
    """Return the kind of a mapping that may have these keys only.

    Parameters
    ----------
    keys : mapping of str to mapping
        Kind of each key. All keys are required except keys with a default.
    meaning : str, default ""
        Description.
    **more : object
        Further entries of the schema.

    Returns
    -------
    Kind
        New kind, without a check.
    """
    required = [name for name, kind in keys.items() if "default" not in kind]
    closed = {"type": "object", "additionalProperties": False, "properties": keys}
    return describe(closed | ({"required": required} if required else {}), meaning, **more)


def nullable(kind: Kind) -> Kind:
    """Return a kind that also accepts null, which means that there is no value.

    Parameters
    ----------
    kind : Kind
        Kind of the value.

    Returns
    -------
    Kind
        The same kind if it accepts null, otherwise a new kind.
    """
    key, none = ("enum", None) if "enum" in kind else ("type", "null")
    accepted = [kind[key]] if isinstance(kind[key], str) else kind[key]
    return kind if none in accepted else kind.stating(**{key: [*accepted, none]})
