"""Motions in the camera's frame: X' = A X + b of a point, x' = A x + v of a state of any size."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, partial, wraps
from inspect import signature
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike

from percept_obs.compile import Array, vectorised
from percept_obs.system.breaks import breaks_of
from percept_obs.system.signal import OverTime, Signal
from percept_obs.validation import (
    MOST_TERMS,
    Chain,
    Coefficients,
    Times,
    are_numbers,
    checked,
    limit,
    matrix,
    numbers,
    positive,
    warn,
    with_article,
)

Coefficient = tuple[Any, sp.ImmutableMatrix]

TIME = sp.Symbol("t", real=True)
"""Time in seconds: a motion whose coefficients are expressions in nothing else is known at all times."""


@checked
@dataclass(frozen=True, eq=False)
class Motion:
    """Motion X' = A X + b, in symbols, with numbers for the symbols if they are known.

    Parameters
    ----------
    name : str
        Name in messages, such as "affine".
    A, b : sympy matrices of shape (n, n) and (n, 1), n = 3 for a single point
        Coefficients in 1/s and m/s.
    parameters : tuple of sympy symbols
        The symbols in A and b, in the order of the signal's columns.
    signal : Signal, optional
        Values of `parameters` over time.  It pickles with functions of a module; a lambda, pickle refuses.
    errors : PoseErrors, optional
        Errors of the camera's poses that the signal was made from.
    densities : mapping of names of parameters, or of a view's states, to floats, optional
        Densities of white noise in the signal, variance times the time between samples, or in a state's rate.

    Raises
    ------
    WrongKind
        If an argument is of another kind.

    See Also
    --------
    affine, rigid, linear : Make it.

    Examples
    --------
    >>> from percept_obs import rigid
    >>> motion = rigid(camera_angular_velocity=[0.0, 0.0, 0.1], camera_velocity=[0.0, 0.0, 0.5])
    >>> motion.A
    Matrix([
    [    0,  w_c3, -w_c2],
    [-w_c3,     0,  w_c1],
    [ w_c2, -w_c1,     0]])
    >>> motion.values[motion.parameters[2]]
    0.1
    """

    name: str
    A: sp.ImmutableMatrix
    b: sp.ImmutableMatrix
    parameters: tuple[sp.Symbol, ...]
    signal: Signal | None = None
    errors: Any = None
    densities: Mapping[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        n = self.b.rows
        if (self.A.shape, self.b.shape) != ((n, n), (n, 1)):
            raise ValueError(f"A has the shape {self.A.shape} and b {self.b.shape}; expected (n, n) and (n, 1)")

    @cached_property
    def lengths(self) -> tuple[int, ...]:
        """Power of length of each parameter: 1 for those of b, else 0."""
        return tuple(int(symbol in self.b.free_symbols) for symbol in self.parameters)

    def speed(self, times: Array) -> float:
        """Root mean square of |b| at some times, with 0 for symbols that are no parameters."""
        b = self.b.xreplace(dict.fromkeys(self.b.free_symbols - set(self.parameters), sp.S.Zero))
        entries = np.stack(vectorised(self.parameters, list(b))(*self.known(times).T))
        return float(np.sqrt((entries**2).sum(axis=0).mean()))

    def refuse_unit(self, unit: float) -> None:
        """Raise ValueError if a unit of length is not positive, or is not 1 while b holds lengths in its formula."""
        positive(**{"the unit of length": unit})
        if unit != 1 and not self._scales:
            raise ValueError(
                f"the unit of length is {unit:.4g}, but the {self.name} motion has b = {list(self.b)}, with lengths in "
                "its formula; give b as numbers or as a function of time, or leave the unit at 1"
            )

    @cached_property
    def _scales(self) -> bool:
        """True if b is proportional to its parameters, so that its lengths can be converted."""
        twice = self.b.xreplace({symbol: 2 * symbol for symbol in self.b.free_symbols - self.A.free_symbols})
        return bool((twice - 2 * self.b).expand().is_zero_matrix)

    @property
    def values(self) -> dict[sp.Symbol, float]:
        """Numbers of a constant motion's symbols; empty if there are none or they vary."""
        return {} if self.constants is None else dict(zip(self.parameters, self.constants[0].tolist(), strict=True))

    @cached_property
    def constants(self) -> Array | None:
        """Values of `parameters` if they are constant, shape (1, p)."""
        return self.known(0.0) if self.signal is not None and self.signal.constant else None

    def known(self, times: Times) -> Array:
        """Values of `parameters` at the given times, shape (T, p) or (1, p) when constant.

        It raises ValueError if the motion has symbols without numbers, or a time lies outside the known ones.
        """
        if self.signal is None:
            if names := ", ".join(map(str, self.parameters)):
                remedy = "write the time as percept_obs.system.motion.TIME" if names == "t" else "build it with numbers"
                raise ValueError(
                    f"the {self.name} motion has no values for {names}; {remedy}, for instance affine(A, b)"
                )
            return np.zeros((1, 0))
        rows = self.signal.at(times)
        if rows.shape[1] != len(self.parameters):
            raise ValueError(f"the {self.name} motion has {len(self.parameters)} parameters, not {rows.shape[1]}")
        return rows

    def _repr_latex_(self) -> str:
        return rf"$\displaystyle \dot X = {sp.latex(self.A)} X + {sp.latex(self.b)}$"


