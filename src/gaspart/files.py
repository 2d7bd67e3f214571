"""Files that appear whole or not at all."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from gaspart.errors import SceneError


@contextmanager
def whole_file(path: str | Path) -> Iterator[Path]:
    """Give a `.partial` path to write to; on success it is renamed to `path`, atomically."""
    path = Path(path)
    partial = path.with_name(path.name + ".partial")
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
