"""Simulated system: container, species, walls, faces and collision law.

A scene and its parts are validated when they are created: invalid values raise SceneError.
"""
