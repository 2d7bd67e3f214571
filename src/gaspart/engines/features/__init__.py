"""Optional features of a scene as engines represent them, see `part`."""
