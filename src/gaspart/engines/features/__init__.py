"""Optional features of a scene as the engines need them, one module for each: see `part`."""
