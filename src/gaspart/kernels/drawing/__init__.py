"""The compiled part of pictures: a ray tracer for spheres, and discs drawn pixel by pixel."""
