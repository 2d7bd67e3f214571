"""The figures of the reproduction, a module for each or for a few that share a measurement; see `Parts`."""
