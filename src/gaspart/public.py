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


def attach(
    package: str, for_users: bool = False
) -> tuple[Callable[[str], Any], Callable[[], list[str]], list[str]]:
    """Return `__getattr__`, `__dir__` and `__all__` of a package with a stub.

    for_users : True if calls of its functions are checked for mistakes (`gaspart.errors.guidance`)
    """
    namespace = vars(sys.modules[package])
    homes, aliases = entries(f"{namespace['__file__']}i")
    names = [*homes, *aliases]

    def load(name: str) -> Any:
        if name in aliases:
            return namespace.setdefault(name, load(aliases[name]))
        if name not in homes:
            from gaspart.errors.guidance import MissingName  # takes 2 ms

            raise MissingName(sys.modules[package], name)
        home = homes[name]
        if home == package:  # a subpackage
            return import_module(f"{package}.{name}")
        module = import_module(home)
        member = getattr(module, name)
        if for_users and name not in namespace and not isinstance(member, type) and callable(member):
            from gaspart.errors.guidance import with_call_checks

            member = with_call_checks(member, name)
            setattr(module, name, member)  # pickle requires the same object under both names
        return namespace.setdefault(name, member)

    return load, lambda: sorted(names), names
