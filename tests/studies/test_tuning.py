"""Gains are chosen on some recordings and reported on others, and an observer that cannot follow says so."""

from dataclasses import replace

import numpy as np
import pytest
from examples import AFFINE, BOTH, NOISY, ONE, ZERO
from refusals import refuses

from percept_obs import PerspectiveSystem, pinhole, record, rigid, scenarios, track
from percept_obs.observers import OBSERVERS, de_luca, extended_kalman, integral_sliding_mode, range_identification
from percept_obs.observers.gains import grid
from percept_obs.studies.comparison import relative_distance_errors
from percept_obs.studies.least_squares import moving_window_least_squares
from percept_obs.studies.tuning import choose_and_report, side_by_side
from percept_obs.tracking.following import DoesNotFit

FOUR = [record(scenarios.ma2005_eq35(), 3, replace(NOISY, period=0.05), seed) for seed in range(4)]
CHOOSING, REPORTING = FOUR[:2], FOUR[2:]
GAINS = {de_luca: grid(measured_gain=(5, 10), hidden_gain=(0.1, 50)), range_identification: ({},)}


def follow(recording, observer):
    return track(recording, observer, ZERO)


def reported(form=BOTH, **settings):
    return choose_and_report(CHOOSING, REPORTING, form, follow, GAINS, after=(1.0, 2.0), length=1.0, **settings)


def test_the_grid_has_every_combination():
    assert grid(a=(1, 2), b=(3, 4)) == ({"a": 1, "b": 3}, {"a": 1, "b": 4}, {"a": 2, "b": 3}, {"a": 2, "b": 4})


@pytest.mark.parametrize("make", OBSERVERS, ids=lambda make: make.key)
def test_there_are_candidates_for_every_observer_and_all_are_valid(make):
    observer = make(BOTH)
    different = {tuple(observer.with_gains(**gains).gain_values.items()) for gains in make.candidates}
    assert len(different) == len(make.candidates) > 1


def test_a_row_has_the_errors_of_the_chosen_gains_on_the_other_half():
    table = reported().set_index(["observer", "after"])

    def errors(recordings, gains, after):
        return relative_distance_errors([follow(r, de_luca(BOTH, **gains)) for r in recordings], after)

    least = min(GAINS[de_luca], key=lambda gains: sum(np.median(errors(CHOOSING, gains, t)) for t in (1, 2)))
    assert table.loc["De Luca", "gains"].tolist() == [", ".join(f"{name} {v}" for name, v in least.items())] * 2
    row = table.loc[("De Luca", 2)]
    assert row["median"] == np.median(errors(REPORTING, least, 2))
    assert row["nine_in_ten"] == max(errors(REPORTING, least, 2))
    assert (row["behind"], row["reset"], row["diverged"], row["refusal"]) == (0, 0, 0, "")
    assert row["cost"] > 0


def test_a_refusal_is_told_in_words():
    table = reported(ONE)
    refused = table[table["observer"] == "range identification"]
    assert len(refused) == 2
    assert refused["median"].isna().all()
    assert refused["refusal"].str.contains("y2, y3 are hidden; measure every image coordinate").all()
    line = side_by_side(table).loc["range identification"]
    assert line["remark"].startswith("cannot: y2, y3 are hidden; measure every image coordinate")
    assert set(line.drop("remark")) == {"–"}


def test_the_table_says_from_when_on_an_observer_is_usable():
    """An error that grows again does not count before."""
    table = reported()
    label = table["observer"].iloc[0]
    rows = table[table["observer"] == label].iloc[[0, 1, 1]].assign(after=[1.0, 2.0, 3.0])
    for errors, said in (((0.2, 0.1, 0.05), "2 s"), ((0.05, 0.2, 0.3), "not within 3 s"), ((0.01, 0.02, 0.1), "1 s")):
        assert side_by_side(rows.assign(nine_in_ten=errors)).loc[label, "usable after"] == said


def test_batch_estimates_stand_beside_the_observers():
    table = reported(batch={"least squares": moving_window_least_squares}).set_index(["observer", "after"])
    errors = relative_distance_errors([moving_window_least_squares(recording) for recording in REPORTING], 2)
    assert table.loc[("least squares", 2), "median"] == np.median(errors)


@pytest.mark.parametrize(
    ("family", "batch", "label", "after"),
    [
        (extended_kalman, {"none": lambda r: moving_window_least_squares(r, 1e-3)}, "none", 1.0),
        (integral_sliding_mode, {}, "integral sliding mode", 0.1),  # its start may still be half of its estimate
    ],
)
def test_where_there_is_no_estimate_all_recordings_are_behind(family, batch, label, after):
    table = choose_and_report(CHOOSING, REPORTING, BOTH, follow, {family: ({},)}, batch, after=(after,))
    assert table.set_index("observer").loc[label, ["median", "behind"]].tolist() == [np.inf, 2]
    lines = side_by_side(table)
    assert lines.loc[label, f"truth {after:g} s"] == "none (none)"
    assert lines["behind"].tolist() == ["0", "2"][-len(lines) :]


test_choices_that_are_none_are_refused = refuses(
    lambda choosing, reporting, candidates: choose_and_report(
        choosing, reporting, AFFINE.measure("y1", "y2"), follow, candidates
    ),
    ([], REPORTING, GAINS, "0 recordings to choose on"),
    (CHOOSING, [], GAINS, "0 to report on"),
    (CHOOSING, CHOOSING[:1], GAINS, "in both halves"),
    (CHOOSING, REPORTING, {}, "at least one candidate"),
    (CHOOSING, REPORTING, {de_luca: ()}, "at least one candidate"),
    (CHOOSING, REPORTING, {de_luca: ({"hidden_gain": -1},)}, "out of range"),
)


def test_less_than_no_run_is_not_judged():
    with pytest.raises(ValueError, match="judged is -1"):
        choose_and_report(CHOOSING, REPORTING, AFFINE.measure("y1", "y2"), follow, GAINS, judged=-1)


def test_recordings_of_another_motion_than_the_form_are_refused():
    with pytest.raises(DoesNotFit, match="use the same kind of motion for both"):
        reported(PerspectiveSystem(rigid(), pinhole()).measure("y1", "y2"))
