"""How often an answer was checked, with how many hints and for how long: written below the check's reply."""

from __future__ import annotations

import re
import time
from dataclasses import dataclass, field, replace

from percept_obs.checking import Review
from percept_obs.exercises.answers import Attempt

WRITTEN = re.compile(r"\*Task ([\w-]+): attempt (\d+), hints (\d+), minutes (\d+)\.\*")
"""A tally as `tally` writes it."""


@dataclass
class _Seen:
    """Attempts at a task since Python was started."""

    began: float = field(default_factory=time.monotonic)
    attempts: int = 0
    hints: int = 0


_SEEN: dict[str, _Seen] = {}


@dataclass(frozen=True)
class Tallied:
    """Reply to an answer, with how many attempts and hints it took.

    Parameters
    ----------
    reply : Attempt or Review
    task : str
        Name of the exercise.

    See Also
    --------
    tally : Makes it.

    Examples
    --------
    >>> print(Tallied(Attempt(True, "Yes, c."), "second"))
    Yes, c.
    """

    reply: Attempt | Review
    task: str

    @property
    def right(self) -> bool | None:
        """Whether the answer is right, as the reply says."""
        return self.reply.right

    def hint(self, number: int) -> Tallied:
        """Return the reply with a hint, which is counted."""
        hinted = replace(self, reply=self.reply.hint(number))
        _SEEN[self.task].hints = max(_SEEN[self.task].hints, number)
        return hinted

    def __str__(self) -> str:
        return str(self.reply)

    def _repr_markdown_(self) -> str:
        seen = _SEEN.get(self.task)
        words = self.reply._repr_markdown_()
        if not seen or not seen.attempts:
            return words
        minutes = round((time.monotonic() - seen.began) / 60)
        return f"{words}\n\n*Task {self.task}: attempt {seen.attempts}, hints {seen.hints}, minutes {minutes}.*"


def tally(reply: Attempt | Review, task: str) -> Tallied:
    """Count an attempt, if there is an answer, and return the reply with the count.

    The count begins anew when Python is started again.

    Parameters
    ----------
    reply : Attempt or Review
    task : str
        Name of the exercise.

    See Also
    --------
    students_copy : Puts it around the checks.

    Examples
    --------
    >>> tally(Attempt(None, "Choose first."), "second")._repr_markdown_()
    'Choose first.'
    """
    seen = _SEEN.setdefault(task, _Seen())
    if isinstance(reply, Review) or reply.right is not None:
        seen.attempts += 1
        seen.hints = max(seen.hints, getattr(reply, "hints", 0))
    return Tallied(reply, task)
