"""Calls for other processes, which import this module by its name."""

import os

import gaspart as gp


def shared(tell, what, value):
    """Tell a value and return it, refuse it, or end the process with it as its exit code."""
    tell(value)
    if what == "refuse":
        raise gp.SceneError("value", value, "is refused")
    if what == "leave":
        os._exit(value)
    return value
