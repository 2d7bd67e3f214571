"""The simulated system: container, species, walls, faces, contact law. Immutable, validated once; no numerics."""
