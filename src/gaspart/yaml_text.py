"""Reading of YAML within limits, and writing of YAML.

The result is a tree of mappings with text keys, lists, texts, numbers, true, false and null, as defined by
YAML 1.1. In addition, `1e3` is a number. An alias is replaced by a copy; `<<` merges mappings. Tags are
rejected, and dates are text. Duplicate keys are errors.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gaspart.errors import SceneError
from gaspart.files import open_regular, whole_file

if TYPE_CHECKING:
    import yaml

MOST_BYTES, MOST_VALUES, MOST_COPIES, DEEPEST = 2**26, 2_500_000, 100_000, 64
"""Limits of a text: its size, the number of its values, the number of values that come from aliases, and the
depth of nesting. The texts of all valid scenes are within these limits (`keys.values.MOST_LISTED`).
"""
_LONGEST_NUMBER = 1000  # number of characters
_NUMBERS = re.compile(r"[-+]?(\d[\d_]*(\.[\d_]*)?|\.\d[\d_]*)[eE][-+]?\d+\Z")
_SCALARS = tuple(f"tag:yaml.org,2002:{kind}" for kind in ("null", "bool", "int", "float"))
_MERGE = "tag:yaml.org,2002:merge"


def read_yaml(path: str | Path) -> Any:
    """Return the content of a YAML file. If the file cannot be read, raises SceneError that names
    the file.
    """
    try:
        with open_regular(os.fspath(path)) as file:  # not Path, which accepts `file.yaml/`
            text = file.read(MOST_BYTES + 1).decode("utf-8")
    except OSError as error:
        raise SceneError("file", str(path), f"cannot be read: {error.strerror}") from None
    except UnicodeDecodeError:
        raise SceneError("file", str(path), "cannot be read as YAML: it is not text in UTF-8") from None
    except (TypeError, ValueError) as error:  # invalid path, for example one with a NUL
        raise SceneError("file", path, f"cannot be read: {error}") from None
    return parse_yaml(text, str(path))


def parse_yaml(text: str, name: str = "YAML") -> Any:
    """Return the content of a YAML text. Raises SceneError that states `name`, line and column."""
    import yaml

    if not isinstance(text, str):
        raise SceneError("YAML", text, "must be text", name)
    if len(text) > MOST_BYTES:
        raise SceneError("YAML", text, f"must not be longer than {MOST_BYTES >> 20} MiB", name)
    try:
        return _Document(text).read()
    except SceneError as error:
        raise error.inside("", name) from None
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        if mark is None:
            raise SceneError("YAML", text, f"is not valid YAML: {error}", name) from None
        line = "".join(text.split("\n", mark.line + 1)[mark.line : mark.line + 1])
        remedy = "; indent with spaces, not with tabs" if "\t" in line else ""
        rule = f"is not valid YAML: {error.problem}{remedy}"
        raise _error(mark, line.strip() or "the end", rule).inside("", name) from None
    except (yaml.YAMLError, UnicodeEncodeError) as error:  # characters that YAML does not allow
        raise SceneError("YAML", text, f"is not valid YAML: {error}", name) from None


def dump_yaml(content: object) -> str:
    """Return `content` as YAML text; keys keep their order."""
    import yaml

    return yaml.dump(content, Dumper=_dumper(), sort_keys=False, default_flow_style=None)


def write_yaml(path: str | Path, content: object) -> None:
    """Write `content` as a YAML file, atomically."""
    with whole_file(path) as partial:
        partial.write_text(dump_yaml(content), encoding="utf-8")


def is_exponential(text: str) -> bool:
    """Return True for a number such as 1e3, which is text in YAML 1.1."""
    return bool(_NUMBERS.match(text)) and len(text) <= _LONGEST_NUMBER


def _with_exponents(base: Any) -> Any:
    """Return a loader or dumper that treats 1e3 and 1.5e3 as numbers. In YAML 1.1 they are text."""
    subclass: Any = type("WithExponents", (base,), {})
    subclass.add_implicit_resolver(_SCALARS[-1], _NUMBERS, list("-+.0123456789"))
    return subclass


@cache
def _loader() -> Any:
    import yaml

    return _with_exponents(getattr(yaml, "CSafeLoader", yaml.SafeLoader))  # the C version if PyYAML has it


@cache
def _dumper() -> Any:
    import yaml

    return _with_exponents(yaml.SafeDumper)


def _error(mark: yaml.Mark, value: object, rule: str) -> SceneError:
    return SceneError(f"line {mark.line + 1}, column {mark.column + 1}", value, rule)


class _Document:
    """Reader of one document, event by event, within the limits; the depth limit bounds the recursion."""

    def __init__(self, text: str) -> None:
        import yaml

        self._yaml, self._loader = yaml, _loader()(text)
        self._anchors: dict[str, Any] = {}
        self._values, self._copies = 0, 0

    def read(self) -> Any:
        """Return the content. Raises SceneError with line and column, or yaml.YAMLError."""
        yaml = self._yaml
        results: list[Any] = []
        while not isinstance(event := self._loader.get_event(), yaml.StreamEndEvent):
            if isinstance(event, yaml.DocumentStartEvent):
                if results:
                    raise _error(event.start_mark, "---", "begins a second document; there may be one")
                results.append(self._value(self._loader.get_event(), 0))
        return results[0] if results else None

    def _value(self, event: yaml.NodeEvent, depth: int) -> Any:
        """Return the value that begins with an event."""
        yaml, mark = self._yaml, event.start_mark
        self._count(depth, mark)
        if isinstance(event, yaml.AliasEvent):
            if event.anchor not in self._anchors:
                raise _error(mark, f"*{event.anchor}", "no value above has this name")
            return self._copy(self._anchors[event.anchor], depth, mark)
        if event.tag is not None:
            raise _error(mark, event.tag, "tags are not supported")
        if isinstance(event, yaml.ScalarEvent):
            value = self._scalar(event)
        elif isinstance(event, yaml.SequenceStartEvent):
            value = [self._value(item, depth + 1) for item in self._items()]
        else:
            value = self._mapping(depth + 1)
        if event.anchor:
            self._anchors[event.anchor] = value
        return value

    def _items(self) -> Iterator[yaml.NodeEvent]:
        """Yield the first event of each value up to the end of a list or mapping."""
        while not isinstance(event := self._loader.get_event(), self._yaml.CollectionEndEvent):
            yield event

    def _mapping(self, depth: int) -> dict[str, Any]:
        """Return a mapping; its own entries override merged entries."""
        content: dict[str, Any] = {}
        merged: dict[str, Any] = {}
        lines: dict[str, int] = {}
        for event in self._items():
            mark = event.start_mark
            if isinstance(event, self._yaml.ScalarEvent) and self._tag(event) == _MERGE:
                self._count(depth, mark)
                first = self._loader.get_event()
                parts = value if isinstance(value := self._value(first, depth), list) else [value]
                if merged or not all(isinstance(part, dict) for part in parts):
                    rule = "<< must be given once, with a mapping or a list of mappings"
                    raise _error(first.start_mark, value, rule)
                for part in reversed(parts):  # earlier entries take precedence
                    merged.update(part)
                continue
            if isinstance(event, self._yaml.CollectionStartEvent):
                raise _error(mark, "a list or mapping", "a key must be text")
            key = self._value(event, depth)
            if not isinstance(key, str):
                number = isinstance(key, int | float) and not isinstance(key, bool)
                remedy = "a decimal has a point, not a comma" if number else "write it in quotes"
                raise _error(mark, key, f"a key must be text: {remedy}")
            if key.endswith(")") and "(" not in key:
                raise _error(mark, key, "ends a list, which is written in square brackets: [1.0, 2.0]")
            if key in lines:
                raise _error(mark, key, f"is a duplicate key, first in line {lines[key]}")
            lines[key] = mark.line + 1
            content[key] = self._value(self._loader.get_event(), depth)
        return {**merged, **content} if merged else content

    def _tag(self, event: yaml.ScalarEvent) -> str:
        return str(self._loader.resolve(self._yaml.ScalarNode, event.value, event.implicit))

    def _scalar(self, event: yaml.ScalarEvent) -> Any:
        tag, text = self._tag(event), event.value
        if tag not in _SCALARS:
            return text
        if len(text) > _LONGEST_NUMBER:
            raise _error(event.start_mark, text, "has too many digits")
        node = self._yaml.ScalarNode(tag, text, event.start_mark, event.end_mark)
        try:
            return self._loader.yaml_constructors[tag](self._loader, node)
        except (ArithmeticError, ValueError):
            raise _error(event.start_mark, text, "is not a number that can be read") from None

    def _copy(self, value: Any, depth: int, mark: yaml.Mark) -> Any:
        """Return a copy of the value of an alias; the copied values count as written values."""
        self._count(depth, mark)
        self._copies += 1
        if self._copies > MOST_COPIES:
            raise _error(mark, self._copies, f"aliases may give {MOST_COPIES} values")
        if isinstance(value, dict):
            return {key: self._copy(item, depth + 1, mark) for key, item in value.items()}
        if isinstance(value, list):
            return [self._copy(item, depth + 1, mark) for item in value]
        return value

    def _count(self, depth: int, mark: yaml.Mark) -> None:
        self._values += 1
        if self._values > MOST_VALUES:
            raise _error(mark, self._values, f"there may be {MOST_VALUES} values")
        if depth > DEEPEST:
            raise _error(mark, depth, f"values may be nested {DEEPEST} deep")
