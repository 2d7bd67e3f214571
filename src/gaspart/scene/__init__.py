"""Simulated system: container, species, walls, faces and collision law; validated on creation."""
