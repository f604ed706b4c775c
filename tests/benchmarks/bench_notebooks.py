"""CPU seconds of each notebook's kernel, with imports and children: bench_notebooks.py [part of a name ...].

The first run on a machine takes longer, since numba compiles and films are read.
"""

import os
import sys
from tempfile import TemporaryDirectory

import nbformat
from measured import exit_code
from nbclient import NotebookClient
from places import NOTEBOOKS

from percept_obs.recording.utias import UTIAS_CUT

os.environ.setdefault("PERCEPT_OBS_UTIAS", str(UTIAS_CUT))
found = []
for path in sorted(NOTEBOOKS.glob("*.ipynb")):
    if any(part in path.stem for part in sys.argv[1:] or [""]):
        notebook = nbformat.read(path, as_version=4)
        notebook.cells.append(nbformat.v4.new_code_cell("import os; print(sum(os.times()[:4]))"))
        with TemporaryDirectory() as folder:
            NotebookClient(notebook, timeout=600, resources={"metadata": {"path": folder}}).execute()
        found.append(float(notebook.cells[-1].outputs[0].text))
        print(f"{path.stem:32} {found[-1]:5.1f}", flush=True)
most, together = max(found), sum(found)
sys.exit(exit_code({f"{most:.0f} s, of 15": most <= 15, f"{together:.0f} s together, of 150": together <= 150}))
