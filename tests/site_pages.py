"""Pages of a folder in headless Chromium, at a given width: what a script finds in them."""

import json
import re
import shutil
import subprocess
from html import unescape

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
_OUTER = """<!doctype html><html><body><script>
const found = {}, pages = PAGES;
const next = () => {
  const page = pages.shift();
  if (!page) { document.body.dataset.found = JSON.stringify(found); return; }
  const frame = document.createElement("iframe");
  frame.width = WIDTH; frame.height = 800; frame.style.border = 0; frame.src = page;
  frame.onload = () => setTimeout(() => {
    found[page] = ((window, document) => { SCRIPT })(frame.contentWindow, frame.contentDocument);
    frame.remove(); next();
  }, WAIT);
  document.body.append(frame);
};
next();
</script></body></html>"""


def found_on(pages, script, folder, width, wait=300, budget=60_000):
    """What the JavaScript function body `script`, of window and document, returns on each of the `pages`.

    Page -> result. pages: addresses within `folder`. In frames, because a window of the browser has a width
    below which it does not go. wait: milliseconds between the end of loading and the script.
    """
    text = _OUTER.replace("PAGES", json.dumps(list(pages))).replace("SCRIPT", script)
    outer = folder / f"frame-{width}.html"
    outer.write_text(text.replace("WIDTH", str(width)).replace("WAIT", str(wait)), encoding="utf-8")
    command = [CHROMIUM, "--headless", "--no-sandbox", "--allow-file-access-from-files"]
    command += ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"]  # WebGL without a graphics card
    command += [f"--virtual-time-budget={budget}", f"--user-data-dir={folder}/.profile", "--dump-dom"]
    try:
        done = subprocess.run([*command, outer.as_uri()], capture_output=True, text=True, timeout=180)
    finally:
        outer.unlink()
        shutil.rmtree(folder / ".profile", ignore_errors=True)
    result = re.search(r'<body data-found="([^"]*)"', done.stdout)
    assert result, done.stderr[-2000:]
    return json.loads(unescape(result[1]))
