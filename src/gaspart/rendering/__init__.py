"""Pictures and films of particles: spheres by ray tracing, discs by area coverage."""
