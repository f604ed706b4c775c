"""Limits on what a formula may cost: processor time, and its size once all definitions are put in."""

from __future__ import annotations

import _thread
import ctypes
import sys
import threading
import time
from collections.abc import Callable
from functools import lru_cache
from math import log2
from typing import Any, NamedTuple, TypeVar

import sympy as sp

SECONDS = 2.0
TOO_LONG = f"too long to decide in {SECONDS:.0f} s; write it shorter"
LARGEST, DEEPEST, HIGHEST, LONGEST, TALLEST = 4000, 100, 200, 40, 1e4
"""Most parts of formulas, their depth, degree, digits of a number, and bits of one's integer part."""
_AGAIN = 0.05
"""Seconds after which the exception is raised again, for somebody's handler may have swallowed the first one."""

T = TypeVar("T")


class TooLong(ValueError):
    """A formula that takes too long to decide.

    See Also
    --------
    percept_obs.check : Raises it.
    """


class _Over(BaseException):
    """The time is up; handlers of errors do not catch it."""


_limits_of_thread = threading.local()


def limited(work: Callable[[], T], seconds: float = SECONDS) -> T:
    """Return what `work` returns, or raise TooLong once this thread has computed for so many seconds.

    Inside of another limit the outer one counts.
    """
    outer: _Watch | None = getattr(_limits_of_thread, "watch", None)
    if outer:
        if outer.over:
            raise TooLong(TOO_LONG)
        try:
            return work()
        except (_Over, RecursionError):
            raise TooLong(TOO_LONG) from None
    watch = _limits_of_thread.watch = _Watch(seconds)
    try:
        try:
            watch.start()
            return work()
        finally:
            watch.stop()
    except (_Over, RecursionError):
        watch.stop()  # the exception may have come while it stopped
        raise TooLong(TOO_LONG) from None


def left() -> float:
    """Return how many seconds are left to what is limited."""
    watch: _Watch | None = getattr(_limits_of_thread, "watch", None)
    return max(watch.end - watch.now(), 0) if watch else SECONDS


def heed() -> None:
    """Raise if the time is up, where no second thread can do so; called in the loops of long work."""
    watch: _Watch | None = getattr(_limits_of_thread, "watch", None)
    if watch and watch.alone and watch.now() > watch.until:
        raise _Over


class _Watch:
    """Raises an exception in the thread that made it once that has computed for too long.

    A second thread waits, so that what is watched is not slowed down.  Where there are no threads, as in a browser,
    `heed` reads the clock, and the limits on size bound the rest.
    """

    def __init__(self, seconds: float) -> None:
        # no Event: if the exception came while it is set, its own lock would stay taken, and the next call would hang
        self.thread, self.lock, self.running = threading.get_ident(), threading.Lock(), threading.Lock()
        self.running.acquire()
        self.done = False
        own = getattr(time, "pthread_getcpuclockid", None)  # other systems cannot read the clock of another thread
        self.clock = own(self.thread) if own else None
        self.end = self.until = self.now() + seconds
        self.alone, self.report = False, sys.unraisablehook

    def now(self) -> float:
        """Return the seconds that the thread has computed, or else the process."""
        return time.process_time() if self.clock is None else time.clock_gettime(self.clock)

    @property
    def over(self) -> bool:
        """True once the time is up."""
        return self.now() > self.end

    def start(self) -> None:
        """Begin to watch; an end that cannot be raised, as while a generator closes, comes again, and unreported."""
        self.report = report = sys.unraisablehook
        sys.unraisablehook = lambda error: None if error.exc_type is _Over else report(error)
        try:
            _thread.start_new_thread(self.wait, ())
        except RuntimeError:  # no thread can be started
            self.alone = True

    def stop(self) -> None:
        """Watch no longer; nothing is raised afterwards."""
        self.done = True
        with self.lock:
            self.send(None)
        if self.running.locked():
            self.running.release()
        _limits_of_thread.watch = None
        sys.unraisablehook = self.report

    def wait(self) -> None:
        """Wait for the end, in a thread of its own."""
        while not self.running.acquire(timeout=max(self.until - self.now(), 0.001)):
            with self.lock:
                if self.now() > self.until and not self.done:
                    self.send(ctypes.py_object(_Over))

    def send(self, error: Any) -> None:
        """Let the watched thread raise an exception at its next instruction; None takes back one not raised yet."""
        self.until = self.now() + _AGAIN
        ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(self.thread), error)


class Extent(NamedTuple):
    """Letters, numbers and operations of a formula that is written out, how deep it is nested, and its degree."""

    parts: int
    depth: int
    degree: int


@lru_cache(maxsize=1 << 14)
def extent(e: sp.Basic) -> Extent:
    """Return upper bounds of a formula's extent; parts that occur again are looked at once."""
    inner = [extent(part) for part in e.args] or [Extent(0, 0, 1)]
    degree = max(part.degree for part in inner)
    if isinstance(e, sp.Mul | sp.MatMul):
        degree = sum(part.degree for part in inner)
    elif e.is_Pow and e.exp.is_Rational:
        degree = inner[0].degree * max(1, abs(int(e.exp.p)))
    return Extent(1 + sum(part.parts for part in inner), 1 + max(part.depth for part in inner), degree)


def refused(*formulas: sp.Basic) -> str:
    """Return why formulas are too large to be compared; empty if they are not."""
    found = [extent(e) for e in formulas]
    if (parts := sum(each.parts for each in found)) > LARGEST:
        return f"written out this has {parts if parts < 1e9 else 'over 10^9'} parts; at most {LARGEST} are compared"
    if any(each.depth > DEEPEST for each in found):
        return f"written out this is nested more than {DEEPEST} deep; write it flatter"
    if any(each.degree > HIGHEST for each in found):
        return f"written out this has a degree above {HIGHEST}; there must be a smaller way to write it"
    numbers = {n for e in formulas for n in e.atoms(sp.Rational)}
    if any(max(abs(n.p), n.q) >= 10**LONGEST for n in numbers):
        return f"written out this has a number of more than {LONGEST} digits; write it with smaller ones"
    return ""


def too_tall(number: sp.Expr) -> bool:
    """Return True for a number of so many digits, exp(exp(exp(9))), that no function of it can be computed."""
    return not number.free_symbols and _height(number) > TALLEST


def _height(e: sp.Basic) -> float:
    """Return an upper bound of the binary logarithm of a number's absolute value."""
    if e.is_Rational:
        return log2(max(abs(e.p), 1))
    inner = [_height(part) for part in e.args] or [2.0]
    if e.is_Add:
        return max(inner) + log2(len(inner))
    if e.is_Mul:
        return sum(inner)
    if e.is_Pow and e.exp.is_Rational:  # of a number near zero the inverse is as long as the number itself
        return max(inner[0], 1) * max(1.0, abs(float(e.exp)))
    bounded = isinstance(e, sp.sin | sp.cos | sp.tanh | sp.sech | sp.asin | sp.acos | sp.atan | sp.sign)
    return 1.0 if bounded else 2 * 2 ** min(max(inner), 1000)
