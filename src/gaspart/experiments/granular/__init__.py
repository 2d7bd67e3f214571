"""Rough and inelastic bodies: equipartition, cooling."""
