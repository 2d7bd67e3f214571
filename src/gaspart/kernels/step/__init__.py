"""Time-stepped engine: loop, motion, boundaries, searches, resolution of contacts."""
