"""Draw docs/architecture.svg, the packages and their imports: python docs/architecture_picture.py

Imports are those of the code; names, order and purposes those of the table in docs/architecture.md. An arrow
that follows from others (a imports b, b imports c, so a may import c) is left out.
"""

import re
import textwrap
from pathlib import Path
from statistics import mean

import matplotlib

matplotlib.use("svg")
matplotlib.rcParams.update({"font.size": 8, "svg.fonttype": "none", "svg.hashsalt": "architecture"})

import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.patches import FancyBboxPatch  # noqa: E402

from gaspart.reproduction.points.modules import PACKAGE, find_imports  # noqa: E402

DOCS = Path(__file__).parent
WIDTH, HEIGHT = 0.86, 0.62  # of a box; places are 1 apart


def purposes():
    """{package: purpose} of the rows of the page's table, in their order."""
    page = (DOCS / "architecture.md").read_text(encoding="utf-8")
    return dict(re.findall(r"^\| `(\w+)` \| ([^|]+?) \|", page, re.MULTILINE))


def package_of(path):
    """The package of a file; None for a module at the top level, which belongs to none."""
    parts = path.relative_to(PACKAGE).parts
    return parts[0] if len(parts) > 1 else None


def imports():
    """{package: packages that its modules import, function-local imports included}."""
    found = {}
    for path in PACKAGE.rglob("*.py"):
        package = package_of(path)
        if package:
            used = {package_of(other) for other in find_imports(path)} - {package, None}
            found.setdefault(package, set()).update(used)
    return found


def reduced(graph):
    """The same without the imports that follow from others."""

    def reach(package):
        return set().union(*({one} | reach(one) for one in graph[package]))

    return {
        package: {one for one in used if not any(one in reach(other) for other in used - {one})}
        for package, used in graph.items()
    }


def rows(graph):
    """{package: row}: 0 for the command line, 1 for what it imports last, ... and the largest for what
    imports nothing of what is left."""
    users = {package: {one for one in graph if package in graph[one]} for package in graph}

    def row(package):
        return 1 + max((row(user) for user in users[package]), default=-1)

    return {package: row(package) for package in graph}


def places(order, graph):
    """{package: (x, y)}, y a row, x centred in it: beside what it imports, and else in the given order."""
    row_of = rows(graph)
    found = {}
    for row in sorted(set(row_of.values()), reverse=True):
        names = [name for name in order if row_of[name] == row]
        names.sort(key=lambda name: mean([found[one][0] for one in graph[name]] or [0.0]))
        found |= {name: (n - (len(names) - 1) / 2, row) for n, name in enumerate(names)}
    return found


def stated(graph):
    """The imports of a graph as text: "b > a, c; ..."."""
    return "; ".join(f"{name} > {', '.join(sorted(graph[name]))}" for name in sorted(graph) if graph[name])


def main():
    purpose, graph = purposes(), reduced(imports())
    place = places(list(purpose), graph)
    bottom = max(y for _, y in place.values())
    figure, axes = plt.subplots(figsize=(7.2, 0.82 * (bottom + 1.2)), layout="constrained")
    axes.set(xlim=(-2.05, 2.05), ylim=(-0.5, bottom + 1.2))
    axes.axis("off")
    top = [path.stem for path in sorted(PACKAGE.glob("*.py")) if not path.stem.startswith("__")]
    axes.text(
        0, bottom + 0.85, f"importable everywhere: {', '.join(top)}", ha="center", color="0.4", style="italic"
    )
    for name, (x, y) in place.items():
        box = FancyBboxPatch(
            (x - WIDTH / 2, y - HEIGHT / 2), WIDTH, HEIGHT, boxstyle="round,pad=0,rounding_size=0.06",
            facecolor="#fdf0d5" if name == "kernels" else "#e8eef5", edgecolor="0.35", lw=0.8, zorder=2,
        )  # fmt: skip
        axes.add_patch(box)
        axes.text(x, y + 0.17, name, ha="center", va="center", weight="bold", zorder=3)
        text = "\n".join(textwrap.wrap(purpose[name], 27))
        axes.text(x, y - 0.09, text, ha="center", va="center", fontsize=6, linespacing=1.15, zorder=3)
        for other in sorted(graph[name]):
            u, v = place[other]
            axes.annotate(
                "", (u, v - HEIGHT / 2), (x, y + HEIGHT / 2),
                arrowprops={"arrowstyle": "-|>", "color": "0.35", "lw": 0.9, "shrinkA": 0, "shrinkB": 0},
            )  # fmt: skip
    metadata = {"Date": None, "Description": stated(graph)}
    figure.savefig(DOCS / "architecture.svg", metadata=metadata)


if __name__ == "__main__":
    main()
