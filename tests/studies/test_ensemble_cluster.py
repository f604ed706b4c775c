"""On a Dask cluster an ensemble gives the same numbers bit for bit, and workers or clients that die cost time only."""

import os
import signal
import subprocess
import sys
import time
from concurrent.futures import as_completed

import numpy as np
import pytest
from examples import BOTH, NOISY
from places import SUPPORT

from percept_obs import ensemble, ibo, scenarios
from percept_obs.studies import chunks

pytestmark = pytest.mark.usefixtures("xr")

EQ35 = scenarios.ma2005_eq35()
OVER = {"gain": np.linspace(2, 20, 16), "b1": [0.4, 0.5]}
SETTINGS = {"over": OVER, "seeds": 4, "duration": 4.0, "camera": NOISY, "chunk": 8, "language": "python"}

IN_A_STORE = """
import numpy as np
from examples import BOTH
from test_ensemble_cluster import EQ35, SETTINGS
from percept_obs import ensemble, ibo
ensemble(EQ35, ibo(BOTH), **SETTINGS, store="kept.zarr")
"""


@pytest.fixture(scope="module")
def alone():
    """The ensemble computed on this machine."""
    return ensemble(EQ35, ibo(BOTH), **SETTINGS)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")
def test_a_killed_worker_costs_time_only(xr, alone, tmp_path):
    distributed = pytest.importorskip("distributed")
    cluster = {"n_workers": 2, "threads_per_worker": 1, "dashboard_address": None, "local_directory": tmp_path}
    with distributed.LocalCluster(**cluster) as two, distributed.Client(two) as client:
        pids, killed = list(client.run(os.getpid).values()), []

        def first_then_kill(futures):
            for future in as_completed(futures):
                yield future
                if not killed:
                    killed.append(pids[0])
                    os.kill(pids[0], getattr(signal, "SIGKILL", signal.SIGTERM))  # which ends it on Windows

        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(chunks, "as_completed", first_then_kill)
            found = ensemble(EQ35, ibo(BOTH), **SETTINGS, client=client, store=tmp_path / "kept.zarr")
        assert killed
    xr.testing.assert_identical(found, alone)


@pytest.mark.slow
def test_a_killed_ensemble_goes_on_where_it_was(xr, alone, tmp_path):
    import zarr

    store = tmp_path / "kept.zarr"
    path = os.pathsep.join(filter(None, [str(SUPPORT), *sys.path]))
    command = [sys.executable, "-c", IN_A_STORE]
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    running = subprocess.Popen(command, **quiet, cwd=tmp_path, env=os.environ | {"PYTHONPATH": path})
    chunks = store / "progress" / "runs" / "c"
    while running.poll() is None and len(list(chunks.glob("*/0"))) < 3:
        time.sleep(0.01)
    running.kill()
    running.wait()
    done = (zarr.open_group(store, mode="r")["progress/runs"][:, 0] > 0).sum()
    assert done % 8 == 0
    assert 24 <= done < alone.status.size
    ensemble(EQ35, ibo(BOTH), **SETTINGS, store=store)
    with xr.open_zarr(store, consolidated=False) as found:
        xr.testing.assert_identical(found.load(), alone)
