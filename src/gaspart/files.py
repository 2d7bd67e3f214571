"""YAML in and out, and files that appear whole or not at all."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any

from gaspart.errors import SceneError
from gaspart.interruption import scratch_file


@cache
def _loader() -> type:
    import yaml

    # the same in C where PyYAML was built with it
    fastest: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)

    class Loader(fastest):
        """YAML 1.1 reads 1e-3 as text; people mean a number."""

    Loader.add_implicit_resolver(
        "tag:yaml.org,2002:float",
        re.compile(r"^[-+]?(\d[\d_]*)(\.\d*)?[eE][-+]?\d+$"),
        list("-+0123456789"),
    )
    return Loader


def parse_yaml(text: str, name: str = "YAML") -> Any:
    """The content of a YAML text, safely loaded. Raises SceneError naming `name`."""
    import yaml

    try:
        return yaml.load(text, Loader=_loader())  # a SafeLoader: nothing is evaluated
    except yaml.YAMLError as error:
        first = " ".join(str(error).split())
        raise SceneError("YAML", first, "is not valid", name) from None


def read_yaml(path: str | Path) -> Any:
    """The content of a YAML file. Raises SceneError if it cannot be read."""
    try:
        text = Path(path).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise SceneError("file", str(path), f"cannot be read: {error}") from None
    return parse_yaml(text, str(path))


def dump_yaml(content: object) -> str:
    """`content` as YAML text, keys in their own order."""
    import yaml

    return yaml.safe_dump(content, sort_keys=False, default_flow_style=None)


def write_yaml(path: str | Path, content: object) -> None:
    """Write `content` as a YAML file, whole or not at all."""
    with whole_file(path) as partial:
        partial.write_text(dump_yaml(content), encoding="utf-8")


@contextmanager
def whole_file(path: str | Path) -> Iterator[Path]:
    """Give a `.partial` path to write to; on success it is renamed to `path`, atomically."""
    path = Path(path)
    partial = path.with_name(path.name + ".partial")
    with scratch_file(partial):
        yield partial
        os.replace(partial, path)


@contextmanager
def writing(path: str | Path) -> Iterator[Path]:
    """A `.partial` path, as `whole_file` gives; one SceneError for a missing folder, a full disk ..."""
    try:
        with whole_file(path) as partial:
            partial.touch()  # what cannot be written is found out before the work is done
            yield partial
    except OSError as error:
        partial.unlink(missing_ok=True)
        why = error.strerror or "its writer has stopped"
        raise SceneError("path", str(path), f"cannot be written: {why}") from None
