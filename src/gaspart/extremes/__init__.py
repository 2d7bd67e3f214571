"""Scenes at the edge of what numbers, clocks and packings allow, and what becomes of them in every engine."""
