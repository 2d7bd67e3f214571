"""Contacts across sheared faces: the second particle takes part as its image, and is then put back."""

from gaspart.kernels.compile.policy import inner_helper, inner_kernel
from gaspart.kernels.physics.lees_edwards import FLOW, GRADIENT, UPPER_FACE, displacement
from gaspart.kernels.physics.mass import mass_of
from gaspart.kernels.physics.periodic import nearest
from gaspart.kernels.physics.running_sum import add


@inner_helper
def unfold(flights, i, j, time, space, shear):
    """Let the second of two particles at their contact be its image next to the first, if that is across a
    sheared face. Returns whether it is above (1), below (-1), or neither (0)."""
    if shear is None:
        return 0
    return _unfold(flights, i, j, time, space, shear)


@inner_kernel
def _unfold(flights, i, j, time, space, shear):
    height, length = space.lengths[GRADIENT], space.lengths[FLOW]
    gap = flights[j].position[GRADIENT] - flights[i].position[GRADIENT]
    image = 0
    if gap + gap > height:
        image = -1
    elif gap + gap < -height:
        image = 1
    if image != 0:
        shear.kept[0], shear.kept[1] = flights[j].position[FLOW], flights[j].position[GRADIENT]
        flights[j].position[GRADIENT] += image * height
        x = flights[i].position[FLOW]
        gap = flights[j].position[FLOW] - x + image * displacement(time, shear) % length
        while gap + gap > length or gap + gap < -length:
            gap = nearest(gap, length, True)
        flights[j].position[FLOW] = x + gap
        flights[j].velocity[FLOW] += image * shear.velocity
        shear.kept[2] = flights[j].velocity[FLOW]
    return image


@inner_helper
def fold(flights, j, image, model, tally, shear):
    """Put it back, and add the energy that the faces take: the change of its velocity is the same, but not
    that of its energy."""
    if shear is not None:
        _fold(flights, j, image, model, tally, shear)


@inner_kernel
def _fold(flights, j, image, model, tally, shear):
    if image != 0:
        flights[j].position[FLOW], flights[j].position[GRADIENT] = shear.kept[0], shear.kept[1]
        change = flights[j].velocity[FLOW] - shear.kept[2]
        flights[j].velocity[FLOW] -= image * shear.velocity
        mass = mass_of(j, model.masses, model.law)
        add(tally.wall_energy, UPPER_FACE, image * shear.velocity * mass * change)
