"""Captions that would run code where the report is read, or end it: refused by `check`, in one line."""

import pytest

from gaspart.cli import main
from gaspart.reproduction.report.page import divided, html_of
from gaspart.yaml_text import write_yaml

UNCLOSED = [
    *("****", "**", "** **", "**a", "***", "**a**\n\n*b", "**a** `x", "**a** ``x", "**a** |x|", "**a** x_"),
    *("**a** {{", "**a** {{}}", "**a** {{  }}", "**a** {{x", "**a** {{x}} and {{y", "**{{**", "**a** [1]_"),
    *(
        "**a** :nothing:`x`",
        "**a** :math:`\\frac`",
        "**a** :math:`\\\\ `",
        "**a**\n\n.. nothing::",
        "**a**\n\na long title\n======",
    ),
    *("**a**\n\n.. raw:: html\n\n   <b>", "**a**\n\n.. include:: /etc/hostname"),
    *("**a**\n\n.. csv-table::\n   :file: /etc/hostname", "**a**\n\n.. raw:: html\n   :file: /dev/zero"),
]
ADDRESSES = [
    *("javascript:alert(1)", "JavaScript:alert(1)", "JAVASCRIPT:alert(1)", " javascript:alert(1)"),
    *("java\tscript:alert(1)", "java\nscript:alert(1)", "javascript\t:alert(1)", "\x01javascript:alert(1)"),
    *("data:text/html,<script>", "data:image/svg+xml;base64,AAAA", "vbscript:x", "file:///etc/passwd"),
    *("blob:x", "filesystem:x", "view-source:x", "x-y.z+1:q"),
]
FORMS = [
    "**a** `x <{}>`_",
    "**a** `x <{}>`__",
    "**a** x_\n\n*Panels.* b\n\n.. _x: {}\n\nx_",
    "**`x <{}>`_**",
    "**a**\n\n.. image:: {}",
    "**a**\n\n.. figure:: {}",
    "**a**\n\n.. image:: x.png\n   :target: {}",
    "**a**\n\n|i|\n\n.. |i| image:: {}",
]
GOOD = [
    "",
    "Of discs.",
    "**Discs freeze.** As `he writes <https://example.org/a?b=c:d>`_ to `her <mailto:a@b.c>`_, doi:10.1/2.",
    "**a**\n\n`here <figures/x.png>`_, `there <#claims>`_ :math:`\\frac{a}{\\sqrt{b}}`",
]


def config(folder, caption):
    """A config with one figure of its own."""
    path = folder / "own.yaml"
    point = {"dimension": 2, "count": 20, "radius": 0.5, "temperature": 1.0, "duration": 4.0}
    point["boundary"] = "periodic"
    experiment = {"point": point, "grid": {"packing_fraction": [0.1, 0.2]}}
    figure = {"kind": "observable", "observable": "Z", "against": "packing_fraction", "experiments": ["gas"]}
    whole = {"title": "t", "seed": 1, "points": "results/points", "experiments": {"gas": experiment}}
    write_yaml(path, whole | {"figures": {"mine": figure | {"caption": caption}}})
    return path


def refused(folder, capsys, caption):
    assert main(["check", str(config(folder, caption))]) == 2, caption
    line = capsys.readouterr().err
    assert "figures.mine.caption = " in line and line.count("\n") == 1 and line[:-1].isprintable()


@pytest.mark.parametrize("caption", UNCLOSED)
def test_marks_that_are_not_closed_are_refused(tmp_path, capsys, caption):
    refused(tmp_path, capsys, caption)


@pytest.mark.parametrize("form", FORMS)
def test_addresses_that_run_code_are_refused(tmp_path, capsys, form):
    for address in ADDRESSES:
        for part in divided_or_none(form.format(address)):
            assert address.split(":")[0].strip().lower() + ":" not in part.lower()
    refused(tmp_path, capsys, form.format("javascript:alert(1)"))


def divided_or_none(caption):
    """The HTML of a caption, if it is not refused."""
    try:
        parts = divided(caption)
    except ValueError:
        return []
    return [address for part in (parts.finding, parts.reading, parts.details) for address in links(part)]


def links(html):
    """The addresses in a piece of HTML."""
    import re
    from html import unescape

    return [unescape(found) for found in re.findall(r'(?:href|src|data)="([^"]*)"', html)]


@pytest.mark.parametrize("caption", GOOD)
def test_plain_captions_are_accepted(tmp_path, capsys, caption):
    assert main(["check", str(config(tmp_path, caption))]) == 0, capsys.readouterr().err


def test_a_finding_of_the_report_is_held_to_the_same():
    with pytest.raises(ValueError, match="must begin with"):
        html_of("`x <javascript:alert(1)>`_")
