"""How numba is loaded: without what its loading wastes, which would be half of a job's start."""

from __future__ import annotations

import gc
import sys
from importlib import import_module
from types import ModuleType
from typing import Any

_LOOKED_FOR = {"coverage", "scipy.linalg.cython_blas"}
"""What numba imports where it finds it: to tell which lines kernels run, and for their matrix products."""


def load_numba(ours: bool = False) -> ModuleType:
    """numba, and all that it would load with a first kernel.

    This makes half a million objects, which stay, so the garbage collector does not look through them now.
    ours: whether this process is one of gaspart's, and no other program's. Then the collector does so neither
    later nor when the process ends, and what numba looks for and kernels of gaspart do not use is hidden from
    it.
    """
    if "numba.np.arraymath" in sys.modules:
        return import_module("numba")
    collecting = gc.isenabled()
    gc.disable()
    hidden: dict[str, Any] = dict.fromkeys(_LOOKED_FOR - set(sys.modules)) if ours else {}
    sys.modules.update(hidden)
    try:
        numba = import_module("numba")
        import_module("numba.core.registry").cpu_target.target_context.refresh()
    finally:
        for name in hidden:
            del sys.modules[name]
        if ours:
            gc.freeze()
        if collecting:
            gc.enable()
    return numba
