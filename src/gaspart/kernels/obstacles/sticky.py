"""Sticky walls: slow particles stay, their normal energy becomes that of a vibration."""

from math import sqrt

from gaspart.kernels.compile.policy import inner_kernel
from gaspart.kernels.obstacles.well import mass_of
from gaspart.kernels.physics.running_sum import add


@inner_kernel
def collide_sticky(flights, i, face, model, tally, law, faces):
    """Judge a particle at a sticky face by all the normal energy that it has, in flight and in its
    vibration."""
    axis = face // 2
    side = 1.0 if face % 2 else -1.0
    mass = mass_of(i, model.masses, law)
    before = side * flights[i].velocity[axis]
    held = faces.held[i, axis]
    energy = held + 0.5 * mass * before * before
    if energy < 0.5 * faces.level[face] * faces.level[face] / mass:
        faces.held[i, axis] = energy
        faces.place[i, axis] = 1 if face % 2 else -1
        after = 0.0
    else:
        faces.held[i, axis] = 0.0
        faces.place[i, axis] = 0
        after = -abs(before) if held == 0.0 else -sqrt(2.0 * energy / mass)
    flights[i].velocity[axis] = side * after
    add(tally.wall_impulse, face, mass * (before - after))
