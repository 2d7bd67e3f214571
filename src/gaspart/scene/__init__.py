"""Simulated system: container, species, walls, faces and collision law.

A scene is validated when it is created.
"""
