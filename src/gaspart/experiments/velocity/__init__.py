"""Memory of velocities: velocity_autocorrelation."""
