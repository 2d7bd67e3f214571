"""Interactive gas in a notebook: sliders change it, gauges measure it."""

from __future__ import annotations

import asyncio
import html
import time
from collections.abc import Callable
from typing import Any

import numpy as np

from gaspart.engines import Engine
from gaspart.errors import SceneError, SimulationError, optional
from gaspart.rendering.live_gas import LEAST_FRAMES, LIVE_SIZE, LiveGas
from gaspart.scene.scene import Scene

_SECONDS = 0.04
"""Minimum time in seconds between the starts of two pictures."""
_PAUSE = 0.005
"""Minimum pause in seconds after each picture, in which the notebook processes user input."""
_METERS = 1.0
"""Seconds between two updates of the gauges."""


def live(
    scene: Scene,
    engine: Engine | str | None = None,
    seed: int | tuple[int, ...] = 0,
    size: tuple[int, int] = LIVE_SIZE,
    colour: str = "speed",
) -> Any:
    """Show a running simulation of a scene, in a widget of a notebook.

    A slider changes the packing fraction; the gas then starts again. Other sliders change gravity, the
    temperature of the walls, restitution, and the position of the side x high; the gas then continues. The
    side is pushed in as a piston, or pulled out into a vacuum. A button removes interior walls. Gauges show
    temperature and pressure since the last change, with errors and theory, and the histogram of speeds with
    Maxwell's distribution.

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
    colour : str, default "speed"
        Colours of particles, as for `render`.

    Returns
    -------
    ipywidgets.VBox
        The widget.

    Raises
    ------
    SceneError
        If no particle moves at the start, if the engine cannot model the scene, or if ipywidgets is not
        installed.

    Notes
    -----
    The first change of each kind compiles kernels.

    Examples
    --------
    >>> import gaspart as gp
    >>> scene = gp.Scene(gp.Container((9.0, 9.0)), [gp.Species(20, 0.2, temperature=1.0)])
    >>> widget = gp.live(scene, size=(80, 60))
    >>> type(widget).__name__
    'VBox'
    """
    widgets = optional("ipywidgets", "live", "gases that run in a notebook")
    gas = LiveGas(scene, engine, seed, size, colour)
    image = widgets.Image(value=gas.picture._repr_png_(), format="png", width=size[0], height=size[1])
    running, note = widgets.ToggleButton(description="run"), widgets.Label()
    meters = widgets.HTML(meters_of(gas))

    async def play() -> None:
        updated = 0.0
        try:
            while running.value:
                start = time.perf_counter()
                image.value = gas.advance()._repr_png_()
                if start - updated > _METERS:
                    meters.value, updated = meters_of(gas), start
                await asyncio.sleep(max(_PAUSE, _SECONDS - (time.perf_counter() - start)))
        except SimulationError as error:
            running.value, note.value = False, str(error)

    def start(change: Any) -> None:
        if change.new:
            running.task = asyncio.get_running_loop().create_task(play())  # a reference must be kept

    def changing(change: Callable[..., None], *values: float) -> bool:
        """Return False if the gas rejects a change."""
        note.value = "one moment: kernels of a new kind of scene are compiled"
        try:
            change(*values)
        except SceneError as error:
            note.value = str(error)
            return False
        image.value, note.value, meters.value = gas.picture._repr_png_(), "", meters_of(gas)
        return True

    def trace(event: Any) -> None:
        gas.traced = event.new
        image.value = gas.picture._repr_png_()

    def remove_walls(button: Any) -> None:
        changing(gas.open_walls)
        button.disabled = True

    running.observe(start, "value")
    tracer = widgets.ToggleButton(description="tracer")
    tracer.observe(trace, "value")
    buttons = [running, tracer] if gas.traceable else [running]
    if scene.walls:
        opening = widgets.Button(description="remove walls")
        opening.on_click(remove_walls)
        buttons.append(opening)
    sliders = [_slider(widgets, *of, changing) for of in _ranges(gas)]
    controls = widgets.HBox([*buttons, *sliders], layout=widgets.Layout(flex_flow="row wrap"))
    top = widgets.HBox([image, meters], layout=widgets.Layout(flex_flow="row wrap"))
    return widgets.VBox([top, controls, note])


