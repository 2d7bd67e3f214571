"""Optional features of a scene in the form that the engines need: see `part`."""
