"""The simulated system: container, species, walls, faces, contact law; validated once, no numerics."""
