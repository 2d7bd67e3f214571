"""From a config to jobs: points of grids, with their seeds, kernel variants and module dependencies."""
