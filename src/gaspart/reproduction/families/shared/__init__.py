"""Measurements, texts and limits that several families share."""

from __future__ import annotations

SOURCE_C = "[source C]"
PARTICLES = {2: "discs", 3: "spheres"}
"""Names of the particles in each dimension."""
ENSKOG_LIMIT = 0.02
"""Largest packing fraction of a gas that counts as dilute."""
MODE_COUPLING = "hydrodynamic modes of the container, transport coefficients Enskog's (gaspart.theory.modes)"
