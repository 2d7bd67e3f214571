"""Mass of a particle, from the entry of the model that contains it."""

from gaspart.kernels.compile.policy import inner_kernel


@inner_kernel
def mass_of(i, masses, law):
    """Return the mass of a particle that can move, in the kernel's unit."""
    if law is not None:
        return 1.0 / law.inverse_mass[i]
    if masses is not None:
        return masses[i]
    return 1.0
