"""Values of a file, compared with the schema of their keys."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from functools import cache
from typing import Any

from gaspart.errors import SceneError, unknown_word


def require(kind: Mapping[str, Any], value: object, where: str) -> None:
    """Raise SceneError if a value of a file breaks a schema.

    Parameters
    ----------
    kind : mapping
        JSON schema.
    value : object
        Value of the file.
    where : str
        Key of the value in the file; "" for the complete file.

    Raises
    ------
    SceneError
        With the most relevant rule that the value breaks.
    """
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
    """Return the validator of JSON schemas.

    Its test of uniqueness takes a time linear in the length of a list.
    """
    from jsonschema import Draft202012Validator, ValidationError
    from jsonschema.validators import extend

    def unique(validator: object, wanted: bool, items: object, schema: dict) -> Iterable[ValidationError]:
        words = [item for item in items if isinstance(item, str)] if isinstance(items, list) else []
        if wanted and len(set(words)) < len(words):
            yield ValidationError("not unique")

    return extend(Draft202012Validator, {"uniqueItems": unique})


def _rule(validator: str, wanted: Any) -> str:
    """Return the rule of a JSON schema's keyword in words."""
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
