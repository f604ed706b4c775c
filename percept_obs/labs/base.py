"""What every lab shares: the page's bundle, state in traitlets, errors that show, formulas with linked letters."""

from __future__ import annotations

import re
import weakref
from collections.abc import Iterable, Mapping
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import anywidget
import numpy as np
import sympy as sp
import traitlets

from percept_obs.compile import function_source, source, vectorised
from percept_obs.equations import Equations
from percept_obs.forms import CanonicalForm, NotAffine
from percept_obs.motion import affine
from percept_obs.observability import instantaneous
from percept_obs.observers import Gain, Observer, extended_kalman, identifier_based, sliding_mode
from percept_obs.observers.base import hats
from percept_obs.perspective import PerspectiveSystem
from percept_obs.recording import Recording
from percept_obs.surfaces import POINT, chained, pinhole, plane

BUNDLE = Path(__file__).with_name("front") / "lab.js"
"""The page's side of all labs, built from ``front/src`` by ``npm run build``."""

Settings = dict[str, Any]
Structure = tuple[str, tuple[str, ...], str]
"""Names of a surface, of the measured outputs, and of an observer."""

SURFACES = {"pinhole": pinhole, "chained": chained, "plane": plane}
OUTPUTS = (("y1", "y2"), ("y1",), ("y2",))
BY_NAME = {make.__name__: make for make in (identifier_based, sliding_mode, extended_kalman)}
MOTION = affine()


class BadSettings(traitlets.TraitError, ValueError):
    """Settings that make no sense; as a TraitError, so that traitlets takes back what came with them."""


class Lab(anywidget.AnyWidget):
    """A widget whose page computes by itself from a model that it is handed once.

    The page sends `settings` and `summary` together when the hand rests; Python answers with `analysis`.
    Nothing is sent as a message of its own, so that a busy kernel skips to the latest state.

    Parameters
    ----------
    kind : str
        Which of the bundle's labs the page is to show.
    model : dict
        What the page needs to know, handed over once.
    settings : dict
        Everything that defines what is shown.
    """

    _esm = BUNDLE
    kind = traitlets.Unicode().tag(sync=True)
    model = traitlets.Dict().tag(sync=True)
    settings = traitlets.Dict().tag(sync=True)
    summary = traitlets.Dict(help="What the page found: verdicts, numbers at some times.").tag(sync=True)
    analysis = traitlets.Dict(help="What Python adds to it when the hand rests.").tag(sync=True)
    error = traitlets.Unicode(help="What went wrong in Python; the page shows it.").tag(sync=True)

    def __init__(self, kind: str, model: Settings, settings: Settings) -> None:
        super().__init__(kind=kind, model=model, settings=settings)
        _close_those_of_an_earlier_run(self)

    def check(self, settings: Settings) -> Settings:
        """Complete settings, or a ValueError that says what is wrong; a lab overrides it."""
        return settings

    def analyse(self, summary: Settings) -> Settings:
        """Look deeper at the settings that the page has come to rest on; a lab overrides it."""
        return {}

    def set_state(self, sync_data: dict[str, Any]) -> None:
        """Take the page's state; what goes wrong is shown in the lab and raised for the log."""
        try:
            super().set_state(sync_data)
        except Exception as error:
            self.error = f"{type(error).__name__}: {error}"
            raise
        if self.error and "summary" in sync_data:
            self.error = ""

    @traitlets.validate("settings")
    def _complete(self, proposal: Mapping[str, Any]) -> Settings:
        try:
            return self.check(proposal["value"])
        except ValueError as error:
            raise BadSettings(str(error)) from None

    @traitlets.observe("summary")
    def _deepen(self, change: Mapping[str, Any]) -> None:
        if change["new"]:
            self.analysis = {"of": change["new"].get("serial"), **self.analyse(change["new"])}


_open: dict[str, tuple[str, list[weakref.ref[Lab]]]] = {}


