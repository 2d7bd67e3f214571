"""Simulated system: container, species, walls, faces, collision law; validated once, no numerics."""
