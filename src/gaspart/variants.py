"""Which compiled kernels a point needs, as a name; and how to compile them, from the name alone."""

from __future__ import annotations

from gaspart.grid import Point

SEPARATOR = "-"


def variant(point: Point) -> str:
    """The kernels of a point: engine, search or precision, dimension, boundaries (`p`eriodic or `w`all)."""
    settings = point.settings
    boundary = settings.get("boundary", "wall")
    kinds = [boundary] * settings["dimension"] if isinstance(boundary, str) else boundary
    engine = "fill" if point.job == "fill" else settings.get("engine", "event")
    choice = {
        "fill": "random",
        "event": settings.get("search", "boxes"),
        "step": settings.get("precision", "float64"),
    }
    return SEPARATOR.join([engine, choice[engine], f"{settings['dimension']}d", "".join(k[0] for k in kinds)])


def warm(name: str) -> None:
    """Run something tiny that needs the kernels of this variant, so that they are compiled and cached."""
    from gaspart.engines import EventDriven, TimeStepped
    from gaspart.scene import Container, Scene, Species
    from gaspart.simulation import Simulation

    engine, choice, dimension, kinds = name.split(SEPARATOR)
    boundary = tuple("periodic" if kind == "p" else "wall" for kind in kinds)
    container = Container(lengths=(8.0,) * int(dimension[0]), boundary=boundary)
    scene = Scene(container=container, species=(Species(count=16, radius=0.5, temperature=1.0),))
    if engine == "step":
        chosen = TimeStepped(time_step=0.01, boxes_per_side=4, precision=choice)
    else:
        chosen = EventDriven(search="boxes" if engine == "fill" else choice)
    simulation = Simulation(scene, chosen, seed=1)
    if engine != "fill":
        simulation.advance(duration=1.0)
        simulation.restore(simulation.checkpoint())
        simulation.advance(duration=0.1)
