"""How long something still takes, and how many may work at it: neither asks for threads where there are none."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable
from typing import Any


def workers() -> int:
    """How many threads or processes may work beside each other: one for each core, and one in a browser's Python.

    Examples
    --------
    >>> workers() >= 1
    True
    """
    return 1 if sys.platform in ("emscripten", "wasi") else os.cpu_count() or 1


def bar(things: Iterable[Any] | None = None, said: str = "", total: float | None = None, **more: Any) -> Any:
    """A bar that grows with what is done, in a notebook and in a terminal; it comes after two seconds and goes.

    Parameters
    ----------
    things : iterable, optional
        What is gone through; without them, `update` of the bar says what is done.
    said : str
        What is being done.
    total : float, optional
        When all is done, where the things do not tell.
    **more
        As tqdm takes it, such as ``unit``.

    Examples
    --------
    >>> [2 * k for k in bar([1, 2, 3], "doubling")]
    [2, 4, 6]
    """
    from tqdm.auto import tqdm

    class Bar(tqdm):
        monitor_interval = 0  # no thread of its own, which a browser's Python cannot start

    return Bar(things, said, total, delay=2, leave=False, **more)
