"""Observability in all its meanings, side by side: one call, one table, and why the measures disagree."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from types import MappingProxyType

import numpy as np

from percept_obs.observability.bound import Bound, cramer_rao
from percept_obs.observability.directions import in_words
from percept_obs.observability.error_gramian import ErrorGramian, empirical_gramian, error_gramian
from percept_obs.observability.lie import LieRanks, lie_ranks
from percept_obs.observability.matching import System, matching_form
from percept_obs.observability.windows import Excitation, Windows, instants, windowed
from percept_obs.observers import extended_kalman
from percept_obs.recording import Recording
from percept_obs.system.forms import PartitionedSystem
from percept_obs.tracking.verdict import number
from percept_obs.validation import checked

USUAL_WINDOW = 10.0
"""Seconds of a window, unless the recording is shorter than four of them."""

LEARNT = 0.5
"""A direction is learnt if the samples leave less than this share of its standard deviation at the start."""

NOISE_VARIANCE = next(gain.value for gain in extended_kalman.gains if gain.name == "noise_variance")
"""Variance of the noise for the bound where a recording has none: the one that the extended Kalman filter believes."""

WHY = MappingProxyType(
    {
        "printed": "(20) as printed is the larger eigenvalue of w w^T. It asks whether an instant shows anything at "
        "all of {hidden}; the smaller eigenvalue, which asks whether it shows everything, is 0 at every instant.",
        "instant": "An instant lacks a direction, at {time} s for instance, but w changes along the trajectory, so "
        "that the instants of a window show together what one of them does not.",
        "window": "Persistency of excitation counts what w shows and leaves out how the hidden coordinates change. "
        "What w does not show of {unexcited} is seen through g, which carries it into what is measured.",
        "derivatives": "The rank asks whether a direction shows in some derivative, however little; over a window of "
        "{window} s it shows too little to count.",
        "stays": "The rank falls at single samples only, which a window bridges.",
        "nonlinear": "The perturbed runs leave the linearised ones: the perturbation is not small there.",
        "noise": "Every direction is seen, but against this noise {length} s are too short to learn {unlearnt} well.",
        "early": "Over the whole recording the bound falls in every direction, although single windows miss one.",
        "none": "All measures agree: {all}.",
    }
)
"""Reasons why two measures disagree."""


@dataclass(frozen=True)
class Measure:
    """Result of one measure of observability for a trajectory.

    Parameters
    ----------
    name, asks : str
        Name of the measure, and its question.
    holds : bool
        True if it finds the state observable.
    value : float
        Least value of the measure.
    time : float
        Seconds since the first sample at which the value is least.
    lost : tuple of str
        Directions that are not seen there, in words.
    said : str
        The value in words.

    See Also
    --------
    Observability : All measures of a trajectory.

    Examples
    --------
    >>> from percept_obs import Camera, PerspectiveSystem, affine, how_observable, pinhole, record, scenarios
    >>> seen = record(scenarios.ma2005_eq36(), 20, Camera(0.1))
    >>> found = how_observable(seen, PerspectiveSystem(affine(), pinhole()).measure("y1"))
    >>> found["instant"].lost, found["Lie rank"].said
    (('y2 - 0.632 y3',), 'rank 3 of 3')
    """

    name: str
    asks: str
    holds: bool
    value: float
    time: float
    lost: tuple[str, ...]
    said: str

    @property
    def cells(self) -> tuple[str, ...]:
        """Cells of the row in the table."""
        lost = "; ".join(self.lost) or ("" if self.holds else "everything hidden")
        return self.name, self.asks, "yes" if self.holds else "no", f"{self.said} at {self.time:.3g} s", lost


@checked
@dataclass(frozen=True, eq=False, repr=False)
class Observability:
    """Measures of observability along a trajectory, from `how_observable`.

    Parameters
    ----------
    form : PartitionedSystem
    recording : Recording
    instant, excitation : Excitation or None
        w w^T at the samples, and over windows; None if there is no canonical form, and so no w.
    lie : LieRanks
    error, empirical : ErrorGramian
        Of the linearised error system, and by perturbed runs.
    bound : Bound

    Examples
    --------
    >>> from percept_obs import Camera, PerspectiveSystem, affine, how_observable, pinhole, record, scenarios
    >>> seen = record(scenarios.ma2005_eq36(), 20, Camera(0.1))
    >>> found = how_observable(seen, PerspectiveSystem(affine(), pinhole()).measure("y1"))
    >>> [measure.name for measure in found.measures if not measure.holds]
    ['instant']
    """

    form: PartitionedSystem
    recording: Recording
    instant: Excitation | None
    excitation: Excitation | None
    lie: LieRanks
    error: ErrorGramian
    empirical: ErrorGramian
    bound: Bound

    @property
    def window(self) -> float:
        """Length of the windows in seconds."""
        return self.error.window

    @cached_property
    def measures(self) -> tuple[Measure, ...]:
        """Results of all measures, from an instant to the bound."""
        return tuple(self._measures())

    def __getitem__(self, name: str) -> Measure:
        """Result of one measure by its name."""
        found = {measure.name: measure for measure in self.measures}
        if name not in found:
            raise KeyError(f"there is no measure {name!r}; there are {', '.join(found)}")
        return found[name]

    def _measures(self) -> Iterator[Measure]:
        elapsed, window = self.recording.elapsed, f"{self.window:g} s"
        if self.instant is not None:
            # with fewer outputs than hidden coordinates w w^T is singular, and the printed measure differs
            if len(self.form.x1) < len(self.form.x2):
                largest = self.instant.eigenvalues[:, -1]
                k, value = int(np.argmin(largest)), float(largest.min())
                asks, said = "does an instant show anything hidden?", f"|w|^2 = {number(value)}"
                yield Measure("(20) as printed", asks, value > 0, value, float(elapsed[k]), (), said)
            yield self._of_windows("instant", "does an instant show everything hidden?", self.instant, "w w^T")
        if self.excitation is not None:
            asks = f"do {window} of w show everything hidden?"
            yield self._of_windows("excitation", asks, self.excitation, "the integral of w w^T")
        k, lie = self.lie.weakest, self.lie
        said = f"rank {int(lie.ranks[k, -1])} of {len(self.form.coordinates)}"
        asks = "do outputs and their derivatives tell states apart?"
        yield Measure("Lie rank", asks, lie.holds, float(lie.smallest[k]), float(elapsed[k]), lie.lost(), said)
        asks = f"do {window} of outputs change with every coordinate?"
        yield self._of_windows("error Gramian", asks, self.error, "Phi^T H^T H Phi")
        asks = "the same by perturbed runs, without derivatives"
        yield self._of_windows("empirical Gramian", asks, self.empirical, "the Gramian")
        shares, directions = self.bound.kept()
        left = float(shares[-1])
        lost = in_words(directions[:, shares >= LEARNT], self.form.hidden) if left >= LEARNT else ()
        asks, said = (
            "does what is hidden become known, against this noise?",
            f"{100 * left:.3g} % of a deviation is left",
        )
        yield Measure("bound", asks, left < LEARNT, left, float(elapsed[-1]), lost, said)

    def _of_windows(self, name: str, asks: str, found: Windows, what: str) -> Measure:
        """Result of a measure over windows."""
        k = found.weakest
        least = max(float(found.smallest[k]), 0.0)
        said = f"smallest eigenvalue of {what} {number(least) if least > 1e-12 else '0'}"
        at = float(found.time[k] - self.recording.time[0])
        return Measure(name, asks, found.holds, least, at, found.lost(k), said)

    @cached_property
    def disagreements(self) -> tuple[str, ...]:
        """Reasons why measures disagree, one sentence or two each."""
        says = {measure.name: measure.holds for measure in self.measures}
        instant, excited = says.get("instant"), says.get("excitation")  # None without a canonical form
        rank, error, bound = says["Lie rank"], says["error Gramian"], says["bound"]
        holds = {
            "printed": says.get("(20) as printed") and not instant,
            "instant": instant is False and excited,
            "window": excited is False and error,
            "derivatives": rank and not error,
            "stays": error and not rank,
            "nonlinear": error != says["empirical Gramian"],
            "noise": error and not bound,
            "early": bound and not error,
        }
        reasons = [reason for reason, true in holds.items() if true] or ["none"]
        fields = {"hidden": ", ".join(self.form.hidden), "window": f"{self.window:g}"}
        fields |= {"length": f"{self.recording.elapsed[-1]:.4g}", "unlearnt": "; ".join(self["bound"].lost)}
        fields["all"] = "the state is observable" if bound else "it is not observable"
        if instant is not None:
            fields |= {"time": f"{self['instant'].time:.3g}", "unexcited": "; ".join(self["excitation"].lost)}
        return tuple(WHY[reason].format(**fields) for reason in reasons)

    def __str__(self) -> str:
        rows = [HEADS, *(measure.cells for measure in self.measures)]
        widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
        lines = ["  ".join(map(str.ljust, row, widths)).rstrip() for row in rows]
        return "\n".join([*lines, *self.disagreements])

    def __repr__(self) -> str:
        return f"<Observability of {', '.join(self.form.measured)}\n{self}>"

    def _repr_markdown_(self) -> str:
        rows = [HEADS, ["---"] * len(HEADS), *(measure.cells for measure in self.measures)]
        table = "\n".join("| " + " | ".join(cell.replace("|", r"\|") for cell in row) + " |" for row in rows)
        return table + "\n\n" + "\n".join(f"- {reason}" for reason in self.disagreements)


HEADS = ("measure", "asks", "says", "where it is weakest", "not seen")


@checked
def how_observable(
    recording: Recording,
    system: System,
    window: float | None = None,
) -> Observability:
    """Compute every measure of observability along the true trajectory of a recording.

    They are: w w^T at an instant, for one output also as Ma 2005, (20), prints it; persistency of excitation over a
    window; the rank of the Lie derivatives' differentials; the Gramian of the linearised error system over a window,
    and from perturbed runs; and the Cramer-Rao bound at the end, for a recording without noise of the variance that
    the extended Kalman filter believes.

    Parameters
    ----------
    recording : Recording
        With a truth.
    system : PartitionedSystem, or PerspectiveSystem
        Which outputs are measured; a perspective system stands for all image coordinates.
    window : float, optional
        Seconds; 10, or a quarter of a recording that is shorter than 40 s, when left out.

    Returns
    -------
    Observability
        Prints as a table and the reasons why measures disagree; ``figures.observability`` draws it.

    Raises
    ------
    ValueError
        If system and recording do not fit, there is no truth, or the window does not fit.

    See Also
    --------
    instantaneous, windowed, lie_derivatives, cramer_rao : Single measures.

    Examples
    --------
    >>> from percept_obs import Camera, PerspectiveSystem, affine, how_observable, pinhole, record, scenarios
    >>> form = PerspectiveSystem(affine(), pinhole()).measure("y1")
    >>> found = how_observable(record(scenarios.ma2005_eq36(), camera=Camera(0.1)), form)
    >>> [(measure.name, measure.holds) for measure in found.measures][2:5]
    [('excitation', False), ('Lie rank', True), ('error Gramian', True)]
    """
    form = matching_form(system, recording)
    window = min(USUAL_WINDOW, float(recording.elapsed[-1]) / 4) if window is None else window
    error, canonical = error_gramian(recording, form, window), not form.culprits
    return Observability(
        form,
        recording,
        instants(form, recording) if canonical else None,
        windowed(form, recording, window) if canonical else None,
        lie_ranks(recording, form),
        error,
        empirical_gramian(recording, form, window),
        cramer_rao(recording, form, noise_variance=recording.effective_variance or NOISE_VARIANCE),
    )
