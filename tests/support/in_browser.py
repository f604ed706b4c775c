"""All notebooks of a site's JupyterLite in Chromium: a table of which run, in how long, and what they complain of.

    percept-obs site SITE --python
    python tests/support/in_browser.py SITE [NOTEBOOK...]

Pyodide and its packages come from a network.  Without one, write the site with JUPYTERLITE_PYODIDE_URL, the address of
a distribution of Pyodide on this machine.
"""

import functools
import http.server
import json
import shutil
import sys
import tempfile
import threading
import time
from pathlib import Path

from jupyter_harness import CHROMIUM_OPTIONS
from needs import BROWSERS
from playwright.sync_api import Error, sync_playwright

OPENED = "() => window.jupyterapp?.shell.currentWidget?.sessionContext?.session?.kernel"
BOOTED = "() => window.jupyterapp.shell.currentWidget.sessionContext.session.kernel.requestExecute({ code: '1' }).done"
RUN = """async () => {
    const { commands, shell } = window.jupyterapp;
    await commands.execute("notebook:run-all-cells");
    const cells = shell.currentWidget.content.model.toJSON().cells.filter((cell) => cell.cell_type === "code");
    const complaints = cells.flatMap((cell) => cell.outputs)
        .filter((output) => output.output_type === "error" || output.name === "stderr")
        .map((output) => output.ename ? `${output.ename}: ${output.evalue}` : [output.text].flat().join(""));
    return [cells.filter((cell) => cell.execution_count).length, cells.length, complaints];
}"""


def tried(page, address, name):
    """Seconds until Python answers, and to run a notebook; how many of its cells ran; its first complaint."""
    began = time.perf_counter()
    page.goto(f"{address}/lite/lab/index.html?path={name}")
    page.wait_for_function(OPENED, timeout=300_000)
    page.evaluate(BOOTED)
    booted = time.perf_counter()
    ran, cells, complaints = page.evaluate(RUN)
    return booted - began, time.perf_counter() - booted, f"{ran} of {cells}", "".join(complaints[:1])[:100]


class Server(http.server.SimpleHTTPRequestHandler):
    """A server of the site's files, by whose settings scripts reach the page's application."""

    def do_GET(self):
        """Send a file."""
        path = Path(self.translate_path(self.path))
        if path.name != "jupyter-lite.json" or not path.is_file():
            return super().do_GET()
        settings = json.loads(path.read_bytes())
        settings.setdefault("jupyter-config-data", {})["exposeAppInBrowser"] = True
        self.send_response(200)
        self.end_headers()
        self.wfile.write(json.dumps(settings).encode())

    def log_message(self, *_):
        """Log nothing."""


def main(site, *names):
    """Run the notebooks, all if none is named, and print the table."""
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Server, directory=site))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    address = f"http://127.0.0.1:{server.server_port}"
    path = next(filter(None, map(shutil.which, BROWSERS)))
    failed = False
    print(f"{'notebook':32} {'boot, s':>8} {'run, s':>8}  cells")
    for name in names or sorted(each.name for each in Path(site, "lite", "files").glob("*.ipynb")):
        with sync_playwright() as playwright, tempfile.TemporaryDirectory() as home:
            browser = playwright.chromium.launch_persistent_context(
                home, executable_path=path, headless=True, args=list(CHROMIUM_OPTIONS)
            )
            page = browser.pages[0]
            try:
                boot, run, cells, complaint = tried(page, address, name)
                print(f"{name:32} {boot:8.1f} {run:8.1f}  {cells} {complaint}", flush=True)
                failed |= bool(complaint)
            except Error as error:
                print(f"{name:32} {error.message.splitlines()[0]}", flush=True)
                failed = True
            browser.close()
    return int(failed)


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
