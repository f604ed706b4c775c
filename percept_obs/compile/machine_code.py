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

Rounding = Literal["exact", "contracted", "batch"]

OPTIONS: dict[Rounding, dict[str, Any]] = {
    "exact": {"error_model": "numpy"},
    "contracted": {"error_model": "numpy", "fastmath": {"contract"}},
    "batch": {"error_model": "numpy", "fastmath": {"contract"}, "nogil": True},
}
"""Options of numba: rounding as in Python; a b + c may be rounded once only; the same, and threads may run at once."""


class NotKept(UserWarning):
    """Machine code cannot be kept, or what was kept cannot be read."""


# Not in another thread: numba sets Python's warning filters while it compiles, and all threads share them.
@lru_cache(maxsize=512)
def machine_code(text: str, signature: Any, rounding: Rounding = "exact") -> Callable[..., Any]:
    """Compile the last function of a text; it may call those before it.

    numba keeps machine code of files only.  So the text becomes a file in the user's cache or NUMBA_CACHE_DIR, named by
    its hash; it must hold all that the code depends on, and may be deleted at any time.
    """
    import numba
    from platformdirs import user_cache_path

    options = OPTIONS[rounding]
    text = f'"""A loop of percept_obs, which numba compiles with {options}."""\n\n{text}'
    folder = Path(os.environ.get("NUMBA_CACHE_DIR") or user_cache_path("percept_obs"))
    file = folder / f"loop_{hashlib.sha256(text.encode()).hexdigest()[:32]}.py"

    def compiled(place: str, kept: bool) -> Callable[..., Any]:
        module = sys.modules[file.stem] = ModuleType(file.stem)  # where numba looks for the code of a file
        exec(compile(text, place, "exec"), vars(module))
        *others, last = (name for name, value in vars(module).items() if isinstance(value, FunctionType))
        inside = rounding == "batch"  # of the loop, for a call stops vector instructions
        # the functions before the last one become machine code first, for it calls them
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


@lru_cache  # so that it warns once
def _tell(folder: Path, reason: str) -> None:
    warn(
        NotKept(
            f"machine code is not kept in {folder} ({reason}), so that it is compiled again the next time; what could "
            "not be read there is removed: free the disk, or set NUMBA_CACHE_DIR to a folder that can be written to"
        )
    )
