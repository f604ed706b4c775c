"""Machine code by numba, kept in the user's cache, so that a machine compiles each text once."""

from __future__ import annotations

import hashlib
import os
import sys
from collections.abc import Callable
from functools import lru_cache
from pathlib import Path
from types import FunctionType, ModuleType
from typing import Any, Literal
from uuid import uuid4

Rounding = Literal["exact", "contracted", "batch"]

OPTIONS: dict[Rounding, dict[str, Any]] = {
    "exact": {"error_model": "numpy"},
    "contracted": {"error_model": "numpy", "fastmath": {"contract"}},
    "batch": {"error_model": "numpy", "fastmath": {"contract"}, "nogil": True},
}
"""Options of numba: rounding as in Python; a product and a sum rounded once, in no other order; and this in threads."""


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
    content = text.encode()
    folder = Path(os.environ.get("NUMBA_CACHE_DIR") or user_cache_path("percept_obs"))
    file = folder / f"loop_{hashlib.sha256(content).hexdigest()[:32]}.py"
    nearest = next(place for place in (folder, *folder.parents) if os.path.exists(place))
    kept = nearest.is_dir() and os.access(nearest, os.W_OK | os.X_OK)
    if kept and not file.exists():
        folder.mkdir(parents=True, exist_ok=True)
        new = file.with_suffix(f".{uuid4().hex}")
        new.write_bytes(content)
        new.replace(file)  # whole, for other processes may read it
    module = sys.modules[file.stem] = ModuleType(file.stem)  # where numba looks when it takes the code from the file
    exec(compile(text, str(file) if kept else "<printed>", "exec"), vars(module))
    *others, last = (name for name, value in vars(module).items() if isinstance(value, FunctionType))
    inside = rounding == "batch"  # of the loop, for a call stops vector instructions
    for name in others:
        setattr(module, name, numba.njit(forceinline=inside, **options)(getattr(module, name)))
    compiled: Callable[..., Any] = numba.njit([signature], cache=kept, **options)(getattr(module, last))
    return compiled
