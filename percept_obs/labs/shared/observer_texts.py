"""Texts of a point that the page moves, and of an observer that it runs and shows: facts, gains, loop."""

from collections.abc import Mapping
from typing import Any

import sympy as sp

from percept_obs.compile import function_source, source
from percept_obs.labs.shared.markup import markup
from percept_obs.labs.shared.printed import Texts
from percept_obs.observers import Gain, Observer
from percept_obs.observers.inversion import elapsed, first_innovation
from percept_obs.observers.parts import first_seen, hats
from percept_obs.recording.simulation import point_in_motion
from percept_obs.system.motion import Motion


def point_for_the_page(motion: Motion) -> Texts:
    """Return the printed functions by which the page moves a point: the numbers of A and b, and the loop."""
    return {
        "rates": function_source(motion.parameters, tuple(motion.A.row_join(motion.b))),
        "plant": source(point_in_motion(motion.A, motion.b, motion.parameters), "javascript"),
    }


def observer_for_the_page(ways: Mapping[str, Observer], equations: Mapping[str, Any]) -> Texts:
    """Facts, gains and equations of an observer in the letters of the paper, by the names of its switches."""
    whole = with_all_gains(ways)
    about = whole.about
    return {
        "title": whole.name,
        "about": about and {"title": about.title, "source": about.source, "needs": about.needs, "claim": about.claim},
        "gains": [gain_for_the_page(gain) for gain in whole.gains],
        "ways": {way: [gain.name for gain in made.gains] for way, made in ways.items()},
        "equations": dict(equations),
    }


def with_all_gains(ways: Mapping[str, Observer]) -> Observer:
    """The observer with the switch that has all gains."""
    return max(ways.values(), key=lambda observer: len(observer.gains))


def gain_for_the_page(gain: Gain) -> Texts:
    """A gain, and a function that tests whether a value is allowed."""
    return {
        "name": gain.name,
        "letter": markup(gain.symbol),
        **{name: getattr(gain, name) for name in ("value", "low", "high", "unit", "meaning")},
        "allowed": function_source((gain.symbol,), (sp.Piecewise((1, gain.condition), (0, True)),)),
        "condition": "" if gain.condition == sp.true else str(gain.condition),
        "reason": gain.reason,
    }


def kernel_for_the_page(observer: Observer) -> Texts:
    """Loop, start, estimate, gaps and step limit of an observer of one form."""
    form, equations = observer.form, observer.equations
    known = (*form.x1, *form.parameters, *equations.gains)
    claimed, fastest = observer.covariance, observer.fastest
    conditions = [(k, where.condition) for k, where in enumerate(observer.unobservable, 1)]
    begun = (elapsed, *first_innovation(form)) if observer.unobservable else ()
    return {
        "gains": [gain.name for gain in observer.gains],
        "run": source(equations, "javascript"),
        "states": len(equations.state),
        "start": function_source((*known, *hats(form.coordinates), *first_seen(form.x1)), observer.start),
        "estimate": function_source((*known, *equations.state), observer.estimate),
        "variances": claimed and function_source(equations.state, tuple(claimed[i, i] for i in range(claimed.rows))),
        "gap": None
        if not conditions
        else function_source((*known, *equations.state, *begun), (sp.Piecewise(*conditions, (0, True)),)),
        "gapReasons": [where.reason for where in observer.unobservable],
        "fastest": fastest and function_source((elapsed, *equations.gains), (fastest.rate,)),
        "remedy": fastest and fastest.remedy,
    }
