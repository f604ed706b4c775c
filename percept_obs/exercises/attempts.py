"""Counts of checks, hints and minutes, written below the reply to an answer."""

from __future__ import annotations

import re
import time
from dataclasses import dataclass, replace

from percept_obs.checking import Review
from percept_obs.exercises.answers import Attempt
from percept_obs.validation import checked

WRITTEN = re.compile(r"\*Task ([\w-]+): attempt (\d{1,6}), hints (\d{1,6}), minutes (\d{1,6})\.\*")
"""A count as `tally` writes it."""

_COUNTS: dict[str, tuple[float, int, int]] = {}
"""When a task was first checked, how often since then, and the largest number of a hint."""


@dataclass(frozen=True)
class _Tallied:
    """Reply to an answer, which shows how many attempts and hints it took; see `tally`."""

    reply: Attempt | Review
    task: str

    @property
    def right(self) -> bool | None:
        """True if the answer is right, False if it is wrong, None if that is not known."""
        return self.reply.right

    def hint(self, number: int) -> _Tallied:
        """Return the reply with a hint, which is counted."""
        hinted = replace(self, reply=self.reply.hint(number))
        began, attempts, hints = _COUNTS[self.task]
        _COUNTS[self.task] = began, attempts, max(hints, number)
        return hinted

    def __str__(self) -> str:
        return str(self.reply)

    def _repr_markdown_(self) -> str:
        began, attempts, hints = _COUNTS[self.task]
        minutes = round((time.monotonic() - began) / 60)
        count = f"\n\n*Task {self.task}: attempt {attempts}, hints {hints}, minutes {minutes}.*" if attempts else ""
        return self.reply._repr_markdown_() + count


@checked
def tally(reply: Attempt | Review, task: str) -> _Tallied:
    """Return a reply with the number of attempts at its task, which grows if there is an answer.

    Parameters
    ----------
    reply : Attempt or Review
    task : str
        Name of the exercise.  Its count begins anew when Python is started again.

    See Also
    --------
    students_copy : Puts it around the checks.

    Examples
    --------
    >>> tally(Attempt(None, "Choose first."), "second")._repr_markdown_()
    'Choose first.'
    """
    began, attempts, hints = _COUNTS.get(task, (time.monotonic(), 0, 0))
    answered = isinstance(reply, Review) or reply.right is not None
    _COUNTS[task] = began, attempts + answered, max(hints, getattr(reply, "hints", 0))
    return _Tallied(reply, task)