def _close_those_of_an_earlier_run(lab: Lab) -> None:
    """Close the labs that the same cell made when it ran before; several of one run stay."""
    cell, run = _running_cell()
    if not cell:
        return
    last, labs = _open.get(cell, (run, []))
    if last != run:
        for earlier in filter(None, (reference() for reference in labs)):
            earlier.close()
        labs = []
    _open[cell] = (run, [*labs, weakref.ref(lab)])


def _running_cell() -> tuple[str, str]:
    """Names of the cell that is running and of this run of it; empty outside a notebook."""
    from IPython import get_ipython

    shell = get_ipython()
    parent = shell.get_parent() if hasattr(shell, "get_parent") else {}
    return parent.get("metadata", {}).get("cellId", ""), parent.get("header", {}).get("msg_id", "")


def formula(left: object, right: object, letters: Mapping[str, sp.Symbol] | None = None) -> str:
    """The equation ``left = right`` as MathML, in which letters carry the names of what sets them.

    Parameters
    ----------
    left, right : sympy objects, or MathML text
    letters : mapping of names to symbols, optional
        The page highlights a letter, and puts its number in, by its name.
    """
    sides = [side if isinstance(side, str) else markup(side, letters) for side in (left, right)]
    return f"<mrow>{sides[0]}<mo>=</mo>{sides[1]}</mrow>"


def markup(expression: object, letters: Mapping[str, sp.Symbol] | None = None) -> str:
    """MathML of an expression, with hats, and with the letters marked by name."""
    text = _mathml(expression)
    text = re.sub(r"<mi>(\w+?)hat</mi>", r'<mover accent="true"><mi>\1</mi><mo>^</mo></mover>', text)
    text = text.replace("<mi>phi</mi>", "<mi>φ</mi>")
    # Browsers stretch brackets only with a mathematical font, so the page draws those of a matrix as borders.
    text = text.replace("<mo>[</mo><mtable>", '<mtable class="matrix">').replace("</mtable><mo>]</mo>", "</mtable>")
    names = {_mathml(symbol): name for name, symbol in (letters or {}).items()}
    if not names:
        return text
    # The longest first, for the markup of alpha is a part of that of alpha1.
    pattern = "|".join(re.escape(letter) for letter in sorted(names, key=len, reverse=True))
    return re.sub(pattern, lambda found: f'<mrow data-letter="{names[found[0]]}">{found[0]}</mrow>', text)


def dotted(symbol: sp.Symbol) -> str:
    """MathML of a symbol's time derivative."""
    return f'<mover accent="true"><mrow>{markup(symbol)}</mrow><mo>˙</mo></mover>'


def _mathml(expression: object) -> str:
    if isinstance(expression, sp.Piecewise):
        cases = [(_mathml(value), "" if when == sp.true else _mathml(when)) for value, when in expression.args]
        rows = [
            f"<mtr><mtd>{value}</mtd><mtd><mtext>{'if' if when else 'otherwise'}&nbsp;</mtext>{when}</mtd></mtr>"
            for value, when in cases
        ]
        return f'<mtable class="cases">{"".join(rows)}</mtable>'
    return re.sub(r"\s*\n\s*", "", str(sp.mathml(expression, printer="presentation")))


def model_for_the_page() -> Settings:
    """What the page needs to simulate and to observe: the point's loop, the surfaces, the observers."""
    rate = MOTION.A * sp.ImmutableMatrix(POINT) + MOTION.b
    return {
        "plant": source(Equations(POINT, tuple(rate), (), MOTION.parameters), "javascript"),
        "surfaces": {name: surface_for_the_page(name) for name in SURFACES},
        "observers": {name: observer_for_the_page(name) for name in BY_NAME},
    }


@lru_cache
def form_of(surface: str, outputs: tuple[str, ...]) -> CanonicalForm:
    """The canonical form of affine motion on a surface."""
    return PerspectiveSystem(MOTION, SURFACES[surface]()).measure(*outputs)