@checked
def affine(A: Coefficients | None = None, b: Coefficients | None = None, times: Times | None = None) -> Motion:
    """Return the affine motion X' = A X + b (Ma 2005, (1), p. 63); given numbers are the values of its symbols.

    Parameters
    ----------
    A : array of shape (3, 3) or (K, 3, 3), function of time, or sympy matrix, optional
        Coefficients in 1/s; symbols a11 ... a33 when left out.  Expressions in `TIME` alone are functions of time.
    b : array of shape (3,) or (K, 3), function of time, or sympy expressions or column, optional
        Coefficients in m/s; symbols b1, b2, b3 when left out.
    times : array of shape (K,), optional
        Times in seconds of sampled coefficients.

    Returns
    -------
    Motion
        With A of shape (3, 3) and b of shape (3, 1).

    Raises
    ------
    ValueError
        If shapes do not match, values are not finite, or times do not increase or are those of constants.

    See Also
    --------
    rigid, linear : Other motions.

    Examples
    --------
    >>> from percept_obs import affine
    >>> affine().A
    Matrix([
    [a11, a12, a13],
    [a21, a22, a23],
    [a31, a32, a33]])
    >>> affine([[0.0] * 3] * 3, [0.5, 0.0, 0.0]).b.T
    Matrix([[b1, b2, b3]])
    """
    A_symbols = sp.ImmutableMatrix(3, 3, lambda i, j: sp.Symbol(f"a{i + 1}{j + 1}", real=True))
    b_symbols = sp.ImmutableMatrix(sp.symbols("b1:4", real=True))
    return bound("affine", A_symbols, b_symbols, [(A, A_symbols), (b, b_symbols)], times)


