"""Observers: equations, gains, a start, and an estimate."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import sympy as sp
from sympy.solvers.solveset import NonlinearError

from percept_obs.compile import Array, at_once, right_hand_side
from percept_obs.compile.equations import Equations, Expressions, Symbols
from percept_obs.observers.gains import Gain
from percept_obs.observers.inversion import Unobservable
from percept_obs.observers.parts import first_seen, hats
from percept_obs.system.forms import PartitionedSystem
from percept_obs.system.motion import Motion
from percept_obs.validation import checked


@dataclass(frozen=True)
class About:
    """Title, source and claim of an observer.

    Parameters
    ----------
    title : str
        Full name.
    source : str
        Author and year, and equations.
    needs : str
        Outputs that must be measured.
    claim : str
        Claim about its convergence, and the condition for it.

    See Also
    --------
    Family : Holds it.

    Examples
    --------
    >>> from percept_obs import ibo
    >>> ibo.about.title
    'Identifier-based observer (IBO)'
    >>> ibo.about.needs
    'any outputs with a canonical form'
    """

    title: str
    source: str
    needs: str
    claim: str


@dataclass(frozen=True)
class FastestRate:
    """Decay rate in 1/s of an observer's fastest part, which an integration step must resolve.

    It depends on the gains and `elapsed`; the remedy is advice besides a shorter step.
    """

    rate: sp.Expr
    remedy: str


@checked
@dataclass(frozen=True)
class Observer:
    """Observer of a system with measured and hidden coordinates, as equations.

    Parameters
    ----------
    name : str
        In tables and messages.
    form : PartitionedSystem
        The system; a canonical form where the observer needs one.
    equations : Equations
        Flow, measurement update, reset condition and reset of the observer's state.
    estimate : tuple of expressions
        Estimates of ``form.coordinates``, from the state, the measured outputs, the parameters and the gains.
    gains : tuple of Gain
        Numbers of the equations.
    start : tuple of expressions
        The state at the first sample, from that sample, the wanted estimates (`hats`), flags of those that are the
        sample itself (`first_seen`), parameters and gains.
    covariance : matrix of expressions, optional
        Covariance of the estimate, from the state, if the observer claims one.
    about : About, optional
        Its title, source, needs and claim.
    constant_motion : bool
        True if the equations hold for a motion with constant coefficients only.
    unobservable : tuple of Unobservable
        Where the hidden coordinates have no estimate; of several that hold, the first gives the reason.
    fastest : FastestRate, optional
        Limit of the integration step, if it is known.

    Raises
    ------
    ValueError
        If estimate, start or covariance has another size, or there are strange symbols, or a gain is missing.

    See Also
    --------
    track : Lets it follow a recording.
    percept_obs.observers.Family : Makes observers of one kind.

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, ibo, pinhole
    >>> observer = ibo(PerspectiveSystem(affine(), pinhole()))
    >>> observer.equations.state
    (yhat1, yhat2, yhat3)
    >>> observer.with_gains(gain=4).gain_values
    {G: 4.0, A: 1.0, P: -0.5, M: 10.0, gamma: 1.01, sigma^2: 0.0}
    """

    name: str
    form: PartitionedSystem
    equations: Equations
    estimate: tuple[sp.Expr, ...]
    gains: tuple[Gain, ...]
    start: tuple[sp.Expr, ...]
    covariance: sp.ImmutableMatrix | None = None
    about: About | None = None
    constant_motion: bool = False
    unobservable: tuple[Unobservable, ...] = ()
    fastest: FastestRate | None = None

    def __post_init__(self) -> None:
        _refuse_strangers(self.name, self.form, self.equations, self.estimate, self.start)
        if self.covariance is not None and self.covariance.rows != len(self.estimate):
            raise ValueError(f"the covariance has the shape {self.covariance.shape}; expected a row a coordinate")
        if missing := set(self.equations.gains) - set(self.gain_values):
            raise ValueError(f"the {self.name} observer has no Gain for {', '.join(sorted(map(str, missing)))}")

    def with_gains(self, **values: Any) -> Observer:
        """Observer with other gains, all in range; nothing is compiled again."""
        known = [gain.name for gain in self.gains]
        unknown = sorted(set(values) - set(known))
        if unknown:
            raise ValueError(f"the {self.name} observer has no gain {', '.join(unknown)}; it has {', '.join(known)}")
        return replace(
            self,
            gains=tuple(replace(g, value=values[g.name], given=True) if g.name in values else g for g in self.gains),
        )

    def suited_to(self, variance: float | None) -> Observer:
        """Filter with a recording's variance of noise, unless a `noise_variance` was given; others as they are."""
        asks = [g.name == "noise_variance" and not g.given for g in self.gains]
        if not (variance and self.equations.update and any(asks)):
            return self
        pairs = zip(self.gains, asks, strict=True)
        return replace(self, gains=tuple(replace(g, value=variance) if asked else g for g, asked in pairs))

    @property
    def gain_values(self) -> dict[sp.Symbol, float]:
        """Numbers of the gains by their letters."""
        return {gain.symbol: gain.value for gain in self.gains}

    @property
    def error(self) -> tuple[sp.Symbol, ...]:
        """Symbols e1, e2, ... of the estimation errors, numbered like the coordinates."""
        return sp.symbols(f"e1:{len(self.form.coordinates) + 1}", real=True)

    def error_dynamics(self) -> sp.ImmutableMatrix:
        """Return the time derivative of the error e = x - xhat between samples and resets, shape (n, 1).

        It is in terms of the true coordinates and the error, in the order of ``form.coordinates``.

        Raises
        ------
        ValueError
            If the estimate is not linear in the state, so that it cannot be solved for it.
        """
        form, state = self.form, self.equations.state
        truth = sp.ImmutableMatrix(form.coordinates)
        rates = dict(zip((*form.x1, *form.x2), form.rate, strict=True))
        estimate = sp.ImmutableMatrix(self.estimate)
        estimate_rate = estimate.jacobian(state) * sp.ImmutableMatrix(self.equations.flow)
        estimate_rate += estimate.jacobian(form.x1) * sp.ImmutableMatrix([rates[x] for x in form.x1])
        error_rate = sp.ImmutableMatrix([rates[x] for x in form.coordinates]) - estimate_rate
        misses = [m for m in estimate - truth + sp.ImmutableMatrix(self.error) if m.free_symbols & set(state)]
        solved = [symbol for symbol in state if any(m.has(symbol) for m in misses)]
        try:
            (values,) = sp.linsolve(misses, solved)
        except NonlinearError:
            raise ValueError(
                f"the estimate of the {self.name} observer cannot be solved for its state, so that its error has no "
                "dynamics of its own; look at the equations of the state instead"
            ) from None
        return error_rate.subs(dict(zip(solved, values, strict=True)), simultaneous=True).expand()

    def jacobian(self) -> sp.ImmutableMatrix:
        """Derivative of the flow with respect to the observer's state."""
        return sp.ImmutableMatrix(self.equations.flow).jacobian(self.equations.state)

    def initial_state(
        self,
        outputs: Mapping[str, float],
        start: Mapping[str, float],
        parameters: Mapping[sp.Symbol, float] | None = None,
    ) -> Array:
        """State at the first sample.

        Parameters
        ----------
        outputs : mapping of names of measured outputs to their first samples
        start : mapping of coordinate names to estimates; left out, the first samples and 0 for hidden coordinates
        parameters : mapping of the form's parameters to their values at the first sample, where the start needs them

        Raises
        ------
        ValueError
            If a name is unknown, a value is not finite, or a parameter is missing.
        """
        return state_at_start(self, outputs, start, (parameters or {}).items())

    def lambdify(
        self, motion: Motion, measured: Callable[[float], Sequence[float]] | None = None
    ) -> Callable[[float, Sequence[float]], list[float]]:
        """Return the flow as a function of (t, state), for scipy's solvers; resets are left to the caller.

        Parameters
        ----------
        motion : Motion
            Known motion, with numbers.
        measured : function of a time, optional
            Measured outputs; not needed where the equations use none, as with `with_point`.

        Raises
        ------
        ValueError
            If measured outputs are needed, or the motion has no numbers or is not of the form's kind.
        """
        if self.form.parameters != (*motion.parameters, *self.form.values):
            raise ValueError(f"the {self.name} observer is of a form with {self.form.parameters}; give such a motion")
        if self.equations.measured and measured is None:
            outputs = ", ".join(map(str, self.equations.measured))
            raise ValueError(f"the {self.name} observer uses {outputs}; pass measured=, a function of time")
        flow = right_hand_side(self.equations, {**self.form.values, **self.gain_values, **motion.values})
        constant = motion.signal is not None and motion.signal.constant
        return lambda t, state: flow(state, measured(t) if measured else (), () if constant else motion.known(t)[0])

    def _repr_latex_(self) -> str:
        """Equations without the terms that gains of 0 remove."""
        removed = {symbol: sp.S.Zero for symbol, value in self.gain_values.items() if value == 0}
        return self.equations.xreplace(removed)._repr_latex_()


