"""Ma, Chen and Moore 2005: all parts of its ledger."""

from percept_obs.papers import (
    ma2005_appendix,
    ma2005_examples,
    ma2005_observability,
    ma2005_observers,
    ma2005_perspective,
    ma2005_proofs,
    ma2005_statements,
)

PAPER = "Ma, Chen and Moore 2005"
PARTS = (
    (
        *ma2005_perspective.ENTRIES,
        *ma2005_observers.ENTRIES,
        *ma2005_appendix.ENTRIES,
        *ma2005_statements.ENTRIES,
    ),
    (*ma2005_observability.ENTRIES, *ma2005_proofs.ENTRIES, *ma2005_examples.ENTRIES),
)
