"""Families: each makes observers of one kind, and holds their title, gains and needs."""

import inspect
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

import sympy as sp
from sympy.logic.boolalg import Boolean

from percept_obs.compile.equations import Equations, Expressions, Symbols
from percept_obs.observers.base import About, FastestRate, Observer
from percept_obs.observers.gains import Gain
from percept_obs.observers.inversion import Unobservable
from percept_obs.observers.parts import hats
from percept_obs.system.forms import CanonicalForm, NotAffine, PartitionedSystem
from percept_obs.system.perspective import PerspectiveSystem
from percept_obs.validation import WrongKind, of_kind, set_fields


@dataclass(frozen=True)
class Option:
    """Keyword that shapes an observer's equations, besides the form and the gains, and its default.

    Parameters
    ----------
    name : str
        The keyword.
    value : object
        Its default.
    meaning : str
        Its effect, in a few words.
    choices : tuple of str
        Names that it may be; empty if it is anything of the default's kind.

    Raises
    ------
    ValueError
        If the default is none of the choices.

    See Also
    --------
    percept_obs.observers.Family : Holds options.
    percept_obs.observers.Gain : A number in the equations.

    Examples
    --------
    >>> from percept_obs.observers.family import Option
    >>> print(Option("switch", "sign", "What stands for the sign", ("sign", "fraction")))
    switch : "sign" or "fraction"
        What stands for the sign.  Default 'sign'.
    """

    name: str
    value: Any
    meaning: str
    choices: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if self.choices and self.value not in self.choices:
            raise ValueError(f"{self.name} is {self.value!r}, none of its choices {', '.join(map(repr, self.choices))}")

    def __str__(self) -> str:
        """Two lines of a docstring."""
        kind = " or ".join(f'"{value}"' for value in self.choices) or type(self.value).__name__
        return f"{self.name} : {kind}\n    {self.meaning}.  Default {self.value!r}."


@dataclass(frozen=True)
class Derived:
    """Parts of `Equations` and `Observer` that the function of a family derives from a form.

    By default `start` is the state, `estimate` the `hats` and `gains` those of the family; `estimate` and `covariance`
    are in the order (x1, x2).

    Parameters
    ----------
    state, flow : symbols, expressions
        The observer's state and its time derivative between samples.
    start : expressions, optional
        The state at the first sample, in terms of the `hats` of all coordinates.
    estimate : expressions, optional
        Estimates of all coordinates.
    update, reset
        See `Equations`; `reset` is the condition and the state after a reset.
    covariance : matrix of shape (n, n), optional
        That the observer claims.
    unobservable : tuple of Unobservable
        Where the estimate stands for nothing.
    fastest : FastestRate, optional
        Fastest rate of the equations in 1/s, which limits the step.
    gains : tuple of Gain

    See Also
    --------
    family : Makes a family of a function that returns it.

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, pinhole
    >>> from percept_obs.observers import de_luca
    >>> derived = de_luca.derive(PerspectiveSystem(affine(), pinhole()).measure("y1"))
    >>> derived.state, derived.reset
    ((yhat1, yhat2, yhat3), (False, ()))
    """

    state: Symbols
    flow: Expressions
    start: Expressions | None = None
    estimate: Expressions | None = None
    update: tuple[Expressions, ...] = ()
    reset: tuple[Boolean, Expressions] = (sp.false, ())
    covariance: sp.ImmutableMatrix | None = None
    unobservable: tuple[Unobservable, ...] = ()
    fastest: FastestRate | None = None
    gains: tuple[Gain, ...] = ()


