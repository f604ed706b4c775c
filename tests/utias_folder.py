"""Folder of the UTIAS recording, fetched once, for the tests that need it."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

from conftest import missing

from percept_obs.recording.utias import find_utias


def utias_folder() -> Path:
    """Return the folder that holds dataset3.mat; skip the test where it cannot be had."""
    found = _search()
    if isinstance(found, Path):
        return found
    missing("utias", f"The UTIAS recording is missing: {found}.")


@lru_cache
def _search() -> Path | Exception:
    """Search once, for a network that is missing may take a minute to say so."""
    try:
        return find_utias().parent
    except (OSError, ValueError) as error:
        return error
