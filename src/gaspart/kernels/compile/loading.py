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

    This makes half a million objects, which stay. So the garbage collector looks through them neither now nor
    later, nor when the process ends. ours: whether no kernels but those of gaspart will run in this process;
    what numba looks for and they do not use is then hidden from it.
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
        gc.freeze()
        if collecting:
            gc.enable()
    return numba
