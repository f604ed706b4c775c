"""One table says of every run what became of it, one line of every observer, and its picture shows the same."""

import math
from dataclasses import replace

import numpy as np
import pytest
from examples import BOTH, NOISY, ONE, ZERO
from refusals import refuses

from percept_obs import check_consistency, cramer_rao, ekf, figures, ibo, pinhole, record, scenarios, smo, track
from percept_obs.observers import de_luca
from percept_obs.recording import Recording
from percept_obs.studies.comparison import compare, over_bound, relative_distance_errors

RECORDINGS = [record(scenarios.ma2005_eq35(), 5, NOISY, seed) for seed in range(4)]
OBSERVERS = {
    "good": ekf(ONE),
    "bounded": ibo(BOTH, bound=0.3),
    "blown": smo(BOTH, switching_gain=1e150, bound=1e160),
}


@pytest.fixture(scope="module")
def found():
    return compare(RECORDINGS, OBSERVERS, ZERO, after=2)


def test_a_row_is_a_run():
    columns = {"nis": lambda run: np.nanmean(run.nis) if run.observer.equations.update else math.nan}
    found = compare(RECORDINGS, [ekf(BOTH), ibo(BOTH)], ZERO, after=2, columns=columns)
    assert list(found.table["observer"]) == [*["extended Kalman"] * 4, *["identifier-based"] * 4]
    run, row = track(RECORDINGS[1], ekf(BOTH), ZERO), found.table.iloc[1]
    assert row["recording"] == RECORDINGS[1].source
    assert row["settling_time"] == run.settling_time()
    assert row["outcome"] == run.outcome().kind == "converged"
    assert row["final"] == abs(run.error[-1, 2])
    assert row["rms"] == pytest.approx(run.rms(2, 5, "y3"))
    assert row["worst"] == np.abs(run.error[200:, 2]).max()
    assert (row["resets"], row["diverged_at"], row["refusal"], row["warning"]) == (0, math.inf, "", "")
    assert row["nis"] == pytest.approx(check_consistency(run).mean)
    assert math.isnan(found.summary.loc["identifier-based", "nis"])
    assert row["cost"] > 0


def test_failures_resets_and_divergences_are_counted(found):
    summary = found.summary
    assert summary["failed"].to_dict() == {"good": 0, "bounded": 4, "blown": 4}
    assert summary["reset"].tolist() == [0, 4, 4]
    assert summary["diverged"].tolist() == [0, 0, 4]
    assert summary.loc["blown", "rms"] == math.inf
    assert summary.loc["good", "rms_low"] <= summary.loc["good", "rms"] <= summary.loc["good", "rms_high"]
    assert (summary["runs"] == 4).all()
    assert found.side_by_side.loc["blown", "failed"] == "4"


test_comparisons_that_make_no_sense_are_refused = refuses(
    lambda recordings, observers, settings: compare(recordings, observers, ZERO, **settings),
    ([], [ibo(BOTH)], {}, "at least one of each"),
    (RECORDINGS, [], {}, "at least one of each"),
    (RECORDINGS, [ibo(BOTH), ibo(ONE)], {}, "pass a mapping of labels"),
    (RECORDINGS, [ibo(BOTH)], {"after": 50}, "50 s or more after"),
    (
        [Recording(RECORDINGS[0].time, RECORDINGS[0].outputs, ("y1", "y2"), pinhole(), RECORDINGS[0].motion)],
        [ibo(BOTH)],
        {},
        "no truth",
    ),
)


def test_references_that_are_known_now_and_then_count_when_they_are():
    sparse = RECORDINGS[0].distance
    laser = np.where(np.arange(len(sparse)) % 7 == 0, sparse, np.nan)
    run = track(replace(RECORDINGS[0], distances={"laser": laser}), ibo(BOTH), ZERO)
    k = 105  # 1.05 s, the first one from 1 s on
    assert relative_distance_errors([run], 1.0, "laser") == pytest.approx(abs(run.distance[k] / sparse[k] - 1))


# Pictures.


def drawn_at(ax, place, marker):
    """Abscissae of the markers of a kind that stand in a row."""
    lines = [line for line in ax.lines if line.get_marker() == marker]
    return [x for line in lines for x, y in zip(*line.get_data(), strict=True) if y == place]


