"""Letters that are known by definition: the point X, Y, Z in terms of its image, w, phi and g, the error e."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import sympy as sp

from percept_obs.checking.points import key
from percept_obs.observers import Observer
from percept_obs.observers.parts import hats
from percept_obs.system.forms import CanonicalForm, PartitionedSystem
from percept_obs.system.perspective import PerspectiveSystem
from percept_obs.system.surfaces import POINT, ImagingSurface

Relations = Mapping[sp.Symbol, sp.Expr]


def of_system(system: PerspectiveSystem) -> Relations:
    """Return the point, and its velocity Xdot, Ydot, Zdot, in terms of image and inverse distance."""
    point = _seen(system.surface)
    velocity = system.motion.A * sp.ImmutableMatrix(list(point.values())) + system.motion.b
    return point | _free(zip(_numbered(("Xdot", "Ydot", "Zdot")), velocity, strict=True), system.parameters)


def of_form(form: PartitionedSystem) -> Relations:
    """Return the point if one is seen, and w, phi and g of a canonical form, entry by entry."""
    found = _seen(form.view) if isinstance(form.view, ImagingSurface) else {}
    if not isinstance(form, CanonicalForm):
        return found
    entries = parts(form)
    return found | _free(zip(_numbered(entries), entries.values(), strict=True), (*form.coordinates, *form.parameters))


def parts(form: CanonicalForm) -> dict[str, sp.Expr]:
    """Return the entries of w, phi and g by name."""
    return dict(each for name in ("w", "phi", "g") for each in _entries(name, getattr(form, name)))


def of_observer(observer: Observer) -> Relations:
    """Return w and phi of the form, g at the estimate, and the error e = y - yhat of each coordinate."""
    form = observer.form
    truth = dict(zip(form.x2, hats(form.x2), strict=True))
    found = dict(of_form(form))
    if isinstance(form, CanonicalForm):
        found |= {sp.Symbol(f"{name}hat", real=True): e.xreplace(truth) for name, e in _entries("g", form.g)}
    error = ((e, y - yhat) for e, y, yhat in zip(observer.error, form.coordinates, observer.estimate, strict=True))
    eq = observer.equations
    return _free((*found.items(), *error), (*eq.state, *eq.measured, *eq.parameters, *eq.gains))


def _seen(surface: ImagingSurface) -> dict[sp.Symbol, sp.Expr]:
    return {s: entry / surface.inverse_distance for s, entry in zip(POINT, surface.ray, strict=True)}


def _entries(name: str, part: sp.ImmutableMatrix) -> Iterable[tuple[str, sp.Expr]]:
    """Yield names of a matrix's entries, w1, w2 or w11, w12, and the entries."""
    rows, columns = part.shape
    for i in range(rows):
        for j in range(columns):
            index = f"{i + 1}{j + 1}" if min(rows, columns) > 1 else f"{max(i, j) + 1}" if len(part) > 1 else ""
            yield f"{name}{index}", part[i, j]


def _numbered(names: Iterable[str]) -> list[sp.Symbol]:
    return [sp.Symbol(name, real=True) for name in names]


def _free(pairs: Iterable[tuple[sp.Symbol, sp.Expr]], taken: Iterable[sp.Symbol]) -> dict[sp.Symbol, sp.Expr]:
    """Return the definitions of those letters that mean nothing else here, as v1 does in a linear motion."""
    known = {key(s.name) for s in taken}
    return {s: e for s, e in pairs if key(s.name) not in known}
