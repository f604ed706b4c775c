"""Where the tests find the UTIAS recording and the tables that another program made from it."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

BESIDE_THE_REPOSITORY = Path(__file__).parents[2] / "shared/data/utias"


def utias_folder(*tables: str) -> Path:
    """Folder that holds dataset3.mat and the named tables; without one the test skips, or fails in CI."""
    named = os.environ.get("PERCEPT_OBS_UTIAS")
    folders = [BESIDE_THE_REPOSITORY]
    if named:
        place = Path(named).expanduser()
        folders.insert(0, place.parent if place.is_file() else place)
    wanted = ("dataset3.mat", *tables)
    for folder in folders:
        if all((folder / name).is_file() for name in wanted):
            return folder

    message = (
        f"{', '.join(wanted)} not found in {' or '.join(map(str, folders))}; set PERCEPT_OBS_UTIAS to "
        "a folder that holds them (percept_obs.recording.utias.find_utias() fetches dataset3.mat; the tables "
        "come with the project's data)"
    )
    if os.environ.get("CI", "").lower() == "true":
        pytest.fail(message)
    pytest.skip(message)