@lru_cache
def observer_of(surface: str, outputs: tuple[str, ...], name: str) -> Observer:
    """An observer with its default gains."""
    return BY_NAME[name](form_of(surface, outputs))


@lru_cache
def surface_for_the_page(name: str) -> Settings:
    """What the page needs to know of a surface: texts of its functions, and every structure on it."""
    surface = SURFACES[name]()
    system = PerspectiveSystem(MOTION, surface)
    shape, image = surface.parameters, surface.image_coordinates
    return {
        "coordinates": [s.name for s in surface.coordinates],
        "shape": [s.name for s in shape],
        "project": function_source((*POINT, *shape), (*surface.image, surface.distance)),
        "ray": function_source((*image, *shape), surface.ray),
        "foe": function_source((*system.parameters,), tuple(system.foe)),
        "structures": {"+".join(o): s for o in OUTPUTS if (s := _structure_for_the_page(name, o))},
    }


def _structure_for_the_page(surface: str, outputs: tuple[str, ...]) -> Settings | None:
    try:
        form = form_of(surface, outputs)
    except NotAffine:
        return None
    names = [s.name for s in form.coordinates]
    letters = {s.name: s for s in form.parameters}
    threshold = sp.Symbol("threshold", real=True)
    instant = instantaneous(form)
    try:
        centre, radius = instant.circle(threshold)
        circle = function_source((*form.parameters, threshold), (*centre, radius))
    except ValueError:
        circle = None
    return {
        "measured": [names.index(s.name) for s in form.x1],
        "hidden": [names.index(s.name) for s in form.x2],
        "w": function_source((*form.x1, *form.parameters), tuple(form.w)),
        "suffices": instant.suffices,
        "circle": circle,
        "formulas": [
            formula(f"<msup>{markup(sp.Symbol('w'))}<mi>T</mi></msup>", form.w.T, letters),
            formula(sp.Symbol("phi"), form.phi, letters),
            formula(sp.Symbol("g"), form.g, letters),
        ],
        "observers": {name: _kernel_for_the_page(surface, outputs, name) for name in BY_NAME},
    }


def _kernel_for_the_page(surface: str, outputs: tuple[str, ...], name: str) -> Settings:
    observer = observer_of(surface, outputs, name)
    form, equations = observer.form, observer.equations
    claimed = observer.covariance
    own = dict.fromkeys(hats(form.x2), sp.S.Zero) | dict(zip(hats(form.x1), form.x1, strict=True))
    own_start = tuple(entry.xreplace(own) for entry in observer.start)
    return {
        "run": source(equations, "javascript"),
        "states": len(equations.state),
        "start": function_source((*form.x1, *equations.gains), own_start),
        "estimate": function_source((*equations.state, *form.x1), observer.estimate),
        "stateOf": [equations.state.index(hat) for hat in observer.estimate],
        "variances": claimed and function_source(equations.state, tuple(claimed[i, i] for i in range(claimed.rows))),
    }


@lru_cache
def observer_for_the_page(name: str) -> Settings:
    """An observer's gains, and its equations for functions w, phi and g of the lecture's letters."""
    x1, x2 = sp.symbols("x1 x2", real=True)
    w, phi, g = (
        sp.ImmutableMatrix([[sp.Function(f)(*of)]]) for f, of in (("w", (x1,)), ("phi", (x1,)), ("g", (x1, x2)))
    )
    observer = BY_NAME[name](CanonicalForm((x1,), (x2,), w, phi, g, (), (x1, x2)))
    equations = observer.equations
    letters = {gain.name: gain.symbol for gain in observer.gains}
    lines = [formula(dotted(s), rate, letters) for s, rate in zip(equations.state, equations.flow, strict=True)]
    for block in equations.update:
        lines += [formula(_after(s), new, letters) for s, new in zip(equations.state, block, strict=True)]
    if equations.reset:
        arrow = (
            "<mrow><mtext>when&nbsp;</mtext>"
            + markup(equations.reset_condition, letters)
            + "<mtext>:&nbsp;</mtext></mrow>"
        )
        changed = [(s, new) for s, new in zip(equations.state, equations.reset, strict=True) if s != new]
        lines += [f"<mrow>{arrow}{formula(_after(s), new, letters)}</mrow>" for s, new in changed]
    return {"title": observer.name, "gains": [_gain_for_the_page(gain) for gain in observer.gains], "formulas": lines}


