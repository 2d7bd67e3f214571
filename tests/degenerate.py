"""Valid scenes in which little happens: few particles, at rest, fixed, alike, or far apart."""

from itertools import product

import gaspart as gp

MOTIONS = ("rest", "parallel", "equal speeds")
"""What particles do: nothing, all the same, or as usual."""
SCENES = [
    (dimension, count, motion, boundary, fixed)
    for dimension, count, motion, boundary, fixed in product(
        (2, 3), (1, 2, 20), MOTIONS, ("periodic", "wall"), (False, True)
    )
    if not (fixed and motion != "rest")
]


def degenerate(dimension, count, motion, boundary, fixed):
    """One of `SCENES`: particles in rows two diameters apart, or at random if they have one speed."""
    container = gp.Container((8.0,) * dimension, boundary)
    if motion == "equal speeds":
        return gp.Scene(container, [gp.Species(count, 0.5, speed=1.0)])
    velocity = ((1.0, 0.5, 0.25) if motion == "parallel" else (0.0, 0.0, 0.0))[:dimension]
    sites = list(product((1.0, 3.0, 5.0, 7.0), repeat=dimension))
    sites += [tuple(x + 1.0 for x in site) for site in sites if max(site) < 7.0]
    particles = [gp.Particle(site, velocity, 0.5, fixed=fixed) for site in sites[:count]]
    return gp.Scene(container, particles=particles)
