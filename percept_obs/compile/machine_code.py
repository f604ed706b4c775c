"""Machine code by numba, kept in the user's cache, so that a machine compiles each text once."""

from __future__ import annotations

import hashlib
import os
import sys
from collections.abc import Callable
from contextlib import suppress
from functools import lru_cache
from pathlib import Path
from types import FunctionType, ModuleType
from typing import Any, Literal

from percept_obs.validation import warn, write_whole

Way = Literal["exact", "inlined", "batch"]

OPTIONS: dict[Way, dict[str, Any]] = {
    "exact": {"error_model": "numpy"},
    "inlined": {"error_model": "numpy"},
    "batch": {"error_model": "numpy", "fastmath": {"contract"}, "nogil": True},
}
"""Options of numba: rounding as in Python, twice, the second time with functions inlined; a b + c rounded once."""


class NotKept(UserWarning):
    """Machine code cannot be kept, or what was kept cannot be read."""


# Not in another thread: numba sets Python's warning filters while it compiles, and all threads share them.
@lru_cache(maxsize=512)
def machine_code(text: str, signature: Any, way: Way = "exact") -> Callable[..., Any]:
    """Compile the last function of a text; it may call those before it.

    numba keeps machine code of files only.  So the text becomes a file in the user's cache or NUMBA_CACHE_DIR, named by
    its hash; it must hold all that the code depends on, and may be deleted at any time.
    """
    import numba

    options, (text, file) = OPTIONS[way], _file(text, way)
    folder = file.parent

    def compiled(place: str, kept: bool) -> Callable[..., Any]:
        module = sys.modules[file.stem] = ModuleType(file.stem)  # where numba looks for the code of a file
        exec(compile(text, place, "exec"), vars(module))
        *others, last = (name for name, value in vars(module).items() if isinstance(value, FunctionType))
        inside = way != "exact"  # of the loop, for a call stops vector instructions
        for name in others:
            setattr(module, name, numba.njit(forceinline=inside, **options)(getattr(module, name)))
        found: Callable[..., Any] = numba.njit([signature], cache=kept, **options)(getattr(module, last))
        return found

    try:
        if not file.exists():
            folder.mkdir(parents=True, exist_ok=True)
            with suppress(PermissionError):  # on Windows, where another process has just written it, and reads it
                write_whole(file, text.encode())
        return compiled(str(file), True)
    except Exception as error:  # a full disk, or what was kept is cut off: unpickling it may raise anything
        with suppress(OSError):
            for each in folder.rglob(f"{file.stem}.*"):
                each.unlink()
        found = compiled("<printed>", False)
        _tell(folder, type(error).__name__)
        return found


def is_kept(text: str, way: Way = "exact") -> bool:
    """Return True if machine code of a text is on the disk."""
    _, file = _file(text, way)
    return any(file.parent.glob(f"*/{file.stem}.*.nbi"))


def _file(text: str, way: Way) -> tuple[str, Path]:
    """The whole text, and its file, which need not exist."""
    from platformdirs import user_cache_path

    text = f'"""A loop of percept_obs, which numba compiles {way}, with {OPTIONS[way]}."""\n\n{text}'
    folder = Path(os.environ.get("NUMBA_CACHE_DIR") or user_cache_path("percept_obs"))
    return text, folder / f"loop_{hashlib.sha256(text.encode()).hexdigest()[:32]}.py"


@lru_cache  # so that it warns once
def _tell(folder: Path, reason: str) -> None:
    warn(
        NotKept(
            f"machine code is not kept in {folder} ({reason}), so that it is compiled again the next time; what could "
            "not be read there is removed: free the disk, or set NUMBA_CACHE_DIR to a folder that can be written to"
        )
    )
