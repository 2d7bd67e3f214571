"""From a config to jobs: grid points and their recipes, seeds, kernel variants, module dependencies."""