def _after(symbol: sp.Symbol) -> str:
    return f"<msup><mrow>{markup(symbol)}</mrow><mo>+</mo></msup>"


def _gain_for_the_page(gain: Gain) -> Settings:
    return {
        "name": gain.name,
        "letter": markup(gain.symbol),
        "value": gain.value,
        "low": gain.low,
        "high": gain.high,
        "meaning": gain.meaning,
        "allowed": function_source((gain.symbol,), (sp.Piecewise((1, gain.condition), (0, True)),)),
        "condition": str(gain.condition) if gain.condition != sp.true else "",
    }


def track_for_the_page(recording: Recording) -> Settings:
    """A recording in numbers; a lost sample is null, since JSON knows no NaN."""
    signal = recording.motion.signal
    if signal is None or callable(signal.samples):
        raise ValueError(f"the motion of {recording.source!r} has no sampled numbers; bind it to numbers first")
    times = [0.0] if signal.times is None else signal.times.tolist()
    return {
        "names": recording.names,
        "time": recording.time.tolist(),
        "samples": [[None if np.isnan(v) else v for v in row] for row in recording.outputs.tolist()],
        "truth": None if recording.truth is None else recording.truth.tolist(),
        "motion": {"times": times, "rows": signal.samples.tolist()},
    }


def with_affine_motion(name: str, recording: Recording) -> Recording:
    """The same recording with the motion's A and b sampled, so that the lab's observers fit it."""
    motion, times = recording.motion, recording.time
    constant = motion.signal is not None and motion.signal.constant
    if motion.signal is not None and motion.signal.times is not None:
        inside = (motion.signal.times > times[0]) & (motion.signal.times < times[-1])
        times = np.unique(np.concatenate([times, motion.signal.times[inside]]))
    entries = vectorised(motion.parameters, [*motion.A, *motion.b])(*motion.known(times).T)
    rows = np.stack(entries, axis=-1)
    if not any(recording.surface.fits(SURFACES[kind]()) for kind in ("pinhole", "chained")):
        raise ValueError(f"the recording {name!r} was seen on the {recording.surface.name}; the lab knows the pinhole")
    A, b = rows[:, :9].reshape(-1, 3, 3), rows[:, 9:]
    return replace(recording, motion=affine(A[0], b[0]) if constant else affine(A, b, times))


def one_of(settings: Mapping[str, Any], key: str, known: Iterable[str]) -> str:
    """The value of a setting that must be one of the known ones."""
    value, names = settings[key], list(known)
    if value not in names:
        raise ValueError(f"{key} is {value!r}; it must be one of {', '.join(names)}")
    return str(value)


def number(settings: Mapping[str, Any], key: str, low: float, high: float) -> float:
    """The value of a setting that must be a number from low to high."""
    value = settings[key]
    fits = isinstance(value, int | float) and not isinstance(value, bool) and low <= value <= high
    if not fits:
        raise ValueError(f"{key} is {value!r}; it must be a number from {low:g} to {high:g}")
    return float(value)


def numbers(settings: Mapping[str, Any], key: str, shape: tuple[int, ...], bound: float = 1e3) -> None:
    """Refuse a setting that is not a block of numbers of this shape."""
    try:
        array = np.array(settings[key], dtype=float)
    except (TypeError, ValueError):
        array = np.array(np.nan)
    if array.shape != shape or not (np.abs(array) <= bound).all():
        raise ValueError(f"{key} is {settings[key]!r}; it must be {shape} numbers between -{bound:g} and {bound:g}")
