"""The immersion and invariance observer of Karagiannis and Astolfi."""

from itertools import combinations

import sympy as sp

from percept_obs.observers.family import Derived, family
from percept_obs.observers.gains import Gain, grid
from percept_obs.observers.parts import hats
from percept_obs.system.forms import CanonicalForm

lam = sp.Symbol("lambda", real=True)


class NotIntegrable(ValueError):
    """The form's w is not a gradient, so that no function of the outputs has it as its derivative."""


def not_integrable(form: CanonicalForm) -> NotIntegrable | None:
    """Return an error if w has no potential, as on some curved surfaces with several outputs."""
    for (j, y), (k, z) in combinations(enumerate(form.x1), 2):
        if any(sp.expand(row[j].diff(z) - row[k].diff(y)) != 0 for row in form.w.tolist()):
            return NotIntegrable(
                f"w has no potential: its entries for {y} and {z} change differently with {z} and {y}; use an "
                "observer with an innovation, or measure one output alone"
            )
    return None


@family(
    name="immersion and invariance",
    title="Immersion and invariance observer (I&I)",
    source="Karagiannis and Astolfi 2005",
    needs="any outputs with an integrable w; constant motion",
    claim="asymptotic, if lambda |w|^2 outweighs the growth of the hidden part",
    gains=(
        Gain(lam, "gain", 5, 0.5, 60, "s/m^2", "how fast the hidden part follows", lam > 0, "the error must shrink"),
    ),
    candidates=grid(gain=(5, 10, 20, 40, 80)),
    objection_of=not_integrable,
    constant_motion=True,
)
def immersion_and_invariance(form: CanonicalForm) -> Derived:
    """Immersion and invariance observer (I&I), of the hidden coordinates only.

    With a function beta of the outputs such that dbeta/dx1 = lambda w::

        x2hat = xi + beta(x1)
        xi' = g(x1, x2hat) - lambda w (w^T x2hat + phi)

    The error e = x2 - x2hat then obeys e' = -lambda w w^T e + g(x1, x2) - g(x1, x2hat), without an innovation.
    Its estimate of the measured coordinates is the measurement.

    See Also
    --------
    de_luca : with an innovation

    Notes
    -----
    D. Karagiannis, A. Astolfi, A new solution to the problem of range identification in perspective vision systems,
    IEEE Trans. Automatic Control 50(12), 2005.  beta holds the motion's coefficients, but the equations leave out the
    rate that their change would give it: `track` refuses a motion that varies.

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, pinhole
    >>> from percept_obs.observers import ii
    >>> observer = ii(PerspectiveSystem(affine(), pinhole()).measure("y1"))
    >>> observer.estimate
    (y1, lambda*(a12*y1 - a32*y1**2/2) + xi1, lambda*(b1*y1 - b3*y1**2/2) + xi2)
    """
    # beta is the integral of lambda w along the straight line from zero to the outputs
    share = sp.Symbol("s", real=True)
    on_line = form.w.subs({y: share * y for y in form.x1}, simultaneous=True).expand() * sp.ImmutableMatrix(form.x1)
    beta = lam * on_line.applyfunc(lambda entry: sp.integrate(entry.expand(), (share, 0, 1)))
    xi = sp.symbols(f"xi1:{len(form.x2) + 1}", real=True)
    x2_hat = sp.ImmutableMatrix(xi) + beta
    g_hat = form.g.subs(dict(zip(form.x2, x2_hat, strict=True)), simultaneous=True)
    rate = g_hat - lam * form.w * (form.w.T * x2_hat + form.phi)
    return Derived(xi, tuple(rate), tuple(sp.ImmutableMatrix(hats(form.x2)) - beta), (*form.x1, *x2_hat))


ii = immersion_and_invariance
