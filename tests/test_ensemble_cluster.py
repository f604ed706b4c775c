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

from percept_obs import ensemble, ibo, scenarios
from percept_obs.cli import main
from percept_obs.studies import chunks

pytestmark = pytest.mark.usefixtures("xr")

EQ35 = scenarios.ma2005_eq35()
OVER = {"gain": np.linspace(2, 20, 16), "b1": [0.4, 0.5]}
SETTINGS = {"over": OVER, "seeds": 4, "duration": 4.0, "camera": NOISY, "chunk": 8, "language": "python"}

SWEEP = """
scenario = "ma2005_eq35"
observer = "identifier_based"
outputs = ["y1", "y2"]
seeds = 4
duration = 4.0
camera = {noise = 0.01}
chunk = 8
language = "python"
store = "sweep.zarr"

[over]
gain = {from = 2.0, to = 20.0, count = 16}
b1 = [0.4, 0.5]
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
def test_a_killed_sweep_goes_on_where_it_was(xr, alone, tmp_path):
    import zarr

    (tmp_path / "sweep.toml").write_text(SWEEP)
    store = tmp_path / "sweep.zarr"
    command = [sys.executable, "-m", "percept_obs.cli", "sweep", str(tmp_path / "sweep.toml")]
    sweep = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, cwd=tmp_path)
    chunks = store / "progress" / "runs" / "c"
    while sweep.poll() is None and len(list(chunks.glob("*/0"))) < 3:
        time.sleep(0.01)
    sweep.kill()
    sweep.wait()
    done = (zarr.open_group(store, mode="r")["progress/runs"][:, 0] > 0).sum()
    assert done % 8 == 0
    assert 24 <= done < alone.status.size
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(tmp_path)
        assert main(["sweep", str(tmp_path / "sweep.toml")]) == 0
    with xr.open_zarr(store, consolidated=False) as found:
        xr.testing.assert_identical(found.load(), alone)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "sweep.toml: No such file"),
        ("scenario = ", "is no TOML"),
        ('scenario = "ma2005_eq35"\nobserver = "ibo"\nnoise = 1\nstore = "a.zarr"', "does not know noise"),
        ('scenario = "eq99"\nobserver = "ibo"\nstore = "a.zarr"', "no scenario 'eq99'; there are ma2005_eq35"),
        ('scenario = "ma2005_eq35"\nobserver = "x"\nstore = "a.zarr"', "no observer 'x'; there are identifier_based"),
        ('scenario = "ma2005_eq35"\nobserver = "identifier_based"', "needs store"),
        ('scenario = "ma2005_eq35"\nobserver = "identifier_based"\nstore = "a.zarr"\nduration = "long"', "duration"),
        *(
            (f'scenario = "planar"\nobserver = "identifier_based"\nstore = "a.zarr"\n{wrong}', message)
            for wrong, message in (
                ("gains = {form = 1}", "no gain form"),
                ('gains = {gain = "x"}', "gains is the dict"),
                ("over = [1]", "over is the list [1]; expected a mapping"),
                ("over = {gain = {from = 1.0, to = 2.0, count = 1e10}}", "count for gain is the number 1"),
                ("over = {gain = {from = 1.0, to = 2.0, count = 10000000000}}", "1e+10 values of gain"),
                ("over = {gain = {from = 1.0, to = 2.0, count = -1}}", "give finite numbers"),
                ('outputs = "y1"', "put it into a list"),
            )
        ),
        ('scenario = ["x"]\nobserver = "identifier_based"\nstore = "a.zarr"', "scenario is the list ['x']"),
        ('scenario = "planar"\nobserver = "identifier_based"\nstore = 5', "store is the number 5; expected text"),
    ],
)
def test_a_file_that_makes_no_sense_or_is_not_there_is_refused(tmp_path, text, message, capsys):
    file = tmp_path / "sweep.toml"
    if text:
        file.write_text(text)
    assert main(["sweep", str(file)]) == 2
    assert message in capsys.readouterr().err
