"""Compiled functions that draw pictures: a ray tracer for spheres, and discs drawn pixel by pixel."""
