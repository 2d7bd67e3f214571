"""A gas to play with in JupyterLab, in headless Chromium: its buttons and sliders are moved with the mouse.

    python3 -m venv lab && lab/bin/pip install jupyterlab jupyterlab_widgets
    .venv/bin/python tests/rendering/live_in_jupyter.py lab/bin/jupyter FOLDER

JupyterLab is not in the locked environment, so pytest does not run this. The kernel is that of the locked
environment. A failure is an AssertionError; the folder gets screenshots, to be looked at. Lines are printed
with the number of pictures per second, the first of 500 discs.
"""

import asyncio
import base64
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from urllib.request import Request, urlopen

import nbformat
from tornado.websocket import websocket_connect

PORT, TOKEN = 18888, "gaspart"
RUN = '.jp-NotebookPanel-toolbar [data-command="notebook:run-cell-and-select-next"]'
WAIT = 300.0  # seconds, for kernels that are compiled
FIVE_HUNDRED = "gp.Scene(gp.Container((60.0, 45.0)), [gp.Species(500, 0.5, temperature=1.0)])"
DIVIDED = """gp.Scene(
    gp.Container((40.0, 30.0)),
    [gp.Species(60, 0.5, temperature=1.0, region=((0.0, 0.0), (19.0, 30.0))),
     gp.Species(60, 0.5, temperature=1.0, region=((21.0, 0.0), (40.0, 30.0)))],
    walls=[gp.Wall((20.0, 0.0), (20.0, 30.0))],
), colour="species\""""
EFFUSION = """gp.Scene(
    gp.Container((60.0, 30.0), ("wall", "periodic")), [gp.Species(100, 0.5, temperature=1.0)],
    faces={"x_low": gp.Open(activity=0.157, temperature=1.0), "x_high": gp.Open()}, centres_to_walls=True)"""
READ = """(() => {
  const text = document.querySelector(".jp-OutputArea .widget-html-content")?.innerText ?? "";
  const shown = document.querySelector(".jp-OutputArea img.widget-image")?.src ?? "";
  const errors = [...document.querySelectorAll(".jp-OutputArea-output[data-mime-type*=stderr]")];
  const sliders = [...document.querySelectorAll(".jp-OutputArea .widget-slider")];
  return { text, shown, errors: errors.map(part => part.innerText), sliders: Object.fromEntries(sliders.map(
    part =>
    [part.querySelector(".widget-label").innerText, part.querySelector(".widget-readout").innerText])) };
})()"""
COUNT = """new Promise(resolve => {
  let pictures = 0;
  const observer = new MutationObserver(() => { pictures += 1; });
  observer.observe(document.querySelector(".jp-OutputArea img.widget-image"), { attributeFilter: ["src"] });
  setTimeout(() => { observer.disconnect(); resolve(pictures / SECONDS); }, 1000 * SECONDS);
})"""
PLACE = """(() => {
  const found = [...document.querySelectorAll(SELECTOR)].find(CHOSEN);
  if (!found) return null;
  const part = INNER ? found.querySelector(INNER) : found;
  part.scrollIntoView({ block: "center" });
  const place = part.getBoundingClientRect();
  return [place.x, place.y, place.width, place.height];
})()"""


