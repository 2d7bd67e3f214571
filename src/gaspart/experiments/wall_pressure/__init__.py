"""Pressure on walls: wall_pressure."""
