"""Hard-sphere and hard-disc gases: simulation, measurement, and comparison with theory.

The public names of gaspart are in `__init__.pyi`. They are imported at their first use, so that planning a
workflow does not start a compiler.
"""

import os as _os

from gaspart.public import attach as _attach

if _os.name != "posix":
    raise ImportError("gaspart runs on Linux and macOS; on Windows use the Windows Subsystem for Linux")

__version__ = "0.2.0"
__getattr__, __dir__, __all__ = _attach(__name__)