@checked
def rigid(
    *,
    camera_angular_velocity: Coefficients | None = None,
    camera_velocity: Coefficients | None = None,
    point_velocity: Coefficients | None = None,
    times: Times | None = None,
    chwa_rotation: Coefficients | None = None,
) -> Motion:
    """Return the rigid motion X' = -w_c x X - v_c + v_p of a point seen by a camera, with all in the camera's axes.

    Parameters
    ----------
    camera_angular_velocity, camera_velocity, point_velocity : arrays of shape (3,) or (K, 3), functions of time, \
optional
        Values of w_c in rad/s, as a gyroscope in the camera has it, and of v_c and v_p in m/s; symbols when all are
        left out, else 0 for those that are.
    times : array of shape (K,), optional
        Times in seconds of sampled velocities.
    chwa_rotation : array of shape (3,) or (K, 3), or function of time, optional
        In place of w_c, the w = -w_c of papers with X' = [w]x X + v_p - v_c (Chwa 2019, (3)).

    Returns
    -------
    Motion
        With A = -[w_c]x and b = v_p - v_c, and the parameters w_c1, w_c2, ... v_p3.

    Raises
    ------
    ValueError
        If shapes do not match, values are not finite, times do not increase, or w_c is given twice.

    See Also
    --------
    affine, linear : Other motions.

    Examples
    --------
    >>> from percept_obs import rigid
    >>> rigid(camera_angular_velocity=[0, 0.2, 0]).known(0)[0, :3].tolist()
    [0.0, 0.2, 0.0]
    >>> rigid(chwa_rotation=[0, 0.2, 0]).known(0)[0, :3].tolist()
    [0.0, -0.2, 0.0]
    """
    if chwa_rotation is not None:
        if camera_angular_velocity is not None:
            raise ValueError("chwa_rotation is minus camera_angular_velocity; give one of the two")
        camera_angular_velocity = _minus(chwa_rotation)
    w_c, v_c, v_p = (sp.ImmutableMatrix(sp.symbols(f"{n}1:4", real=True)) for n in ("w_c", "v_c", "v_p"))
    velocities = at_rest_if_left_out(camera_angular_velocity, camera_velocity, point_velocity)
    return bound("rigid", cross(-w_c), v_p - v_c, list(zip(velocities, (w_c, v_c, v_p), strict=True)), times)


def at_rest_if_left_out(*velocities: Any) -> tuple[Any, ...]:
    """Velocities with 0 for those that are None, unless all are."""
    given = any(value is not None for value in velocities)
    return tuple(np.zeros(3) if given and value is None else value for value in velocities)


def _minus(value: Any) -> Any:
    """Minus a coefficient."""
    if callable(value):
        return wraps(value)(lambda time: 0 - np.asarray(value(time)))
    return 0 - np.asarray(value, dtype=float if are_numbers(value) else object)


def cross(w: sp.ImmutableMatrix) -> sp.ImmutableMatrix:
    """Matrix [w]x of the cross product w x X."""
    return sp.ImmutableMatrix([[0, -w[2], w[1]], [w[2], 0, -w[0]], [-w[1], w[0], 0]])


@checked
def linear(
    A: Coefficients | None = None,
    v: Coefficients | None = None,
    states: int | None = None,
    times: Times | None = None,
) -> Motion:
    """Return the linear motion x' = A(t) x + v(t) of a state with n entries (Inaba et al. 2005, (1)).

    Coefficients that are given as arrays and are 0 at all times stay out of its parameters.

    Parameters
    ----------
    A : array of shape (n, n) or (K, n, n), function of time, or sympy expressions, optional
        Coefficients in 1/s; symbols when left out.
    v : array of shape (n,) or (K, n), function of time, or sympy expressions, optional
        Input in m/s; symbols when left out.
    states : int, optional
        Number n of entries; needed where neither array shows it.
    times : array of shape (K,), optional
        Times in seconds of sampled coefficients.

    Returns
    -------
    Motion
        With A of shape (n, n) and b = v of shape (n, 1).

    Raises
    ------
    ValueError
        If shapes do not match, n is not known, values are not finite or times do not increase.

    See Also
    --------
    affine : Of a point in space.

    Examples
    --------
    >>> from percept_obs import linear
    >>> motion = linear([[0.0, 1.0], [0.0, 0.0]], [0.0, 0.5])
    >>> motion.values
    {a12: 1.0, v2: 0.5}
    """
    shown = [np.shape(value)[-1] for value in (A, v) if value is not None and not callable(value) and np.ndim(value)]
    n = states if states is not None else (shown or [0])[0]
    if n < 1:
        raise ValueError(f"the linear motion has {n} states, or nothing shows how many; pass states=, at least 1")
    different = [size for size in shown if states is not None and size != n]
    if different:
        raise ValueError(f"{n} states were asked for, but A or v has {different[0]}; give both for the same states")
    limit(n * n, f"entries of A for {n} states", "describe fewer states", MOST_TERMS)
    separator = "_" if n > 9 else ""
    A_symbols = sp.ImmutableMatrix(n, n, lambda i, j: sp.Symbol(f"a{i + 1}{separator}{j + 1}", real=True))
    v_symbols = sp.ImmutableMatrix(sp.symbols(f"v1:{n + 1}", real=True))
    motion = bound("linear", A_symbols, v_symbols, [(A, A_symbols), (v, v_symbols)], times)
    if motion.signal is None or callable(motion.signal.samples):
        return motion
    used = (motion.signal.samples != 0).any(axis=0).tolist()
    zero = {s: sp.S.Zero for s, u in zip(motion.parameters, used, strict=True) if not u}
    left = tuple(s for s in motion.parameters if s not in zero)
    signal = Signal(motion.signal.samples[:, used], motion.signal.times)
    return Motion("linear", motion.A.xreplace(zero), motion.b.xreplace(zero), left, signal)


