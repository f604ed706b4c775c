"""The immersion and invariance observer of Karagiannis and Astolfi."""

from __future__ import annotations

from itertools import combinations

import sympy as sp

from percept_obs.compile.equations import Equations
from percept_obs.observers.base import About, Gain, Observer, hats
from percept_obs.system.forms import CanonicalForm, PartitionedSystem

lam = sp.Symbol("lambda", real=True)

GAINS = (Gain(lam, "gain", 5, 0.5, 60, "how fast the hidden part follows", lam > 0, "the error must shrink"),)


class NotIntegrable(ValueError):
    """The form's w is not a gradient, so that no function of the outputs has it as its derivative."""


ABOUT = About(
    "Immersion and invariance observer (I&I)",
    "Karagiannis and Astolfi 2005",
    "any outputs with an integrable w; constant motion",
    "asymptotic, if lambda |w|^2 outweighs the growth of the hidden part",
)


def immersion_and_invariance(form: PartitionedSystem, **gains: float) -> Observer:
    """Immersion and invariance observer (I&I), of the hidden coordinates only.

    With a function beta of the outputs such that dbeta/dx1 = lambda w::

        x2hat = xi + beta(x1)
        xi' = g(x1, x2hat) - lambda w (w^T x2hat + phi)

    The error e = x2 - x2hat then obeys e' = -lambda w w^T e + g(x1, x2) - g(x1, x2hat), without an innovation.

    Parameters
    ----------
    form : PartitionedSystem
        With a canonical form.
    gain : float
        lambda, positive.  Default 5.

    Returns
    -------
    Observer
        Its estimate of the measured coordinates is the measurement.

    Raises
    ------
    NotAffine
        If there is no canonical form.
    NotIntegrable
        If w has no such function, as can happen on curved surfaces with several outputs.
    ValueError
        If a gain is unknown or out of its range.

    Notes
    -----
    D. Karagiannis, A. Astolfi, A new solution to the problem of range identification in perspective vision systems,
    IEEE Trans. Automatic Control 50(12), 2005.  beta holds the motion's coefficients, but the equations leave out the
    rate that their change would give it: `track` refuses a motion that varies.
    """
    form = form.canonical_form()
    beta = lam * _potential(form)
    xi = sp.symbols(f"xi1:{len(form.x2) + 1}", real=True)
    x2_hat = sp.ImmutableMatrix(xi) + beta
    g_hat = form.g.subs(dict(zip(form.x2, x2_hat, strict=True)), simultaneous=True)
    rate = g_hat - lam * form.w * (form.w.T * x2_hat + form.phi)
    equations = Equations(xi, tuple(rate), form.x1, form.parameters, tuple(gain.symbol for gain in GAINS))
    hidden = dict(zip(form.x2, x2_hat, strict=True))
    estimate = tuple(hidden.get(x, x) for x in form.coordinates)
    start = tuple(sp.ImmutableMatrix(hats(form.x2)) - beta)
    name = "immersion and invariance"
    observer = Observer(name, form, equations, estimate, GAINS, start, about=ABOUT, constant_motion=True)
    return observer.with_gains(**gains)


def _potential(form: CanonicalForm) -> sp.ImmutableMatrix:
    """The function of the outputs whose derivative is w, zero where the outputs are."""
    for (j, y), (k, z) in combinations(enumerate(form.x1), 2):
        for row in range(len(form.x2)):
            if sp.expand(form.w[row, j].diff(z) - form.w[row, k].diff(y)) != 0:
                raise NotIntegrable(
                    f"w has no potential: its entries for {y} and {z} change differently with {z} and {y}; use an "
                    "observer with an innovation, or measure one output alone"
                )
    # along the straight line from zero to the outputs
    s = sp.Symbol("s", real=True)
    line = {y: s * y for y in form.x1}
    integrand = form.w.subs(line, simultaneous=True).expand() * sp.ImmutableMatrix(form.x1)
    return integrand.applyfunc(lambda entry: sp.integrate(entry.expand(), (s, 0, 1)))


ii = immersion_and_invariance
