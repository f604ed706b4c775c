"""The bound as equations: a filter that is told the truth at every sample, so that its covariance is the bound."""

from __future__ import annotations

from percept_obs.border import checked
from percept_obs.compile.equations import Equations
from percept_obs.observability.linearised import System, as_form
from percept_obs.observers import extended_kalman


@checked
def bound_filter(system: System) -> Equations:
    """The extended Kalman filter along the truth, to print in any language: its covariance is the bound.

    Flow, gains and the state (estimate and covariance, on and above the diagonal) are the filter's.  The measured
    outputs are all coordinates, in the form's order of measured and hidden ones, and their samples are the truth.  A
    sample of a measured output puts its estimate to the truth and corrects the covariance; one of a hidden coordinate
    only puts the estimate to the truth.  Where a sample was lost, leave it out (NaN).

    Parameters
    ----------
    system : PartitionedSystem, or PerspectiveSystem
        Which outputs are measured; a perspective system stands for all image coordinates.

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, pinhole
    >>> from percept_obs.compile import source
    >>> from percept_obs.observability import bound_filter
    >>> equations = bound_filter(PerspectiveSystem(affine(), pinhole()))
    >>> len(equations.state), len(equations.update)
    (9, 3)
    >>> source(equations, "javascript").splitlines()[0]
    'function run(start, steps, measured, parameters, samples, gains, varying, states, resets) {'
    """
    form = as_form(system)
    told = extended_kalman(form).equations
    x = (*form.x1, *form.x2)
    estimate, covariance = told.state[: len(x)], told.state[len(x) :]
    corrected = [*(block[len(x) :] for block in told.update), *(covariance for _ in form.x2)]
    update = tuple(
        (*estimate[:k], symbol, *estimate[k + 1 :], *entries)
        for k, (symbol, entries) in enumerate(zip(x, corrected, strict=True))
    )
    return Equations(told.state, told.flow, x, told.parameters, told.gains, update)