@lru_cache(maxsize=512)  # gains change often, and these never
def _refuse_strangers(
    name: str, form: PartitionedSystem, equations: Equations, estimate: Expressions, start: Expressions
) -> None:
    """Refuse an estimate and a start of other lengths than needed, or in symbols that nothing provides."""
    known = {*form.x1, *form.parameters, *equations.gains}
    if others := {*equations.measured, *equations.parameters} - known:
        raise ValueError(f"the {name} observer's equations use {others}, which its form has not; derive them from it")
    asked = {*hats(form.coordinates), *first_seen(form.x1)}
    for part, entries, length, given, remedy in (
        ("estimate", estimate, len(form.coordinates), {*equations.state}, "pass estimate="),
        ("start", start, len(equations.state), asked, "pass start="),
    ):
        strange = sorted(map(str, sp.Tuple(*entries).free_symbols - known - given))
        if strange or len(entries) != length:
            problem = f"uses {', '.join(strange)}, which nothing provides" if strange else f"has {len(entries)} entries"
            raise ValueError(
                f"the {part} of the {name} observer {problem}; {remedy}: {length} entries in measured outputs, "
                f"parameters, gains and {', '.join(sorted(map(str, given)))}"
            )


def state_at_start(
    observer: Observer,
    outputs: Mapping[str, float],
    start: Mapping[str, float],
    parameters: Iterable[tuple[sp.Symbol, float]],
) -> Array:
    """`Observer.initial_state` without a check of the arguments' kinds."""
    form = observer.form
    names = [symbol.name for symbol in form.coordinates]
    wrong = [name for name, value in start.items() if name not in names or not math.isfinite(value)]
    if wrong:
        raise ValueError(f"the start has no finite value for {', '.join(wrong)}; give estimates of {', '.join(names)}")
    unseen = [name for name in form.measured if not math.isfinite(outputs.get(name, math.nan))]
    if unseen:
        raise ValueError(f"the outputs have no finite value for {', '.join(unseen)}; give one for each measured output")
    asked = dict.fromkeys(names, 0.0) | dict(outputs) | dict(start)
    values = [*map(asked.__getitem__, names), *(float(name not in start) for name in form.measured)]
    known, others = _symbols_of_start(observer.start, form.coordinates, form.x1)
    if others:
        found = {symbol: outputs[symbol.name] for symbol in form.x1} | observer.gain_values | dict(parameters)
        missing = [str(symbol) for symbol in others if symbol not in found]
        if missing:
            raise ValueError(f"the start of the {observer.name} observer needs {', '.join(missing)}; pass parameters=")
        values += [found[symbol] for symbol in others]
    return at_once(known, observer.start, values)


