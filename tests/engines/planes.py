"""What flies through planes across an axis, by its definition, flight by flight."""

import numpy as np

PARTS = 200
"""Of a flight under gravity, in each of which the velocity is that in its middle."""


def rows_of(scene):
    """(N,) the number of each particle's species."""
    return np.repeat(np.arange(len(scene.species)), [kind.count for kind in scene.species])


def carried(scene, axis, bins, particles, duration, parts=PARTS):
    """(species, bins) the time integral of m v^2 delta(z - z_i), the mean over the planes of each bin, less
    that at a periodic face and, under gravity, what this has given to the particles below: of one flight of
    each particle. particles: their rows, masses, and at its start places and velocities along the axis;
    duration: of a flight, or of each, which may be negative."""
    rows, masses, places, velocities = particles
    length, periodic = scene.container.lengths[axis], scene.container.periodic[axis]
    pull = scene.gravity[axis] if scene.gravity else 0.0
    found, width = np.zeros((len(scene.species), bins)), length / bins
    edges = np.arange(bins + 1) * width
    steps = parts if pull else 1
    dt = np.broadcast_to(duration, places.shape) / steps
    for step in range(steps):
        v = velocities + pull * (step + 0.5) * dt
        x = places + (velocities + 0.5 * pull * step * dt) * step * dt
        for image in (-1, 0, 1) if periodic else (0,):
            low, high = np.sort([x, x + v * dt], axis=0) + image * length
            way = np.minimum(high[:, None], edges[1:]) - np.maximum(low[:, None], edges[:-1])
            crosses = ((low < 0.0) & (high >= 0.0))[:, None] & periodic
            flux = (masses * np.abs(v) * np.sign(dt))[:, None]
            np.add.at(found, rows, flux * (np.maximum(way, 0.0) / width - crosses))
        middle = (x + 0.5 * v * dt)[:, None]
        below = np.clip((edges[1:] - middle) / width, 0.0, 1.0)  # of the planes of each bin
        np.add.at(found, rows, -(masses * pull * dt)[:, None] * below)
    return found
