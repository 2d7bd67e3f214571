"""Draw docs/event-driven.svg, events of four particles: python docs/event_driven_picture.py"""

from pathlib import Path

import matplotlib

matplotlib.use("svg")
matplotlib.rcParams.update({"font.size": 8, "svg.fonttype": "none", "svg.hashsalt": "event"})

import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

RADIUS, SIDE = 0.45, 2.0
PARTICLES = {  # position, velocity, colour; the other numbers of the picture follow
    "A": ((0.9, 3.0), (1.0, 0.0), "#4477aa"),
    "B": ((4.2, 2.8), (-0.5, 0.0), "#ee6677"),
    "C": ((1.0, 1.1), (0.2, -0.8), "#228833"),
    "D": ((5.2, 0.7), (-0.8, 0.2), "#aa3377"),
}
WALL = np.array([(2.6, 0.4), (3.7, 1.1)])


def contact(r, v, sigma):
    """The earlier root of |r + v t| = sigma."""
    rr, rv, vv = r @ r - sigma**2, r @ v, v @ v
    return rr / (-rv + np.sqrt(rv**2 - vv * rr))


def events():
    """(time, particle, event) for the next event of each particle, and for a crossing before one of them."""
    (a, va, _), (b, vb, _), (c, vc, _), (d, vd, _) = (
        (np.array(x), np.array(v), colour) for x, v, colour in PARTICLES.values()
    )
    pair = contact(b - a, vb - va, 2 * RADIUS)
    return [
        ((RADIUS - c[1]) / vc[1], "C", "hits a face of the container"),
        ((SIDE - a[0]) / va[0], "A", "crosses into the next box: no event of physics"),
        (contact(d - WALL[1], vd, RADIUS), "D", "hits the end of a wall"),
        (pair, "A", "hits B"),
        (pair, "B", "hits A"),
    ]


def space(axes, found):
    """The particles now, and dashed at their next events."""
    axes.set(xlim=(-0.08, 6.08), ylim=(-0.08, 4.08), aspect="equal", xticks=[], yticks=[])
    axes.set_title("particles now, and (dashed) at their next events", loc="left")
    axes.axis("off")
    axes.add_patch(plt.Rectangle((0, 0), 6, 4, fill=False, lw=2))
    for x in (SIDE, 2 * SIDE):
        axes.plot([x, x], [0, 4], color="0.75", lw=0.8, zorder=0)
    axes.plot([0, 6], [SIDE, SIDE], color="0.75", lw=0.8, zorder=0)
    axes.text(0.08, SIDE + 0.07, "box", color="0.5")
    axes.plot(*WALL.T, color="k", lw=2, solid_capstyle="round")
    for name, (place, velocity, colour) in PARTICLES.items():
        place, velocity = np.array(place), np.array(velocity)
        axes.add_patch(plt.Circle(place, RADIUS, color=colour, alpha=0.35, lw=0))
        axes.text(*place, name, ha="center", va="center", weight="bold")
        for n, (time, particle, _) in enumerate(found):
            if particle == name:
                there = place + velocity * time
                axes.annotate(
                    "", there, place, arrowprops={"arrowstyle": "->", "color": colour, "shrinkA": 6}
                )
                ghost = plt.Circle(there, RADIUS, fill=False, color=colour, ls="--", lw=1)
                axes.add_patch(ghost)
                if name != "B":
                    axes.text(*(there - (0.0, 0.25)), str(n + 1), ha="center", va="center")


def queue(axes, found):
    """The next event of each particle on a time axis."""
    axes.set(xlim=(-0.25, 2.0), ylim=(-0.6, 3.6), yticks=range(4), yticklabels=list("DCBA"))
    axes.set_title("predictions: the earlier one is in the queue", loc="left")
    axes.set_xlabel("time")
    axes.set_xticks([0.0], ["now"])
    for side in ("left", "right", "top"):
        axes.spines[side].set_visible(False)
    axes.tick_params(axis="y", length=0)
    for n, (time, particle, event) in enumerate(found):
        y, colour = "DCBA".index(particle), PARTICLES[particle][2]
        axes.plot([0, 1.95], [y, y], color="0.85", lw=0.8, zorder=0)
        axes.plot(0, y, "o", color=colour, ms=4)
        crossing = n == 1
        axes.plot(time, y, "|" if crossing else "D", color=colour, ms=9 if crossing else 6)
        label = f"{n + 1 if particle != 'B' else 4} {event}"
        if crossing:
            axes.text(time, y - 0.42, label, ha="center", fontsize=6.5, color="0.35")
        else:
            axes.text(min(time, 1.45), y + 0.22, label, ha="center", fontsize=7)


def main():
    found = events()
    figure, (left, right) = plt.subplots(
        1, 2, figsize=(7.2, 2.7), width_ratios=(1.25, 1), layout="constrained"
    )
    space(left, found)
    queue(right, found)
    figure.savefig(Path(__file__).with_name("event-driven.svg"), metadata={"Date": None})


main()
