"""Optional features of a scene as an engine needs them: arrays, clock epochs, scheduled events, energy."""