def bound(
    name: str, A: sp.ImmutableMatrix, b: sp.ImmutableMatrix, coefficients: list[Coefficient], times: Times | None
) -> Motion:
    """Motion with values for the symbols of A and b.

    Values of each block of symbols are as `affine` takes them: arrays, functions of time, expressions (in `TIME` or
    others), or None for all; the times are those of sampled values.
    """
    values, symbols = [value for value, _ in coefficients], tuple(s for _, block in coefficients for s in block)
    missing = [_title(block) for value, block in coefficients if value is None]
    symbolic, moving = any(map(_has_symbols, values)), any(map(callable, values))
    if times is not None and (symbolic or moving or len(missing) == len(values)):
        raise ValueError("times are those of samples, and the motion has none; leave times out, or give arrays")
    if len(missing) == len(coefficients):
        return Motion(name, A, b, symbols)
    if missing:
        raise ValueError(
            f"{with_article(name)} motion takes all of its coefficients or none; give also {', '.join(missing)}"
        )
    if symbolic:
        entries = [e for value, block in coefficients for e in matrix(value, _title(block), *block.shape)]
        A, b = (each.xreplace(dict(zip(symbols, entries, strict=True))) for each in (A, b))
        free = tuple(sorted(A.free_symbols | b.free_symbols, key=str))
        at = OverTime(Chain(np.atleast_2d, np.transpose), partial(breaks_of, TIME, (*A, *b)))
        return Motion(name, A, b, free, Signal(at) if free == (TIME,) else None)
    if moving:
        functions = [_function(value, block) for value, block in coefficients]
        return Motion(name, A, b, symbols, Signal(OverTime(partial(_side_by_side, functions))))
    times = None if times is None else np.atleast_1d(np.asarray(times, dtype=float))
    if times is not None and not times.size:
        raise ValueError("the times of the motion are empty; give one for each sample, or leave times out")
    if times is not None and all(np.shape(value) == _shape(block) for value, block in coefficients):
        raise ValueError("times are those of samples, and the motion is constant; leave times out, or give arrays")
    count = 0 if times is None else len(times)
    motion = Motion(name, A, b, symbols, Signal(np.hstack([_rows(*each, count) for each in coefficients]), times))
    ask_for_degrees(motion, 0.0 if times is None else times)
    return motion


class AreTheseDegrees(UserWarning):
    """An angular velocity is so large that it may be in degrees."""


LARGEST_TURNING = 20.0
"""Angular velocity in rad/s, three turns a second, above which degrees may have been meant."""


def coefficients(motion: Motion, known: Array) -> tuple[Array, Array]:
    """Return A and b, shapes (T, 3, 3) and (T, 3), for values of the motion's parameters, shape (T, p)."""
    columns = known.T if known.shape[1] else [np.zeros(len(known))]
    symbols = motion.parameters or (TIME,)
    rows = np.stack(vectorised(symbols, (*motion.A, *motion.b))(*columns), axis=-1)
    return rows[:, :9].reshape(-1, 3, 3), rows[:, 9:]


