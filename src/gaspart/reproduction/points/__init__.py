"""Points of the grids of a config, with their seeds, kernel variants and module dependencies."""
