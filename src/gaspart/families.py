"""Which family of modules makes which figure: one line a figure.

A figure ``f`` of family ``m`` is measured by ``gaspart.measure.m.f``, judged by ``gaspart.claims.m.f`` and
drawn by ``gaspart.figures.m.f``. This table stands alone so that planning a workflow imports nothing else.
"""

from __future__ import annotations

FAMILIES = {
    "naive_scaling": "scaling",
    "box_count": "scaling",
    "ideal_boxes": "scaling",
    "linear_scaling": "scaling",
    "event_scaling": "scaling",
    "radius_grid": "radius",
    "fill_failures": "insertion",
    "virial_discs": "virial",
    "virial_spheres": "virial",
    "speed_relaxation": "speeds",
    "speed_distribution_spheres": "speeds",
    "speed_distribution_discs": "speeds",
    "msd_spheres": "displacement",
    "msd_discs": "displacement",
    "wall_pressure": "wall_pressure",
    "barometric": "gravity",
    "separation": "gravity",
    "heat_capacity": "gravity",
    "buoyancy": "buoyancy",
    "thin_film": "film",
    "freezing_discs": "freezing",
    "freezing_spheres": "freezing",
    "densest_fill": "packing",
    "gas_render": "pictures",
    "brownian_paths": "brownian",
    "brownian_render": "pictures",
    "brownian_msd": "brownian",
    "equipartition": "granular",
    "cooling": "granular",
    "velocity_autocorrelation": "velocity",
    "heat_conduction_gas": "heat",
    "adsorption": "adsorption",
    "heat_conduction_metal": "heat",
    "speed_accuracy": "tradeoff",
    "reversibility": "reversibility",
}

TITLES = {
    "scaling": "What space partitioning buys",
    "radius": "Radius, density and number of bodies",
    "insertion": "Random insertion",
    "virial": "Equation of state",
    "speeds": "Speed distributions",
    "displacement": "Mean-squared displacement",
    "wall_pressure": "Pressure on walls",
    "gravity": "Under gravity",
    "buoyancy": "Under gravity",
    "film": "Thin films",
    "freezing": "Freezing and melting",
    "brownian": "A large body in a gas",
    "packing": "Random insertion",
    "pictures": "Pictures",
    "granular": "Rough and inelastic bodies",
    "velocity": "Memory of velocities",
    "heat": "Heat between walls",
    "adsorption": "Walls that hold bodies",
    "tradeoff": "Speed against accuracy",
    "reversibility": "Speed against accuracy",
}