class Page:
    """A page of Chromium, driven by its protocol."""

    def __init__(self, socket, folder):
        self._socket, self._folder, self._number = socket, folder, 0

    async def call(self, method, **given):
        """Return the result of a method of the protocol."""
        self._number += 1
        await self._socket.write_message(json.dumps({"id": self._number, "method": method, "params": given}))
        while True:
            answer = json.loads(await asyncio.wait_for(self._socket.read_message(), WAIT))
            if answer.get("id") == self._number:
                assert "error" not in answer, answer
                return answer["result"]

    async def evaluate(self, script):
        """Return the value of an expression in the page."""
        done = await self.call("Runtime.evaluate", expression=script, awaitPromise=True, returnByValue=True)
        assert "exceptionDetails" not in done, done
        return done["result"].get("value")

    async def until(self, script, seconds=WAIT):
        """Wait until an expression is true, and return it."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            if value := await self.evaluate(script):
                return value
            await asyncio.sleep(0.2)
        await self.picture("failed")
        raise AssertionError(f"{script}: not in {seconds:g} s")

    async def picture(self, name):
        """Write a screenshot into the folder."""
        data = (await self.call("Page.captureScreenshot"))["data"]
        (self._folder / f"{name}.png").write_bytes(base64.b64decode(data))

    async def read(self):
        """Return what the widget shows."""
        return await self.evaluate(READ)

    async def place(self, selector, chosen, inner=""):
        """Return corner and size of a part of the widget."""
        script = PLACE.replace("SELECTOR", json.dumps(selector)).replace("CHOSEN", chosen)
        return await self.until(script.replace("INNER", json.dumps(inner)), 60.0)

    async def _mouse(self, kind, x, y):
        await self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", clickCount=1)

    async def press(self, selector, chosen="part => true"):
        """Click on a part of the page."""
        x, y, width, height = await self.place(selector, chosen)
        for kind in ("mousePressed", "mouseReleased"):
            await self._mouse(kind, x + width / 2, y + height / 2)

    async def click(self, text):
        """Click on a button of the widget."""
        await self.press(".jp-OutputArea button", f"part => part.innerText.trim() === {json.dumps(text)}")

    async def slide(self, name, part):
        """Drag the handle of a slider to a part of its length."""
        chosen = f'part => part.querySelector(".widget-label").innerText === {json.dumps(name)}'
        x, y, width, height = await self.place(".jp-OutputArea .widget-slider", chosen, ".noUi-handle")
        left, _, length, _ = await self.place(".jp-OutputArea .widget-slider", chosen, ".noUi-base")
        y += height / 2
        await self._mouse("mousePressed", x + width / 2, y)
        for share in (0.5, 1.0):
            await self._mouse("mouseMoved", x + width / 2 + share * (left + part * length - x - width / 2), y)
        await self._mouse("mouseReleased", left + part * length, y)


async def opened(port, address, folder):
    """Return a new page of Chromium at an address: a page with a changed notebook asks before it is left."""
    request = Request(f"http://127.0.0.1:{port}/json/new?{address}", method="PUT")
    target = json.loads(urlopen(request).read())
    socket = await websocket_connect(target["webSocketDebuggerUrl"], max_message_size=1 << 28)
    page = Page(socket, folder)
    await page.call("Page.enable")
    return page


async def changed(page, name, part):
    """Move a slider, and wait until the gas has another picture and the slider another value."""
    before = await page.read()
    await page.slide(name, part)
    await page.until(f"{READ}.sliders[{json.dumps(name)}] !== {json.dumps(before['sliders'][name])}", 60.0)
    await page.until(f"{READ}.shown !== {json.dumps(before['shown'])}")
    await page.until("!document.querySelector('.jp-OutputArea').innerText.includes('one moment')")
    return await page.read()


async def watch(page, name, moves, buttons=()):
    """Run a notebook, its gas, its buttons and its sliders; return pictures per second."""
    await page.until("document.querySelector('.jp-Notebook-ExecutionIndicator')?.dataset.status === 'idle'")
    await page.press(".jp-CodeCell .cm-content")  # without the focus there is no present notebook
    while not await page.evaluate("/[*0-9]/.test(document.querySelector('.jp-InputPrompt').innerText)"):
        await page.press(RUN)  # which does nothing while the kernel is being connected
        await asyncio.sleep(3.0)
    await page.until('document.querySelector(".jp-OutputArea img.widget-image")?.src.startsWith("blob:")')
    await page.picture(f"{name}-0")
    await page.click("run")
    await page.until(f"{READ}.text.includes('temperature')")
    rate = await page.evaluate(COUNT.replace("SECONDS", "10"))
    await page.picture(f"{name}-1")
    for text in buttons:
        before = (await page.read())["shown"]
        await page.click(text)
        await page.until(f"{READ}.shown !== {json.dumps(before)}")
    for number, (slider, part) in enumerate(moves, start=2):
        await changed(page, slider, part)
        await page.until(f"{READ}.text.includes('temperature')")
        await asyncio.sleep(2.0)
        await page.picture(f"{name}-{number}-{slider.replace(' ', '-')}")
    await page.click("run")
    await asyncio.sleep(1.0)
    last = (await page.read())["shown"]
    await asyncio.sleep(1.0)
    assert (await page.read())["shown"] == last, "it goes on after it was stopped"
    assert not (await page.read())["errors"]
    return rate


NOTEBOOKS = {
    "gas": (
        FIVE_HUNDRED,
        [
            ("piston", 0.1),
            ("piston", 1.0),
            ("gravity", 0.6),  # which excludes pistons
            ("temperature of walls", 0.8),
            ("restitution", 0.7),
            ("packing fraction", 0.1),
        ],
        ["tracer"],
    ),
    "divided": (DIVIDED, [("gravity", 0.3)], ["remove walls"]),
    "effusion": (EFFUSION, [("activity of reservoirs", 0.9), ("temperature of walls", 0.9)], []),
}


def write_notebooks(folder):
    """Write a notebook of each gas, and the kernel of this environment."""
    for name, (scene, *_) in NOTEBOOKS.items():
        code = f"import gaspart as gp\n\nwidget = gp.live({scene})\nwidget"
        notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(code)])
        notebook.metadata["kernelspec"] = {"name": "gaspart", "display_name": "gaspart", "language": "python"}
        nbformat.write(notebook, folder / f"{name}.ipynb")
    kernel = folder / "jupyter/kernels/gaspart/kernel.json"
    kernel.parent.mkdir(parents=True)
    command = [sys.executable, "-m", "ipykernel_launcher", "-f", "{connection_file}"]
    kernel.write_text(json.dumps({"argv": command, "display_name": "gaspart", "language": "python"}))


async def main(jupyter, pictures):
    """Watch all gases and print how fast the first is."""
    pictures.mkdir(parents=True, exist_ok=True)
    chromium = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))))
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        write_notebooks(folder)
        server = [jupyter, "lab", "--no-browser", "--allow-root", f"--port={PORT}"]
        server += [f"--IdentityProvider.token={TOKEN}", f"--ServerApp.root_dir={folder}"]
        environment = os.environ | {"JUPYTER_PATH": str(folder / "jupyter"), "HOME": str(folder)}
        environment["GASPART_CACHE"] = os.environ.get("GASPART_CACHE", str(Path.home() / ".cache/gaspart"))
        browser = [chromium, "--headless", "--no-sandbox", "--disable-gpu", "--remote-debugging-port=0"]
        browser += [f"--user-data-dir={folder}/profile", "--window-size=1400,900", "about:blank"]
        running = [
            subprocess.Popen(server, env=environment, stderr=(pictures / "jupyter.log").open("w")),
            subprocess.Popen(browser, stderr=subprocess.DEVNULL),
        ]
        try:
            port = int(await _when(lambda: (folder / "profile/DevToolsActivePort").read_text().split()[0]))
            await _when(lambda: urlopen(f"http://127.0.0.1:{PORT}/api?token={TOKEN}").read())
            for name, (_, moves, buttons) in NOTEBOOKS.items():
                address = f"http://127.0.0.1:{PORT}/lab/tree/{name}.ipynb?token={TOKEN}&reset"
                rate = await watch(await opened(port, address, pictures), name, moves, buttons)
                print(f"{name}: {rate:.1f} pictures per second", flush=True)
        finally:
            for process in running:
                process.terminate()
            for process in running:
                process.wait(30)


async def _when(read):
    """Return what a function returns as soon as it raises nothing."""
    end = time.monotonic() + WAIT
    while True:
        try:
            return read()
        except (OSError, IndexError):
            if time.monotonic() > end:
                raise
            await asyncio.sleep(0.5)


if __name__ == "__main__":
    asyncio.run(main(sys.argv[1], Path(sys.argv[2])))
