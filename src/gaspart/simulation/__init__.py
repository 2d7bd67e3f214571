"""A scene under an engine: Simulation."""