def _slider(
    widgets: Any,
    name: str,
    range_: tuple[float, float, float],
    change: Callable[[float], None],
    changing: Callable[..., bool],
) -> Any:
    """Return a slider that changes a gas, with a name and a range (least, value, most).

    If the gas rejects a value, the slider returns to the previous value.
    """
    least, value, most = range_
    slider = widgets.FloatSlider(value, min=least, max=most, step=(most - least) / 50.0, description=name)
    slider.continuous_update, slider.style.description_width = False, "initial"

    def move(event: Any) -> None:
        if not changing(change, event.new):
            slider.unobserve(move, "value")
            slider.value = event.old
            slider.observe(move, "value")

    slider.observe(move, "value")
    return slider


def _ranges(gas: LiveGas) -> list[tuple[str, tuple[float, float, float], Callable[[float], None]]]:
    """Return the name, the range and the effect of each slider that applies to a gas."""
    scene = gas.simulation.scene
    ranges: list[tuple[str, tuple[float, float, float], Callable[[float], None]]] = []
    if gas.richest:
        ranges.append(("activity of reservoirs", (0.1 * gas.activity, gas.activity, gas.richest), gas.supply))
    if not scene.is_open and gas.emptiest < scene.packing_fraction:
        ranges.append(("packing fraction", (gas.emptiest, scene.packing_fraction, gas.densest), gas.fill))
    if gas.strongest:
        ranges.append(("gravity", (0.0, gas.gravity, gas.strongest), gas.pull))
    if gas.hottest:
        ranges.append(("temperature of walls", (0.0, gas.temperature, gas.hottest), gas.heat))
    normal = scene.restitution.normal if scene.restitution else 1.0
    if scene.count > 1 and not scene.is_open:
        ranges.append(("restitution", (min(0.5, normal), normal, 1.0), gas.damp))
    if gas.shortest:
        length = scene.container.lengths[0]
        ranges.append(("piston", (gas.shortest, length, length), gas.push))
    return ranges


def meters_of(gas: LiveGas) -> str:
    """Return the gauges and the histogram of speeds as HTML."""
    rows = []
    for name, value, error, theory in gas.gauges():
        expected = "" if theory is None or not np.isfinite(theory) else f"{theory:.4g}"
        rows.append((name, f"{value:.4g} &plusmn; {error:.1g}", expected))
    lines = "".join(f"<tr><td>{html.escape(name)}</td><td>{a}</td><td>{b}</td></tr>" for name, a, b in rows)
    waiting = "" if rows else f"<tr><td>measuring: {LEAST_FRAMES} pictures</td></tr>"
    head = "<tr><th></th><th>measured</th><th>theory</th></tr>"
    edges, density, expected = gas.speeds()
    width, height = 260.0, 110.0
    most = max(density.max(), expected.max() if expected is not None else 0.0) or 1.0
    across, up = width / edges[-1], height / (1.1 * most)
    bars = "".join(
        f'<rect x="{across * low:.1f}" y="{height - up * value:.1f}" '
        f'width="{across * (high - low) - 1.0:.1f}" height="{up * value:.1f}" fill="#7aa"/>'
        for low, high, value in zip(edges[:-1], edges[1:], density, strict=True)
    )
    curve = ""
    if expected is not None:
        middles = 0.5 * (edges[1:] + edges[:-1])
        points = " ".join(
            f"{across * x:.1f},{height - up * y:.1f}" for x, y in zip(middles, expected, strict=True)
        )
        curve = f'<polyline points="{points}" fill="none" stroke="#222" stroke-width="2"/>'
    text = "speeds" if expected is None else "speeds, and Maxwell's distribution"
    picture = f'<svg width="{width:g}" height="{height:g}" role="img" aria-label="{text}">{bars}{curve}</svg>'
    return (
        f"<p>collisions: {gas.collisions}</p><table>{head}{lines}{waiting}</table>{picture}"
        f"<p>{text}, 0 to {edges[-1]:.3g}</p>"
    )
