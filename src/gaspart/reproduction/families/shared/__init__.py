"""Measurements, words and limits that several families share."""

from __future__ import annotations

SOURCE_A, SOURCE_C = "[source A]", "[source C]"
OTHER_MACHINE = "on this machine, and by this program, tests and boxes have other relative costs"
"""Why an optimum that source A reports need not be the one found here."""
PARTICLES = {2: "discs", 3: "spheres"}
"""Names of the particles in each dimension."""
ENSKOG_LIMIT = 0.02
"""Packing fraction up to which a gas counts as dilute."""
MODE_COUPLING = "hydrodynamic modes of the container, transport coefficients Enskog's (gaspart.theory.modes)"
