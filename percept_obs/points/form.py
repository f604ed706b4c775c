"""Many points of one linear state and their images, derived for one point and repeated for all."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, ClassVar, NamedTuple

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike

from percept_obs.compile import Array, Indices, vectorised
from percept_obs.observability.directions import in_words, unobservable
from percept_obs.points.block import PointBlock, point_block
from percept_obs.recording import Recording
from percept_obs.system.derivation import Derivation, equals
from percept_obs.system.motion import Motion
from percept_obs.system.signal import readonly
from percept_obs.system.surfaces import POINT, ImagingSurface, pinhole
from percept_obs.validation import Entries, Times, checked, expression, matrix, numbers, set_fields, warn

DRAWS = 4
"""Number of draws of a motion's symbols, by which directions are found that no motion shows."""

JUDGED = "the points' positions"
"""Name of what verdicts judge of several points, also of live labs."""


class UnseenDirection(UserWarning):
    """A direction of the state that no image of any point depends on, whatever the camera sees."""


class Layout(NamedTuple):
    """Entries of [A, v] that are not 0: entry (rows, columns) is ``expressions[which]``, in the motion's parameters."""

    rows: Indices
    columns: Indices
    which: Indices
    expressions: tuple[sp.Expr, ...]


@checked
@dataclass(frozen=True, eq=False)
class PointsForm:
    """The system x' = A x + v with n states, and p points C_k x that a camera sees (Inaba et al. 2005, (1)-(3)).

    Parameters
    ----------
    motion : Motion
        From `linear`, `affine`, or a helper of `bodies`.
    C : array of shape (p, 3, n), or sequence of p matrices of shape (3, n)
        Point k is C_k x, in metres in the camera's frame.  A single matrix stands for one point.
    surface : ImagingSurface
        The pinhole when left out.
    names : tuple of str
        Names of the states; x1, x2, ... when left out.

    Raises
    ------
    ValueError
        If shapes do not match, entries are not finite, or names repeat.
    NotLinear
        If the surface is a curved one.

    Warns
    -----
    UnseenDirection
        If a direction of the state changes no image, whatever the motion's symbols are.

    See Also
    --------
    luenberger : An observer of it.
    percept_obs.points.rigid_body : The form of a body.

    Examples
    --------
    >>> import numpy as np
    >>> from percept_obs import PointsForm, linear
    >>> along = linear([[0.0, 1.0], [0.0, 0.0]], [0.0, 0.0])
    >>> form = PointsForm(along, np.array([[1.0, 0.0], [0.0, 0.0], [0.0, 2.0]]), names=("place", "speed"))
    >>> form.names, form.points
    (('place', 'speed'), 1)
    """

    motion: Motion
    C: Entries
    surface: ImagingSurface = field(default_factory=pinhole)
    names: tuple[str, ...] = ()
    judged: ClassVar[str] = JUDGED

    def __post_init__(self) -> None:
        n = self.motion.A.shape[0]
        blocks = [self.C] if np.ndim(self.C) < 3 and not isinstance(self.C, tuple) else list(self.C)
        shapes = {np.shape(block) for block in blocks}
        if shapes != {(3, n)}:
            raise ValueError(
                f"C has blocks of shape {', '.join(map(str, sorted(shapes))) or 'none'}; the motion has {n} states, so "
                f"each point needs a block of shape {(3, n)}"
            )
        names = tuple(self.names) or tuple(f"x{k + 1}" for k in range(n))
        set_fields(self, C=tuple(map(_matrix, blocks)), names=names)
        if len(set(names)) != len(names) or len(names) != n:
            raise ValueError(f"{len(names)} names were given for {n} states; each state needs a name of its own")
        point_block(self.surface)
        if not any(block.free_symbols for block in self.C):
            if not np.isfinite(self.blocks).all():
                raise ValueError("C has entries that are not finite; remove or repair the NaN or infinite ones")
            if not self.blocks.any(axis=(1, 2)).all():
                raise ValueError("a block of C is 0, so that its point is in the camera; leave the point out")
            if self.unseen.shape[1]:
                named = in_words(self.unseen, self.names)
                many = "a direction" if len(named) == 1 else f"{len(named)} directions"
                message = (
                    f"no image shows {many} of the state, whatever the camera sees: {'; '.join(named)}.  No observer "
                    "finds what no image shows: leave it out of the state, or let the camera see a point that moves "
                    "with it"
                )
                warn(UnseenDirection(message))

    @property
    def name(self) -> str:
        """Number of points and surface, in words."""
        return f"{self.points} points on the {self.surface.name}"

    @property
    def image_coordinates(self) -> tuple[sp.Symbol, ...]:
        """Symbols of a point's image coordinates."""
        return self.surface.image_coordinates

    @property
    def coordinates(self) -> tuple[sp.Symbol, ...]:
        """Symbols of the states."""
        return self.state

    @property
    def parameters(self) -> tuple[sp.Symbol, ...]:
        """Parameters of the surface."""
        return self.surface.parameters

    @property
    def values(self) -> Mapping[sp.Symbol, float]:
        """Values of the surface's parameters."""
        return self.surface.values

    @property
    def point_shape(self) -> tuple[int, ...]:
        """Shape (p,) of values given once a point."""
        return (self.points,)

    @property
    def lengths(self) -> tuple[int, ...]:
        """Zeros: nothing is converted, for linear equations are the same in any unit."""
        return (0,) * (self.states + len(self.parameters))

    def fits(self, other: object) -> bool:
        """True if an observer of this form can follow recordings of the other: as many points, on the same surface."""
        return isinstance(other, PointsForm) and self.points == other.points and self.surface.fits(other.surface)

    @property
    def points(self) -> int:
        """Number of points p."""
        return len(self.C)

    @property
    def states(self) -> int:
        """Number of states n."""
        return len(self.names)

    @cached_property
    def block(self) -> PointBlock:
        """One point's block."""
        return point_block(self.surface)

    @cached_property
    def blocks(self) -> Array:
        """Numbers of C, shape (p, 3, n)."""
        dense = np.zeros((self.points, 3, self.states))
        for k, block in enumerate(self.C):
            for (i, j), value in block.todok().items():
                dense[k, i, j] = float(value)
        return readonly(dense)

    @cached_property
    def surface_numbers(self) -> tuple[Array, Array]:
        """Numbers of the block: N of shape (m, 3) and l of shape (3,)."""
        N, l = (np.array(M.subs(self.surface.values), dtype=float) for M in (self.block.N, self.block.l))
        return N, l.ravel()

    @cached_property
    def layout(self) -> Layout:
        """The entries of [A, v] that are not 0; v is column n."""
        entries = [(i, j, e) for (i, j), e in sorted(self.motion.A.todok().items())]
        entries += [(i, self.states, e) for (i, _), e in sorted(self.motion.b.todok().items())]
        # entries with the same expression, as in a rotation's blocks, are evaluated once
        distinct = tuple(dict.fromkeys(e for _, _, e in entries))
        place = {e: k for k, e in enumerate(distinct)}
        places = np.array([(i, j, place[e]) for i, j, e in entries], dtype=np.intp).reshape(-1, 3)
        rows, columns, which = places.T.copy()
        return Layout(rows, columns, which, distinct)

    def numbers(self, times: Times) -> Array:
        """Numbers of the layout's expressions at the given times, shape (T, u) or (1, u) when constant."""
        return self._evaluated(self.motion.known(times))

    def coefficients(self, times: Times) -> tuple[Array, Array]:
        """A and v at the given times, shapes (T, n, n) and (T, n), or (1, ...) when constant."""
        together = self._dense(self.numbers(times))
        return together[:, :, :-1], together[:, :, -1]

    def locate(self, states: ArrayLike) -> Array:
        """Points C_k x of states of shape (..., n), in metres, shape (..., p, 3)."""
        states = numbers(states, "the states", self.states)
        unknown = np.asarray(~np.isfinite(states))
        places = np.einsum("kin,...n->...ki", self.blocks, np.where(unknown, 0.0, states), optimize=True)
        if unknown.any():
            # NaN only for the points that use an unknown state
            uses = (self.blocks != 0).any(axis=1)
            places[np.matmul(unknown, uses.T)] = np.nan
        return places

    def inverse(self, states: ArrayLike) -> Array:
        """Inverse depths in 1/m of states of shape (..., n), shape (..., p); negative behind the camera."""
        distance = self.locate(states) @ self.surface_numbers[1]
        return np.divide(1, distance, out=np.full_like(distance, np.inf), where=distance != 0)

    def relative_error(self, truth: Array, estimate: Array, known: Array) -> Array:
        """Error of the worst point's position, relative to its distance, shape (K,); see `View`."""
        true, found = self.locate(truth), self.locate(estimate)
        off, distance = (np.linalg.norm(rows, axis=-1) for rows in (found - true, true))
        return np.asarray((off / distance).max(axis=-1))

    def outputs(self, states: ArrayLike) -> Array:
        """Image coordinates of states of shape (..., n), shape (..., p, m); NaN behind the camera."""
        positions = self.locate(states)
        N, l = self.surface_numbers
        distance, images = (positions @ l)[..., None], positions @ N.T
        return np.divide(images, distance, out=np.full_like(images, np.nan), where=distance > 0)

    def information(self, outputs: ArrayLike) -> Array:
        """S = C^T B^T B C for outputs of shape (..., p, m), shape (..., n, n); points with a NaN are left out."""
        rows = self.rows(outputs)
        return np.swapaxes(rows, -1, -2) @ rows

    def rows(self, outputs: ArrayLike) -> Array:
        """B C for outputs of shape (..., p, m), shape (..., p m, n); 0 for points with a NaN."""
        outputs = numbers(outputs, "the outputs", self.points, len(self.image_coordinates))
        N, l = self.surface_numbers
        seen = np.asarray(np.isfinite(outputs).all(axis=-1))[..., None, None]
        rows = np.where(seen, N - np.nan_to_num(outputs)[..., None] * l, 0.0) @ self.blocks
        return rows.reshape(*outputs.shape[:-2], -1, self.states)

    @cached_property
    def unseen(self) -> Array:
        """Directions of the state that change no image, whatever the motion's symbols are, shape (n, q).

        The largest subspace that every C_k maps to 0 and every A maps into itself.  The pair (C, A) is then not
        observable, and so (14) fails for every trajectory (Proposition 3.3).
        """
        if self.motion.signal is not None and self.motion.signal.constant:
            known = self.motion.known(0.0)
        else:
            # a direction that random motions do not show is shown by none, almost surely
            known = np.random.default_rng(0).normal(size=(DRAWS, len(self.motion.parameters)))
        A = self._dense(self._evaluated(known))[:, :, :-1]
        return readonly(unobservable(A, self.blocks.reshape(-1, self.states)))

    @cached_property
    def state(self) -> tuple[sp.Symbol, ...]:
        """Symbols of the states."""
        return tuple(sp.Symbol(name, real=True) for name in self.names)

    @cached_property
    def y(self) -> tuple[sp.Symbol, ...]:
        """Symbols of all image coordinates: y1_2 is the first one of point 2."""
        return tuple(sp.Symbol(f"{y.name}_{k + 1}", real=True) for k in range(self.points) for y in self.block.y)

    @cached_property
    def stacked(self) -> sp.ImmutableMatrix:
        """The blocks C_k one below the other, shape (3 p, n)."""
        return sp.ImmutableMatrix.vstack(*self.C)

    @cached_property
    def B(self) -> sp.ImmutableMatrix:
        """B(y) of all points, shape (m p, 3 p)."""
        m, block = len(self.image_coordinates), self.block
        images = (self.y[k * m : (k + 1) * m] for k in range(self.points))
        return sp.ImmutableMatrix(sp.diag(*(block.B.xreplace(dict(zip(block.y, y, strict=True))) for y in images)))

    def E(self, state: Sequence[sp.Expr]) -> sp.ImmutableMatrix:
        """E of a state: one over the distance of each point, shape (m p, m p)."""
        column = matrix(state, "the state", self.states, 1)
        distances = [(self.block.l * C * column)[0] for C in self.C]
        return sp.ImmutableMatrix(sp.diag(*(sp.eye(len(self.image_coordinates)) / l for l in distances)))

    def H(self, state: Sequence[sp.Expr]) -> sp.ImmutableMatrix:
        """Images of all points of a state, shape (m p, 1)."""
        column = matrix(state, "the state", self.states, 1)
        seen = [dict(zip(POINT, C * column, strict=True)) for C in self.C]
        return sp.ImmutableMatrix([e.subs(point, simultaneous=True) for point in seen for e in self.surface.image])

    def derivation(self) -> Derivation:
        """Derivation of the innovation of all points from the image of one, step by step."""
        block, xi = self.block, sp.Matrix(POINT)
        formulas = {
            "The state moves:": rf"\dot x = A x + v,\quad n = {self.states}",
            "A point of it is seen at:": equals("y", sp.Matrix(self.surface.image)),
            "Times its distance this is linear in the point:": (
                rf"{sp.latex(self.surface.distance)}\, y = {sp.latex(block.N)} {sp.latex(xi)}"
            ),
            "So the point lies in the kernel of:": equals("B(y)", block.B),
            "The same at the estimate leaves the innovation, linear in the error:": (
                r"y - h(\hat\xi) = \frac{1}{l\hat\xi}\, B(y)\,(\xi - \hat\xi)"
            ),
            "What an instant tells of the point:": equals("B^T B", block.S),
            "Its eigenvalues, 0 for the ray:": ",\\ ".join(map(sp.latex, block.eigenvalues())),
            f"For all {self.points} points, block by block:": r"y - H(C\hat x) = E(\hat x)\, B(y)\, C\, (x - \hat x)",
        }
        return Derivation.of(formulas)

    def _repr_latex_(self) -> str:
        return (
            rf"$\displaystyle \dot x = A x + v,\quad x \in \mathbb{{R}}^{{{self.states}}},\quad "
            rf"y_k = h(C_k x),\ k = 1 \ldots {self.points},\quad B_k = {sp.latex(self.block.B)}$"
        )

    def _evaluated(self, known: Array) -> Array:
        """Numbers of the layout's expressions for values of the motion's parameters, shape (T, u)."""
        expressions = self.layout.expressions
        if not expressions:
            return np.zeros((len(known), 0))
        if not self.motion.parameters:
            return np.array([[float(e) for e in expressions]])
        return np.stack(self._function(*known.T), axis=-1)

    @cached_property
    def _function(self) -> Callable[..., list[Array]]:
        """The layout's expressions as a function; a path calls it thousands of times."""
        return vectorised(self.motion.parameters, self.layout.expressions)

    def _dense(self, values: Array) -> Array:
        """Matrices [A, v], shape (T, n, n + 1), from numbers of the layout's expressions."""
        together = np.zeros((len(values), self.states, self.states + 1))
        together[:, self.layout.rows, self.layout.columns] = values[:, self.layout.which]
        return together


def points_form(recording: Recording) -> PointsForm:
    """Return the form of a recording; raise ValueError if it does not show points of a state."""
    if not isinstance(recording.view, PointsForm):
        raise ValueError(f"this needs a recording of points of a state, but it shows the {recording.view.name}")
    return recording.view


def _matrix(block: Any) -> sp.ImmutableMatrix:
    """A sparse matrix; numbers become floats."""
    array = np.asarray(block, dtype=object)
    entries = {(i, j): expression(array[i, j], "an entry of C") for i, j in zip(*np.nonzero(array), strict=True)}
    return sp.ImmutableSparseMatrix(*array.shape, entries)
