"""What is gathered over windows of a trajectory: matrices whose eigenvalues tell which directions are seen."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from percept_obs.compile import Array, Indices
from percept_obs.observability.directions import in_words
from percept_obs.recording import Recording
from percept_obs.system.signal import slack_of

Piece = tuple[Array, Array]

UNSEEN = 1e-6
"""A direction whose eigenvalue is below this share of the largest one is not seen."""


class OverWindows:
    """Symmetric matrices, one for each window: how much of each direction of the state the window shows.

    Who inherits it has `time` of shape (T,), `matrices` of shape (T, n, n), the `window` in seconds, and the `names`
    of the n states.
    """

    time: Array
    matrices: Array
    window: float

    @property
    def names(self) -> tuple[str, ...]:
        """Of the n states."""
        raise NotImplementedError

    @cached_property
    def eigenvalues(self) -> Array:
        """Eigenvalues of each window's matrix, increasing, shape (T, n)."""
        return np.asarray(np.linalg.eigvalsh(self.matrices))

    @property
    def smallest(self) -> Array:
        """Smallest eigenvalue of each window, shape (T,)."""
        return np.asarray(self.eigenvalues[:, 0])

    @property
    def least(self) -> float:
        """The smallest of all windows, or 0 but for rounding where a direction is not seen."""
        return float(self.smallest.min())

    @property
    def reference(self) -> Array:
        """What eigenvalues are compared with, positive, shape (T,): the largest of each window."""
        return np.maximum(self.eigenvalues[:, -1], 1e-300)

    @property
    def holds(self) -> bool:
        """Whether every direction is seen in every window."""
        return bool((self.eigenvalues[:, 0] > UNSEEN * self.reference).all())

    @cached_property
    def weakest(self) -> int:
        """Number of the first window that misses most directions, or if none is missed, of the one that shows least."""
        missed = (self.eigenvalues <= UNSEEN * self.reference[:, None]).sum(axis=1)
        return int(np.argmax(missed) if missed.any() else np.argmin(self.eigenvalues[:, 0] / self.reference))

    def unseen(self, window: int | None = None) -> Array:
        """Directions of the state that a window does not show, orthonormal, shape (n, q).

        Parameters
        ----------
        window : int, optional
            Its number; the weakest one when left out.
        """
        k = self.weakest if window is None else window
        values, vectors = np.linalg.eigh(self.matrices[k])
        return np.asarray(vectors[:, values <= UNSEEN * self.reference[k]])

    def lost(self, window: int | None = None) -> tuple[str, ...]:
        """The same directions in words, such as "y2 - y3"."""
        return in_words(self.unseen(window), self.names)


def check_window(recording: Recording, window: float) -> None:
    """Refuse a window that does not fit into a recording.

    Raises
    ------
    ValueError
        If it is not positive or longer than the recording.
    """
    length = recording.elapsed[-1]
    if not 0 < window <= length + slack_of(recording.time):
        raise ValueError(f"the window is {window} s; it must be positive and at most {length:.4g} s")


def check_samples(recording: Recording, window: float) -> None:
    """Refuse a window that does not fit into a recording, or fits between two samples."""
    check_window(recording, window)
    shortest = float(np.diff(recording.time).min())
    if window < shortest * (1 - 1e-9):
        raise ValueError(f"the window is {window} s, shorter than the {shortest:.4g} s between two samples; widen it")


def gathered(time: Array, S: Array, Phi: Array, window: float) -> tuple[Indices, Array]:
    """Integrals of Phi^T S Phi over all windows that begin at a sample, without inverting a transition.

    A piece of time has a transition and an integral; two pieces that follow each other make one.  The pieces of a
    window wait in two stacks, so that each is joined a few times only, however many windows it is part of.

    Parameters
    ----------
    time : array of shape (K,)
        Seconds.
    S : array of shape (K, n, n)
        What each sample shows.
    Phi : array of shape (K - 1, n, n)
        Transitions from each sample to the next.
    window : float
        Seconds.

    Returns
    -------
    begins : array of shape (T,)
        Samples at which the windows begin.
    matrices : array of shape (T, n, n)
    """
    h = np.diff(time)[:, None, None]
    integrals = h / 2 * (S[:-1] + np.swapaxes(Phi, 1, 2) @ S[1:] @ Phi)
    ends = np.searchsorted(time, time + window - slack_of(time))
    begins = np.flatnonzero(ends < len(time))

    front: list[Piece] = []
    back: Piece | None = None
    pushed, matrices = 0, []
    for first in begins:
        while pushed < ends[first]:
            piece = (Phi[pushed], integrals[pushed])
            back = piece if back is None else _join(back, piece)
            pushed += 1
        if not front:
            # all pieces of the window, joined from the last one on
            for j in range(pushed - 1, first - 1, -1):
                piece = (Phi[j], integrals[j])
                front.append(_join(piece, front[-1]) if front else piece)
            back = None
        whole = front.pop() if back is None else _join(front.pop(), back)
        matrices.append((whole[1] + whole[1].T) / 2)
    return begins, np.stack(matrices)


def _join(first: Piece, second: Piece) -> Piece:
    """One piece from two: the second one is seen through the first one's transition."""
    (Phi, G), (Phi_next, G_next) = first, second
    return Phi_next @ Phi, G + Phi.T @ G_next @ Phi
