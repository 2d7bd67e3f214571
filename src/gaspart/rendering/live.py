"""A gas that runs in a notebook, while sliders change its packing fraction and gravity."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from dataclasses import replace
from typing import Any

from gaspart.accuracy.scales import scales
from gaspart.engines import Engine
from gaspart.errors import SceneError, SimulationError, optional
from gaspart.rendering.frames import Picture, render
from gaspart.scene.open_faces import refuse_open
from gaspart.scene.scene import Scene, require_scene
from gaspart.simulation import Simulation

_PICTURES = 100
"""In the time in which a particle crosses the container."""
_SECONDS = 0.04
"""Between two pictures, at least: in these the notebook hears what its user does."""
_DENSEST = {2: 0.45, 3: 0.28}
"""Packing fraction up to which particles are placed at random."""
_WEIGHTS = 8.0
"""The strongest gravity of the slider: of a fall through the container, in units of m v^2 of a particle."""
_SIZE = (600, 450)


class LiveGas:
    """Simulation that goes on from picture to picture, of a scene that may change.

    `interval` is the time between two pictures, `size` is (W, H) in pixels; other arguments are those for
    `Simulation`. Raises SceneError as `Simulation`, for open faces, and for a scene in which nothing moves or
    falls.
    """

    def __init__(
        self,
        scene: Scene,
        engine: Engine | str | None = None,
        seed: int | tuple[int, ...] = 0,
        size: tuple[int, int] = _SIZE,
    ) -> None:
        require_scene(scene)
        refuse_open(scene, "changes the particles, whose packing fraction a slider would state")
        self.interval = scales(scene).crossing_time / _PICTURES
        if self.interval == float("inf"):
            raise SceneError("scene", scene, "nothing moves at the start, and nothing falls")
        self.size, self._engine, self._seed, self._first = size, engine, seed, scene
        self.simulation = Simulation(scene, engine, seed)

    @property
    def picture(self) -> Picture:
        """Picture of the particles now, with the parameters of the scene."""
        return render(self.simulation, size=self.size, clock=True)

    def advance(self) -> Picture:
        """Advance by an interval and return the picture then."""
        self.simulation.advance(duration=self.interval)
        return self.picture

    def fill(self, packing_fraction: float) -> None:
        """Start again with another number of particles, for about this packing fraction.

        The species that move keep the proportions of the first scene.

        Parameters
        ----------
        packing_fraction : float, [1]
            Packing fraction.

        Raises
        ------
        SceneError
            If the particles do not fit.
        """
        factor = (packing_fraction - self.emptiest) / (self._first.packing_fraction - self.emptiest)
        species = [
            one if one.fixed else replace(one, count=max(1, round(factor * one.count)))
            for one in self._first.species
        ]
        scene = replace(self.simulation.scene, species=species)
        self.simulation = Simulation(scene, self._engine, self._seed)

    def pull(self, acceleration: float) -> None:
        """Continue from the present positions under another gravity, down the last axis.

        Parameters
        ----------
        acceleration : float, [length/time^2]
            Acceleration.
        """
        down = (*[0.0] * (self._first.dimension - 1), -acceleration)
        scene = replace(self.simulation.scene, gravity=down)
        self.simulation = Simulation(scene, self._engine, self._seed, initial=self.simulation.state)

    @property
    def emptiest(self) -> float:
        """Packing fraction of all particles except species that move."""
        fixed = [one for one in self._first.species if one.fixed]
        return replace(self._first, species=fixed).packing_fraction

    @property
    def densest(self) -> float:
        """Highest packing fraction to choose."""
        return max(_DENSEST[self._first.dimension], self._first.packing_fraction)

    @property
    def strongest(self) -> float | None:
        """Strongest gravity to choose; None without a floor."""
        if self._first.container.periodic[-1]:
            return None
        height = self._first.container.lengths[-1]
        return max(_WEIGHTS * scales(self._first).thermal_speed ** 2 / height, 2.0 * self.gravity)

    @property
    def gravity(self) -> float:
        """Acceleration down the last axis."""
        pull = self.simulation.scene.gravity
        return -pull[-1] if pull else 0.0


def live(
    scene: Scene,
    engine: Engine | str | None = None,
    seed: int | tuple[int, ...] = 0,
    size: tuple[int, int] = _SIZE,
) -> Any:
    """Show a scene that runs while it is watched, in a widget of a notebook.

    A slider changes the packing fraction, and the gas starts again. If there is a floor, another slider
    changes gravity, under which the gas goes on.

    Parameters
    ----------
    scene : Scene
        The scene to simulate.
    engine : Engine or {"event", "step", "dsmc"}, optional
        The engine; a name selects its default settings. Default: event-driven.
    seed : int or tuple of int, default 0
        Seed of the initial state and of all random numbers.
    size : tuple of int
        Width and height of the picture in pixels.

    Returns
    -------
    ipywidgets.VBox
        The widget.

    Raises
    ------
    SceneError
        If nothing moves at the start, the number of particles is not fixed, the engine cannot model the
        scene, or ipywidgets is not installed.

    Notes
    -----
    The first change of gravity compiles kernels.

    Examples
    --------
    >>> import gaspart as gp
    >>> scene = gp.Scene(gp.Container((9.0, 9.0)), [gp.Species(20, 0.2, temperature=1.0)])
    >>> widget = gp.live(scene, size=(80, 60))
    >>> type(widget).__name__
    'VBox'
    """
    widgets = optional("ipywidgets", "live", "gases that run in a notebook")
    gas = LiveGas(scene, engine, seed, size)
    image = widgets.Image(value=gas.picture._repr_png_(), format="png", width=size[0], height=size[1])
    running, note = widgets.ToggleButton(description="run"), widgets.Label()

    async def play() -> None:
        try:
            while running.value:
                image.value = gas.advance()._repr_png_()
                await asyncio.sleep(_SECONDS)
        except SimulationError as error:
            running.value, note.value = False, str(error)

    def start(change: Any) -> None:
        if change.new:
            running.task = asyncio.get_running_loop().create_task(play())  # which must be referred to

    def slider(name: str, range_: tuple[float, float, float], change: Callable[[float], None]) -> Any:
        def changed(event: Any) -> None:
            note.value = "one moment: kernels of a new kind of scene are compiled"
            try:
                change(event.new)
                image.value, note.value = gas.picture._repr_png_(), ""
            except SceneError as error:
                note.value = str(error)

        least, value, most = range_
        step = (most - least) / 50.0
        found = widgets.FloatSlider(value, min=least, max=most, step=step, description=name)
        found.continuous_update, found.style.description_width = False, "initial"
        found.observe(changed, "value")
        return found

    running.observe(start, "value")
    sliders = []
    if gas.emptiest < scene.packing_fraction:
        filled = gas.emptiest, scene.packing_fraction, gas.densest
        sliders.append(slider("packing fraction", filled, gas.fill))
    if gas.strongest:
        sliders.append(slider("gravity", (0.0, gas.gravity, gas.strongest), gas.pull))
    return widgets.VBox([image, widgets.HBox([running, *sliders]), note])