def test_every_run_its_median_and_its_spread_are_drawn_and_told(found):
    drawn, good = figures.comparison(found), found.summary.loc["good"]
    for ax, column in zip(drawn.axes, ("settling_time", "rms"), strict=True):
        runs = found.table.loc[found.table["observer"] == "good", column]
        ends = [good[f"{column}_low"], good[f"{column}_high"]]
        assert sorted(drawn_at(ax, 0, "|")) == pytest.approx(sorted([*runs, *ends]))
        assert drawn_at(ax, 0, "o") == [good[column]]
    assert f"good: 0 of 4 fail; settling time {good['settling_time']:.2g} s in the median" in drawn.text
    spread = f"{good['rms_low']:.2g} 1/m to {good['rms_high']:.2g} 1/m"
    assert f"rms error {good['rms']:.2g} 1/m in the median, {spread}" in drawn.text
    assert "bounded: 4 of 4 fail, 4 reset; settling time none in the median" in drawn.text


def test_what_is_missing_stands_at_the_edge_and_is_counted(found):
    settling, rms = figures.comparison(found).axes
    for ax, column, places in ((settling, "settling_time", [1, 2]), (rms, "rms", [2])):
        crosses = [x for place in range(3) for x in drawn_at(ax, place, "X")]
        assert [place for place in range(3) if drawn_at(ax, place, "X")] == places
        assert found.table[column][np.isfinite(found.table[column])].max() < min(crosses)
        assert max(crosses) < ax.get_xlim()[1]
    labels = [label.get_text() for label in settling.get_yticklabels()]
    assert labels == ["good\n0 of 4 fail", "bounded\n4 of 4 fail, 4 reset", "blown\n4 of 4 fail, 4 reset, 4 diverge"]
    one = figures.comparison(replace(found, table=found.table[found.table["observer"] == "blown"].head(1)))
    assert "blown: 1 of 1 fail, 1 reset, 1 diverge" in one.text
    one._repr_html_()


def test_failures_of_a_part_reach_the_edge():
    """A spread whose upper end has no settling time ends at the edge; the median has its place."""
    part = compare(RECORDINGS, [de_luca(BOTH)], ZERO, after=2)
    part.table.loc[0, "settling_time"] = np.inf
    settling, _ = figures.comparison(part).axes
    assert drawn_at(settling, 0, "o") == [part.summary.loc["De Luca", "settling_time"]]
    assert max(drawn_at(settling, 0, "|")) > part.table["settling_time"][1:].max()
    assert "1 of 4 fail" in settling.get_yticklabels()[0].get_text()


def test_pictures_of_what_was_not_asked_are_refused(found):
    for wrong in (replace(found, table=found.table.head(0)), replace(found, table=found.table.drop(columns="rms"))):
        with pytest.raises(ValueError, match="has no such runs"):
            figures.comparison(wrong)
    for cases in ({}, {"a": found}):
        with pytest.raises(ValueError, match='give comparisons with "settling_time" and "over_bound"'):
            figures.efficiencies(cases)


def test_the_error_over_the_bound_is_told_of_runs_that_settle():
    columns = {"over_bound": over_bound(BOTH)}
    kalman = ekf(BOTH, noise_variance=1e-4)
    found = compare(RECORDINGS, {"filter": kalman, "none": smo(BOTH, bound=0.3)}, columns=columns)
    runs = [track(each, kalman) for each in RECORDINGS]
    bound, late = cramer_rao(RECORDINGS[0], BOTH).relative, runs[0].elapsed >= 2.5
    ratios = [np.mean(((run.distance * run.truth[:, 2] - 1) / bound)[late] ** 2) for run in runs]
    np.testing.assert_allclose(found.table["over_bound"][:4] ** 2, ratios, rtol=1e-9)
    assert found.summary.loc["filter", "over_bound"] == pytest.approx(np.sqrt(np.mean(ratios)))
    assert found.summary.loc["none", "over_bound"] == np.inf
    text = figures.efficiencies({"one scene": found}).text
    assert "one scene: filter" in text
    assert "not settled: none" in text