@dataclass(frozen=True, eq=False, repr=False)
class Family:
    """Maker of observers of one kind: called with a form, options and gains, it returns an `Observer`.

    Made by `family`, the decorator of the function that derives the equations; its docstring gets lines on the gains.

    Parameters
    ----------
    derive : function of a form and the options
        Returns a `Derived`.
    about : About
    name : str
        Short name of its observers.
    gains : tuple of Gain
        With their default values.
    options : tuple of Option
    candidates : tuple of mappings of gains' names to values
        Gains to try on a camera that a hand carries at 0.1 to 0.5 m/s past points some metres away.
    any_form : bool
        True if it needs no canonical form.
    objection_of : function of a form, optional
        Further needs: the error to raise for this form, or None if there is an observer.
    constant_motion : bool
        True if the equations hold for a motion with constant coefficients only.
    stays_at_truth : bool
        True if it copies the system: started at the truth, without noise, it stays there.
    for_structure : bool
        True if the lab of structure and motion lists it; it lists integral sliding modes in three ways.

    See Also
    --------
    percept_obs.observers.family.family : The decorator that makes it.
    Observer : What it makes.

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, pinhole
    >>> from percept_obs.observers import rio
    >>> rio.name, rio.switches
    ('range identification', ('hyperbolic tangent', 'sign', 'fraction'))
    >>> rio.refusal(PerspectiveSystem(affine(), pinhole()).measure("y1"))
    'y2, y3 are hidden; measure every image coordinate, for the rates of y1 do not determine them at an instant'
    """

    derive: Callable[..., Derived]
    about: About
    name: str
    gains: tuple[Gain, ...]
    options: tuple[Option, ...] = ()
    candidates: tuple[Mapping[str, float], ...] = ({},)
    any_form: bool = False
    objection_of: Callable[[CanonicalForm], ValueError | None] | None = None
    constant_motion: bool = False
    stays_at_truth: bool = True
    for_structure: bool = False

    def __post_init__(self) -> None:
        for name, kind in (("name", str), ("gains", tuple[Gain, ...]), ("options", tuple[Option, ...])):
            of_kind("family", name, getattr(self, name), kind)
        names = {name: getattr(self.derive, name) for name in ("__name__", "__qualname__", "__module__")}
        set_fields(self, **names, __doc__=self._docstring(), __signature__=self._signature())

    @property
    def key(self) -> str:
        """Name of the function in Python, which tables and settings use."""
        return self.derive.__name__

    @property
    def switches(self) -> tuple[str, ...]:
        """Names of its ways to switch, its own first; none if it does not switch."""
        return next((option.choices for option in self.options if option.name == "switch"), ())

    def objection(self, form: PartitionedSystem) -> ValueError | None:
        """Error that a call with this form raises; None if there is an observer of it."""
        of_kind(self.key, "form", form, PartitionedSystem)
        if self.any_form:
            return None
        if form.culprits:
            return NotAffine(form.measured, form.culprits)
        return self.objection_of(form.canonical_form()) if self.objection_of else None

    def refusal(self, form: PartitionedSystem) -> str:
        """Reason why there is no observer of this form; empty if there is one."""
        return str(self.objection(form) or "")

    def __call__(self, form: PartitionedSystem | PerspectiveSystem, *options: Any, **chosen: Any) -> Observer:
        """Make an observer of this form.

        A `PerspectiveSystem` stands for its form with all image coordinates measured.

        Raises
        ------
        ValueError
            The `objection`, or if an option or a gain is refused.
        """
        of_kind(self.key, "form", form, PartitionedSystem | PerspectiveSystem)
        if isinstance(form, PerspectiveSystem):
            form = form.partition(*(symbol.name for symbol in form.surface.image_coordinates))
        objection = self.objection(form)
        if objection is not None:
            raise objection
        form = form if self.any_form else form.canonical_form()
        if len(options) > len(self.options):
            raise WrongKind(f"{self!r} takes {len(self.options)} options, not {len(options)}; name the gains")
        settings = {option.name: option.value for option in self.options}
        settings |= dict(zip(settings, options, strict=False))
        settings |= {name: chosen.pop(name) for name in settings if name in chosen}
        derived = self.derive(form, **settings)
        of_kind(self.key, "what it derives", derived, Derived)
        gains = derived.gains or self.gains
        x = (*form.x1, *form.x2)
        estimate, covariance = derived.estimate or hats(x), derived.covariance
        order = [x.index(coordinate) for coordinate in form.coordinates]
        known = (form.x1, form.parameters, tuple(gain.symbol for gain in gains))
        return Observer(
            self.name,
            form,
            Equations(derived.state, derived.flow, *known, derived.update, *derived.reset),
            tuple(estimate[k] for k in order),
            gains,
            derived.start or derived.state,
            covariance and covariance.extract(order, order),
            self.about,
            self.constant_motion,
            derived.unobservable,
            derived.fastest,
        ).with_gains(**chosen)

    def _signature(self) -> inspect.Signature:
        named, after = inspect.Parameter.POSITIONAL_OR_KEYWORD, inspect.Parameter.KEYWORD_ONLY
        options = [inspect.Parameter(option.name, named, default=option.value) for option in self.options]
        gains = [inspect.Parameter(gain.name, after, default=gain.value) for gain in self.gains]
        return inspect.Signature([inspect.Parameter("form", named), *options, *gains])

    def _docstring(self) -> str:
        text = inspect.getdoc(self.derive) or self.about.title
        head, *rest = re.split(r"\n\n(?=See Also\n|Notes\n)", text, maxsplit=1)
        form = f"form : PartitionedSystem, or PerspectiveSystem\n    System to observe; needed: {self.about.needs}."
        parameters = "\n".join(map(str, (form, *self.options, *self.gains)))
        errors = "ValueError\n    If `refusal` has a reason against this form, or a gain or an option is refused."
        if not self.any_form:
            errors = f"NotAffine\n    If there is no canonical form.\n{errors}"
        sections = {"Parameters": parameters, "Returns": "Observer\n    With these gains.", "Raises": errors}
        made = "".join(f"\n\n{title}\n{'-' * len(title)}\n{lines}" for title, lines in sections.items())
        return "\n\n".join([f"{head}{made}", *rest]) + "\n"

    def __repr__(self) -> str:
        return f"{self.key}{self._signature()}"

    def __reduce__(self) -> str:
        return self.key  # as a function, by its name


def family(*, title: str, source: str, needs: str, claim: str, **others: Any) -> Callable[..., Family]:
    """Decorator that makes a `Family` of the function that derives the equations.

    Parameters
    ----------
    title, source, needs, claim : str
        See `About`.
    **others
        See `Family`; `name` and `gains` are needed.

    Returns
    -------
    function of a function
        Takes the one that derives the equations from a form and returns the `Family`.

    See Also
    --------
    Derived : Returned by the decorated function.

    Examples
    --------
    >>> from percept_obs.observers.parts import innovation, output_injection
    >>> @family(name="plain", title="Plain", source="none", needs="nothing", claim="none", gains=())
    ... def plain(form):
    ...     return Derived(hats((*form.x1, *form.x2)), output_injection(form, innovation(form), 1, 1))
    >>> plain
    plain(form)
    """
    return partial(Family, about=About(title, source, needs, claim), **others)
