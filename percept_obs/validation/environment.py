"""Optional modules, cores, progress bars, files and warnings: whatever depends on the machine or the caller."""

from __future__ import annotations

import json
import os
import sys
import warnings
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from typing import Any

PACKAGE = __name__.partition(".")[0]


def missing(*modules: str) -> list[str]:
    """Names of those modules that are not installed."""
    return [module for module in modules if find_spec(module) is None]


def needed(extra: str, *modules: str) -> None:
    """Raise ModuleNotFoundError if optional modules are missing, and say which extra of this package brings them."""
    if lacking := missing(*modules):
        words = "is missing; get it with" if len(lacking) == 1 else "are missing; get them with"
        raise ModuleNotFoundError(f'{", ".join(lacking)} {words}: python -m pip install "percept-obs[{extra}]"')


def load_pandas() -> Any:
    """Return the module pandas, which makes and reads tables; ModuleNotFoundError without the extra "data"."""
    needed("data", "pandas")
    import pandas

    return pandas


def workers() -> int:
    """Number of threads or processes to use: one a core, and one in a browser's Python."""
    return 1 if sys.platform in ("emscripten", "wasi") else os.cpu_count() or 1


def bar(things: Iterable[Any] | None = None, label: str = "", total: float | None = None, **options: Any) -> Any:
    """Progress bar in a notebook or a terminal that appears after two seconds and goes at the end.

    Without things to count, call its `update`; `total` is for those that do not tell their number.

    >>> [2 * k for k in bar([1, 2, 3], "doubling")]
    [2, 4, 6]
    """
    from tqdm.auto import tqdm

    class Bar(tqdm):
        monitor_interval = 0  # no thread of its own, which a browser's Python cannot start

    return Bar(things, label, total, delay=2, leave=False, **options)


def to_write(path: str | os.PathLike[str], *endings: str) -> Path:
    """Return a path to write to; ValueError for a folder, a file in none, or one with another ending than these."""
    target = Path(path)
    if target.is_dir() or not target.absolute().parent.is_dir():
        raise ValueError(f"cannot write '{path}'; name a file in a folder that is there")
    if endings and target.suffix and target.suffix.lower() not in endings:
        raise ValueError(f"what is written is no {target.suffix} file; name '{target.stem}{endings[0]}', not '{path}'")
    return target


@contextmanager
def whole(target: str | os.PathLike[str]) -> Iterator[Path]:
    """Yield another file to write, which then takes the name of the target, so that half a file is never found."""
    file = Path(target)
    if not file.parent.is_dir():
        raise FileNotFoundError(f"the folder of '{file}' is not there; name a file in one that is")
    if file.is_dir():
        raise ValueError(f"'{file}' is a folder; name a file in it")
    other = file.with_name(f".{os.getpid()}.{file.name}")
    try:
        yield other
        other.replace(file)
    except OSError as error:
        if not error.strerror:
            raise
        raise OSError(error.errno, error.strerror, str(file)) from None  # a full disk names no file
    finally:
        other.unlink(missing_ok=True)


def write_whole(target: str | os.PathLike[str], content: bytes) -> None:
    """Write a file, or leave the one that is there."""
    with whole(target) as other:
        other.write_bytes(content)


def read_json(file: str | os.PathLike[str]) -> Any:
    """Return what a file of JSON holds; a ValueError if it holds something else, or is nested too deep to be read."""
    try:
        return json.loads(Path(file).read_bytes())
    except RecursionError:
        raise ValueError("it cannot be read as JSON, for it is nested too deep; write it flatter") from None
    except ValueError as error:
        raise ValueError(f"it cannot be read as JSON: {error}") from None


def warn(warning: Warning) -> None:
    """Warn at the line of the first caller outside of this package."""
    level, frame = 2, sys._getframe(1)
    while frame.f_back and str(frame.f_globals.get("__name__", "")).partition(".")[0] == PACKAGE:
        level, frame = level + 1, frame.f_back
    warnings.warn(warning, stacklevel=level)
