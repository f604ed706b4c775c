"""Chwa 2019: all parts of its ledger."""

from percept_obs.papers import chwa2019_cases, chwa2019_model, chwa2019_observer, chwa2019_results, chwa2019_statements

PAPER = "Chwa 2019 (pages counted from the first)"
PARTS = (
    (*chwa2019_results.ENTRIES, *chwa2019_statements.ENTRIES),
    (*chwa2019_model.ENTRIES, *chwa2019_observer.ENTRIES, *chwa2019_cases.ENTRIES),
)
