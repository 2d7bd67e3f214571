"""Pictures and films of bodies: spheres by a small ray tracer, discs by their covered parts of pixels."""
