"""A page in headless Chromium or Firefox: what a script returns, and the lines of the console."""

import json
import queue
import shutil
import subprocess
import threading
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
FIREFOX = next(filter(None, map(shutil.which, ("firefox-esr", "firefox"))), None)
_CHROMIUM_OPTIONS = ["--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-sync"]
_CHROMIUM_OPTIONS += ["--disable-quic", "--disable-background-networking", "--disable-component-update"]
_HEAD = """<script>
const lines = [];
addEventListener("error", event => lines.push(String(event.message)));
addEventListener("unhandledrejection", event => lines.push(String(event.reason)));
for (const kind of ["error", "warn"]) console[kind] = (...words) => lines.push(words.map(String).join(" "));
</script>"""
_TAIL = """<script>
(async () => { SCRIPT })().catch(String)
  .then(found => fetch("/found", { method: "POST", body: JSON.stringify({ found, lines }) }));
</script></body>"""


class _Handler(SimpleHTTPRequestHandler):
    found: queue.Queue

    def do_POST(self):
        body = self.rfile.read(int(self.headers["Content-Length"]))
        self.send_response(204)
        self.end_headers()
        self.found.put(json.loads(body))

    def log_message(self, *words):
        pass


def found_in(browser, page, script, folder, width=1400, height=1000, seconds=240, fragment=""):
    """What the body of an asynchronous function of JavaScript returns on a page, and lines of its console."""
    text = page.read_text(encoding="utf-8").replace("<head>", f"<head>{_HEAD}", 1)
    text = "".join(text.rpartition("</body>")[:1]) + _TAIL.replace("SCRIPT", script) + "</html>"
    (folder / "driven.html").write_text(text, encoding="utf-8")
    # windows have a smallest width, and Firefox ignores the size
    frame = f'<iframe src="driven.html{fragment}" style="border: 0; width: {width}px; height: {height}px">'
    (folder / "frame.html").write_text(f"<!doctype html><body style='margin: 0'>{frame}", encoding="utf-8")
    handler = type("Handler", (_Handler,), {"found": queue.Queue()})
    server = ThreadingHTTPServer(("127.0.0.1", 0), partial(handler, directory=str(folder)))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    address = f"http://127.0.0.1:{server.server_port}/frame.html"
    profile = folder / f"profile-{browser.rpartition('/')[2]}"
    profile.mkdir(exist_ok=True)
    size = f"--window-size={width},{height}"
    command = [browser, *_CHROMIUM_OPTIONS, f"--user-data-dir={profile}", size, address]
    if "firefox" in browser:
        command = [browser, "--headless", "--no-remote", "--profile", str(profile), address]
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        result = handler.found.get(timeout=seconds)
    finally:
        process.terminate()
        process.wait()
        server.shutdown()
        server.server_close()
        shutil.rmtree(profile, ignore_errors=True)
    return result["found"], result["lines"]
