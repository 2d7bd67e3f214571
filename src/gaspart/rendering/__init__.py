"""Pictures and films of particles: spheres by a small ray tracer, discs by area coverage."""
