"""Tuned alike, no observer lies below the Cramer-Rao bound beyond chance, and only a filter comes near it."""

import numpy as np
import pytest
from efficiency_study import cases
from percept_obs.studies.efficiencies import efficiencies

from percept_obs import ekf, ibo, ismo
from percept_obs.figures import efficiencies as drawn


@pytest.fixture(scope="module")
def table():
    chosen = {make: make.candidates[-4:] for make in (ibo, ekf, ismo)}
    return efficiencies({name: case for name, case in cases(8, real=False).items()}, chosen)


@pytest.mark.slow
def test_no_ratio_is_below_one_beyond_chance(table):
    known = table[np.isfinite(table["ratio"])]
    assert len(known) >= 6
    assert (known["ratio"] + 3 * known["scatter"] > 1).all()


@pytest.mark.slow
def test_the_filter_is_near_the_bound_where_others_are_not(table):
    ratio = table.pivot(index="case", columns="observer", values="ratio")
    assert (ratio["extended Kalman"] < 2).all()
    assert (ratio["identifier-based"] > 4).all()


@pytest.mark.slow
def test_who_cannot_run_says_why_and_is_named_in_the_picture(table):
    refused = table[table["refusal"] != ""]
    assert [*refused["case"]] == ["Ma (35), y1 alone"]
    assert "measure every image coordinate" in refused["refusal"].item()
    assert "Ma (35), y1 alone: " in drawn(table).text
    assert drawn(table).text.count("integral sliding mode") == 3


def test_a_table_needs_a_case():
    with pytest.raises(ValueError, match="there are no cases"):
        efficiencies({})
