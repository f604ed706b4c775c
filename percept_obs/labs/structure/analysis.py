"""Sentences of Python on a run of structure and motion: late errors of the unknown quantities."""

import numpy as np

from percept_obs.structure import StructureAndMotion
from percept_obs.tracking.run import Run
from percept_obs.tracking.verdict import SETTLED_PART


def late_errors(title: str, run: Run) -> list[str]:
    """Sentences on the errors of the unknown quantities over the last tenth of the run."""
    unknowns = run.recording.view
    assert isinstance(unknowns, StructureAndMotion)
    late = run.time >= run.time[-1] - SETTLED_PART * np.ptp(run.time)
    found, true = (unknowns.quantities(values[late, 3:]) for values in (run.estimate, run.truth))
    lines = []
    for name, values in found.items():
        error = (values - true[name])[np.isfinite(values)]
        unit = "1/m" if name == "d_s" else "m/s"
        if len(error):
            off = f"{error.mean():+.2g} {unit} on average and scatters by {error.std():.2g}"
            lines.append(f"{title}, last tenth of the run: {name} is off by {off}.")
        else:
            lines.append(f"{title}, last tenth of the run: no estimate of {name}.")
    return lines
