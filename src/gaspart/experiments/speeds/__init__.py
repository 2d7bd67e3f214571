"""Speed distributions: speed_relaxation, speed_distribution_spheres, speed_distribution_discs."""