@lru_cache(maxsize=512)
def _symbols_of_start(start: Expressions, coordinates: Symbols, x1: Symbols) -> tuple[Symbols, Symbols]:
    """All symbols of a start (wanted estimates, flags of first samples, others), and the others alone."""
    own = (*hats(coordinates), *first_seen(x1))
    others = tuple(sorted(sp.Tuple(*start).free_symbols - set(own), key=str))
    return (*own, *others), others


@checked
def with_point(observer: Observer) -> Observer:
    """Return observer and observed point joined, with the state (x1, x2, observer's state).

    Its equations need no samples, for the point's own rates take their place.

    Parameters
    ----------
    observer : Observer
        Of the point.

    Returns
    -------
    Observer
        With n coordinates more in its state.

    Raises
    ------
    ValueError
        If an argument is of another kind, or the observer has its point already.

    See Also
    --------
    percept_obs.studies.chatter.effort : Integrates both together.

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, ibo, pinhole, with_point
    >>> observer = ibo(PerspectiveSystem(affine(), pinhole()))
    >>> with_point(observer).equations.state
    (y1, y2, y3, yhat1, yhat2, yhat3)
    """
    form, eq = observer.form, observer.equations
    point = (*form.x1, *form.x2)
    if set(point) & set(eq.state):
        raise ValueError(f"the {observer.name} observer has its point already; take it as it is")
    reset = (*point, *eq.reset) if eq.reset else ()
    flow = (*form.rate, *eq.flow)
    together = replace(eq, state=(*point, *eq.state), flow=flow, measured=(), update=(), reset=reset)
    start = (*hats(point), *observer.start)  # the point as it is wanted
    return replace(observer, name=f"{observer.name} with its point", equations=together, start=start)
