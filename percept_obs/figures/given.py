"""What figures are given: of which kind it must be, what may be drawn together, and under which labels.

All else is refused with a ValueError.
"""

from collections.abc import Iterable, Sequence
from typing import Any, TypeVar

import numpy as np

from percept_obs.recording import Recording
from percept_obs.tracking.run import Run

T = TypeVar("T")


def one(data: Any, kinds: type | tuple[type, ...], source: str) -> None:
    """Refuse what is of none of the kinds; the source says what makes one."""
    names = [kind.__name__ for kind in (kinds if isinstance(kinds, tuple) else (kinds,))]
    if not isinstance(data, kinds):
        raise ValueError(f"{' or '.join(map(_with_article, names))} is needed, not {data!r}; {source} makes one")


def several(data: T | Iterable[T], kind: type[T], source: str) -> list[T]:
    """One or several of a kind as a list; the source says what makes one."""
    found: list[Any] = list(data) if isinstance(data, Iterable) else [data]
    if not found or not all(isinstance(each, kind) for each in found):
        raise ValueError(f"{_with_article(kind.__name__)} or several are needed, not {data!r}; {source} makes one")
    return found


def _with_article(name: str) -> str:
    return f"{'an' if name[0] in 'AEIO' else 'a'} {name}"


def recording_and_run(data: Run | Recording) -> tuple[Recording, Run | None]:
    """A recording, and what an observer made of it if there is a run."""
    one(data, (Run, Recording), "track() or record()")
    return (data.recording, data) if isinstance(data, Run) else (data, None)


def runs_of_one_point(runs: Run | Sequence[Run]) -> list[Run]:
    """Runs as a list, whose times, surfaces and truths are the same."""
    found = several(runs, Run, "track()")
    first = found[0].recording
    for number, run in enumerate(found[1:], 2):
        other = run.recording
        same = {
            "surfaces": other.view.fits(first.view),
            "times": np.array_equal(other.time, first.time),
            "truths": equal(other.truth, first.truth),
        }
        differing = [what for what, alike in same.items() if not alike]
        if differing:
            raise ValueError(
                f"run {number} followed another point than run 1: their {' and '.join(differing)} differ; draw runs on "
                "one recording, or one figure for each"
            )
    return found


def equal(one: Any, other: Any) -> bool:
    """Whether two arrays are the same, or both are missing."""
    return one is other if one is None or other is None else np.array_equal(one, other)


def labels_for(labels: Sequence[str] | None, otherwise: Sequence[str]) -> list[str]:
    """The labels if they are given, one for each of the others, or else these, numbered if they repeat."""
    if labels is None:
        repeated = len(set(otherwise)) < len(otherwise)
        return [f"{name} [{k}]" if repeated else name for k, name in enumerate(otherwise, 1)]
    if isinstance(labels, str) or len(labels) != len(otherwise):
        raise ValueError(f"labels= is {labels!r}; a list of {len(otherwise)} is needed, one for each curve")
    return list(labels)
