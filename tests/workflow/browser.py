"""A page in headless Chromium: what a script finds after it has clicked through it."""

import html
import json
import re
import shutil
import subprocess

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
_REPORT = "parent.document.body.dataset.found = JSON.stringify(found);"


def found_by(script, page, folder, width, dark=False):
    """What the body `script` of an asynchronous JavaScript function returns on the page, in a frame of this
    width, with light or dark colours.

    In a frame, because a window of the browser has a width below which it does not go.
    """
    run = f"(async () => {{ {script} }})().catch(String).then(found => {{ {_REPORT} }});"
    base = f'<head><base href="{page.parent.as_uri()}/">'
    inner = page.read_text(encoding="utf-8").replace("<head>", base)
    inner = inner.replace("</body>", f"<script>{run}</script></body>")
    frame = f'<iframe width="{width}" height="800" style="border: 0" srcdoc="{html.escape(inner)}"></iframe>'
    outer = folder / "frame.html"
    outer.write_text(f"<!doctype html><html><body>{frame}</body></html>", encoding="utf-8")
    command = [CHROMIUM, "--headless", "--no-sandbox", "--disable-gpu", f"--user-data-dir={folder}/profile"]
    command += ["--allow-file-access-from-files", "--virtual-time-budget=20000"]
    command += [f"--blink-settings=preferredColorScheme={0 if dark else 1}"]
    command += ["--force-prefers-reduced-motion"]  # the gas would run all these seconds
    done = subprocess.run(
        [*command, "--dump-dom", outer.as_uri()], capture_output=True, text=True, timeout=120
    )
    printed = re.search(r'<body data-found="([^"]*)"', done.stdout)
    assert printed, done.stderr[-2000:]
    return json.loads(html.unescape(printed[1]))
