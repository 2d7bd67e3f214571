"""Entry of particles from reservoirs behind open faces.

The gas of a reservoir has no excluded volume, so every attempt to enter succeeds. A particle enters at its
own time within a step and flies for the rest of this step. Its first collisions take place at the end of the
step.
"""

from numpy import int64

from gaspart.kernels.compile.policy import inner_helper, inner_kernel
from gaspart.kernels.dsmc.cells import leave_out_absent, locate
from gaspart.kernels.dsmc.model import CROWDED, count_inside, number_at, position_row, velocity_row
from gaspart.kernels.dsmc.motion import wrap
from gaspart.kernels.dsmc.walls import fly_among_faces, press
from gaspart.kernels.obstacles.opening import (
    draw_entering_velocity,
    face_of,
    place_on,
    schedule_next,
    words_of_attempt,
)
from gaspart.kernels.physics.exact_sum import add_exact
from gaspart.kernels.step.model import part_of


@inner_helper
def first_free_slot(reservoirs):
    """Return the first empty slot at the beginning of a step."""
    if reservoirs is not None:
        return count_inside(reservoirs.opened.present)
    return 0


@inner_kernel
def send_in(particles, slot, face, words, context, reservoirs):
    """Write an entering particle to the workspace, and count its momentum and energy. `words`: two random
    words, for its position.
    """
    workspace, i, space = context.workspace, number_at(particles, slot), context.space
    flights, mass = workspace.flights[context.part], workspace.mass[0]
    place_on(flights[0].position, face, words, space.lengths)
    speed, square = draw_entering_velocity(flights[0].velocity, face, reservoirs)
    flights[0].radius = workspace.radius[0]
    press(face, 0, mass * speed, context)
    add_exact(workspace.wall_heat[context.part, face], -0.5 * mass * square)
    reservoirs.opened.entries[face] += 1
    reservoirs.opened.present[i] = 1
    for k in range(len(space.lengths)):
        particles.images[k, i] = 0


@inner_kernel
def count_entered(particles, slot, grid, present):
    """Add an entered particle to the count of its cell; its slot no longer counts as empty."""
    parts, absent = len(grid.counts), len(grid.starts) - 1
    locate(particles, slot, slot + 1, grid)
    leave_out_absent(particles, slot, slot + 1, grid, present)
    for part in range(parts):
        slots = part_of(part, parts, particles.data.shape[1])
        if slots[0] <= slot < slots[1]:
            grid.counts[part, absent] -= 1
            grid.counts[part, grid.cell[slot]] += 1


@inner_kernel
def admit(particles, slot, grid, context, faces, reservoirs):
    """Perform the entries of one step, after the motion of the other particles. `slot`: first empty slot,
    which the first entering particle receives. `reservoirs`: the time of their next attempt is relative to
    the beginning of the step.
    """
    workspace, space, dt = context.workspace, context.space, context.workspace.dt
    flights = workspace.flights[context.part]
    while reservoirs.time[0] < dt:
        if slot == particles.data.shape[1]:
            workspace.counts[context.part, CROWDED] += 1
            break
        wait, where, first, second = words_of_attempt(reservoirs)
        face, time = face_of(where, reservoirs), reservoirs.time[0]
        send_in(particles, slot, face, (first, second), context, reservoirs)
        fly_among_faces(number_at(particles, slot), 0, dt - time, context, None, faces, None)
        for k in range(len(space.lengths)):
            particles.data[position_row(particles, k), slot] = flights[0].position[k]
            particles.data[velocity_row(particles, k), slot] = flights[0].velocity[k]
            if space.periodic[k]:
                wrap(particles, int64(slot), k, space.lengths[k], context)
        count_entered(particles, slot, grid, faces.present)
        schedule_next(time, wait, reservoirs)
        slot += 1
    reservoirs.time[0] -= dt


@inner_helper
def admit_all(particles, slot, grid, context, faces, reservoirs):
    """Perform the entries of one step, if there are reservoirs."""
    if reservoirs is not None:
        admit(particles, slot, grid, context, faces, reservoirs)
