"""Public names of packages, imported at their first use.

A package lists its public names once, in the stub `__init__.pyi` next to its `__init__.py`, one line per
name: `from gaspart.scene.scene import Scene as Scene`, or `Z = compressibility_factor` for an alias. Type
checkers and editors read the stub, and `attach` adds its names to the package.
"""

from __future__ import annotations

import sys
from importlib import import_module

TYPE_CHECKING = False
if TYPE_CHECKING:  # takes longer to import than the rest of this module
    from collections.abc import Callable
    from typing import Any


def read_stub(path: str) -> dict[str, str]:
    """Return the module of each name in a stub, including aliases."""
    homes, aliases = entries(path)
    return homes | {alias: homes[name] for alias, name in aliases.items()}


def entries(path: str) -> tuple[dict[str, str], dict[str, str]]:
    """Return the module of each re-exported name in a stub, and the target of each alias."""
    with open(path, encoding="utf-8") as file:
        lines = [line.split() for line in file]
    homes = {words[3]: words[1] for words in lines if len(words) == 6 and words[4] == "as"}
    return homes, {words[0]: words[2] for words in lines if len(words) == 3 and words[1] == "="}


def attach(package: str) -> tuple[Callable[[str], Any], Callable[[], list[str]], list[str]]:
    """Return `__getattr__`, `__dir__` and `__all__` of a package with a stub."""
    namespace = vars(sys.modules[package])
    homes, aliases = entries(f"{namespace['__file__']}i")
    names = [*homes, *aliases]

    def load(name: str) -> Any:
        if name in aliases:
            return namespace.setdefault(name, load(aliases[name]))
        if name not in homes:
            from gaspart.errors import MissingName

            parts = [part for part in ("analysis", "theory") if part in homes]
            inner = [f"{part}.{each}" for part in parts for each in dir(import_module(f"{package}.{part}"))]
            raise MissingName(f"module {package!r}", name, names + inner)
        home = homes[name]
        if home == package:  # a subpackage
            return import_module(f"{package}.{name}")
        return namespace.setdefault(name, getattr(import_module(home), name))

    return load, lambda: sorted(names), names
