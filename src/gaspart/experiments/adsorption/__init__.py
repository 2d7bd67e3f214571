"""Walls that hold bodies: adsorption."""
