"""Optional features of a scene in the form of the engines, see `part`."""
