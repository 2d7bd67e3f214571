"""Memory of velocities."""

TITLE = "Memory of velocities"
FIGURES = ("velocity_autocorrelation",)
