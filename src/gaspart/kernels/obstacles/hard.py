"""Hard faces: what passes at a contact with one at rest."""

from gaspart.kernels.compile.policy import inner_helper
from gaspart.kernels.physics.collision import collide_wall_by_law
from gaspart.kernels.physics.mass import mass_of


@inner_helper
def bounce(flights, i, face, model, tally, law):
    """Reflect a particle, by the law of contacts if there is one. Returns the momentum given to the face."""
    axis = face // 2
    if law is None:
        velocity = flights[i].velocity[axis]
        flights[i].velocity[axis] = -velocity
        return 2.0 * mass_of(i, model.masses, law) * abs(velocity)
    side = 1.0 if face % 2 else -1.0
    normal = side if axis == 0 else 0.0, side if axis == 1 else 0.0, side if axis == 2 else 0.0
    return collide_wall_by_law(flights, i, normal, 0.0, model.space, tally, law)
