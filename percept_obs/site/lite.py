"""JupyterLite beside the pages: the notebooks, with a Python that runs in the reader's browser."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from importlib import metadata
from pathlib import Path
from typing import Any
from zipfile import ZIP_DEFLATED, ZipFile

from percept_obs.site.notebooks import SiteFault

NEEDS = ("jupyterlite_core", "jupyterlite_pyodide_kernel", "hatchling")
"""Modules of the extra "lite"."""

BESIDE = ("anywidget", "comm", "filterpy", "ipywidgets", "jupyterlab_widgets", "lark")
"""Packages of pure Python that Pyodide does not have, and which so stand beside the notebooks."""

EXTENSIONS = (  # of JupyterLab: widgets, Python, labs
    "@jupyter-widgets/jupyterlab-manager",
    "@jupyterlite/pyodide-kernel-extension",
    "anywidget",
)

PLACES = {"app": "lite/lab/index.html", "servers": "cdn.jsdelivr.net, pypi.org"}
"""Page that opens a notebook, and public servers from which a browser takes Pyodide and what does not stand beside."""

NOTE = f"""*Python runs in your browser here.  The next cell gets it ready: packages such as numpy come from public
servers ({PLACES["servers"]}), which takes a while the first time.  Nothing is compiled, so long runs take longer than
in a Python of your own.  A notebook with the UTIAS recording fetches it from githubusercontent.com; where that fails,
it reads the package's cut and says so.  What you change stays in this browser: download what you want to keep.*"""

NO_FILMS = """

**This notebook reads films, which a browser's Python cannot: read it here, and run it in a Python of your own.**"""

INSTALL = """%pip install -q percept-obs[data,filters] xarray
import pyodide_http

pyodide_http.patch_all()  # Python may fetch what the browser may"""


def prepared(notebook: Mapping[str, Any]) -> dict[str, Any]:
    """Return a notebook that installs what it needs, below its title."""
    title, *cells = notebook["cells"]
    source = NOTE + NO_FILMS * ("percept_obs.film" in json.dumps(notebook))
    note = {"cell_type": "markdown", "id": "in-a-browser", "metadata": {}, "source": source}
    install = {"cell_type": "code", "id": "install", "metadata": {}, "source": INSTALL}
    return {**notebook, "cells": [title, note, {**install, "execution_count": None, "outputs": []}, *cells]}


def write_lite(target: Path, notebooks: Mapping[str, Mapping[str, Any]]) -> None:
    """Build JupyterLite with notebooks, by their names, in a site's folder; SiteFault if it cannot be built."""
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder)
        for part in ("notebooks", "wheels"):
            (source / part).mkdir()
        for name, notebook in notebooks.items():
            text = json.dumps(prepared(notebook), indent=1, ensure_ascii=False)
            (source / "notebooks" / name).write_text(text, encoding="utf-8")
        write_own_wheel(source / "wheels")
        for name in BESIDE:
            pack(name, source / "wheels")
        build = ["build", "--apps=lab", "--no-sourcemaps", "--no-unused-shared-packages", "--ignore-sys-prefix"]
        places = ["--contents=notebooks", "--piplite-wheels=wheels", "--output-dir=lite"]
        _run(
            "jupyterlite_core",
            *build,
            *places,
            *(f"--LiteBuildConfig.federated_extensions={_extension(n)}" for n in EXTENSIONS),
            at=source,
        )
        shutil.copytree(source / "lite", target / "lite", dirs_exist_ok=True)


def pack(name: str, folder: Path) -> None:
    """Pack an installed package of pure Python as a wheel again."""
    found = metadata.distribution(name)
    with ZipFile(folder / f"{name}-{found.version}-py3-none-any.whl", "w", ZIP_DEFLATED) as wheel:
        for file in found.files or ():
            if ".." not in file.parts and file.suffix != ".pyc":
                wheel.write(Path(str(file.locate())), file)


def write_own_wheel(folder: Path) -> None:
    """Write a wheel of this package: of a checkout as it stands, or of the installation."""
    checkout = Path(__file__).parents[2]
    if (checkout / "pyproject.toml").exists():
        _run("hatchling", "build", "--target=wheel", f"--directory={folder}", at=checkout)
    else:
        pack("percept_obs", folder)


def _extension(name: str) -> Path:
    """Return the folder of an extension of JupyterLab."""
    from jupyter_core.paths import jupyter_path

    folders = (Path(path, name) for path in jupyter_path("labextensions"))
    if found := next(filter(Path.exists, folders), None):
        return found
    raise SiteFault(f"JupyterLab's extension {name} is in none of the folders that `jupyter --paths` lists as data")


def _run(module: str, *arguments: str, at: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-m", module, *arguments], cwd=at, capture_output=True, text=True, check=False
    )
    if done.returncode:
        raise SiteFault(f"{module} cannot build what is needed for --python:\n{done.stderr or done.stdout}")
