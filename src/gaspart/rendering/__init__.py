"""Pictures and films of particles: spheres by a small ray tracer, discs by their covered parts of pixels."""
