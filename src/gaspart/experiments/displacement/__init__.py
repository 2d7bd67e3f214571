"""Mean-squared displacement: msd_spheres, msd_discs."""
