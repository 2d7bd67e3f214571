"""Hard-sphere and hard-disc gases, simulated, measured, and compared with theory.

The public names of gaspart are in `__init__.pyi`. They are loaded when first used, so that planning a
workflow starts no compiler.
"""

from gaspart.public import attach as _attach

__version__ = "0.2.0"
__getattr__, __dir__, __all__ = _attach(__name__, for_users=True)