def ask_for_degrees(motion: Motion, times: Times) -> None:
    """Warn of an angular velocity of three states, such as those of a point, that may be in degrees."""
    A = motion.A
    if A.shape[0] < 3 or motion.signal is None:
        return
    blocks = dict.fromkeys(A[k : k + 3, k : k + 3] for k in range(0, A.shape[0] - 2, 3))
    spin = [(block[i, j] - block[j, i]) / 2 for block in blocks for i, j in ((2, 1), (0, 2), (1, 0))]
    turning = np.stack(vectorised(motion.parameters, spin)(*motion.known(times).T), axis=-1).reshape(-1, 3)
    fastest = float(np.linalg.norm(turning, axis=-1).max(initial=0)) if motion.parameters else 0.0
    if fastest > LARGEST_TURNING:
        warn(
            AreTheseDegrees(
                f"the {motion.name} motion turns with {fastest:.3g} rad/s, {fastest / (2 * np.pi):.2g} turns a second; "
                "were degrees meant?  Then pass np.radians(...) of them"
            )
        )


def _function(value: ArrayLike | Callable[[float], ArrayLike], block: sp.ImmutableMatrix) -> Callable[[Array], Array]:
    """One coefficient as a function of times, shape (T, entries); its values are checked once for all times."""
    if not callable(value):
        return Chain(len, partial(np.repeat, _rows(value, block), axis=0))
    try:
        signature(value).bind(0.0)
    except TypeError as error:
        raise ValueError(f"{_title(block)} must be a function of a time alone: {error}") from None
    except ValueError:  # some functions do not tell their arguments
        pass
    return partial(_values, value, block)


def _values(function: Callable[[float], ArrayLike], block: sp.ImmutableMatrix, times: Array) -> Array:
    found = [function(time) for time in times.tolist()]
    if all(type(each) in (list, tuple, np.ndarray) for each in found) and are_numbers(found):
        array = np.asarray(found, dtype=float)
        if array.shape == (len(times), *_shape(block)) and np.isfinite(array).all():
            return array.reshape(len(times), -1)
    return np.concatenate([_rows(each, block) for each in found])


def _side_by_side(functions: Sequence[Callable[[Array], Array]], times: Array) -> Array:
    return np.hstack([rows(times) for rows in functions])


def _rows(value: ArrayLike, block: sp.ImmutableMatrix, count: int = 0) -> Array:
    """One coefficient as rows, shape (count, entries), repeated if it is constant; a constant alone without a count."""
    array = numbers(value, "a coefficient of the motion")
    shape = _shape(block)
    if array.shape == block.shape:  # a column
        array = array.reshape(shape)
    if array.shape not in (shape, (count, *shape) if count else shape):
        sampled = f" or {(count, *shape)}" if count else "; samples need times=" if array.shape[1:] == shape else ""
        raise ValueError(f"{_title(block)} has shape {array.shape}; expected {shape}{sampled}")
    if not np.isfinite(array).all():
        raise ValueError(f"{_title(block)} is not finite; remove or repair the NaN or infinite entries")
    rows = array.reshape(-1, len(block))
    return np.repeat(rows, count, axis=0) if len(rows) < count else rows


def _title(block: sp.ImmutableMatrix) -> str:
    """Name in messages of the argument that a block of symbols stands for."""
    first, last = block[0].name, block[len(block) - 1].name
    names = {"a": "A", "b": "b", "v": "v", "w": "angular_velocity", "v_c": "camera_velocity", "v_p": "point_velocity"}
    names |= {"w_c": "camera_angular_velocity", "w_b": "body_angular_velocity", "a_x": "acceleration"}
    name = "specific_force" if first == "a1" else names.get(first.rstrip("0123456789_"), "a coefficient")
    return f"the motion's {name} ({first} ... {last})"


def _shape(block: sp.ImmutableMatrix) -> tuple[int, ...]:
    """Shape of a coefficient's array; a column is a vector."""
    rows, columns = block.shape
    return (rows, columns) if columns > 1 else (rows,)


def _has_symbols(value: object) -> bool:
    if callable(value):
        return False
    return any(isinstance(e, sp.Basic) and e.free_symbols for e in np.asarray(value, dtype=object).ravel())
