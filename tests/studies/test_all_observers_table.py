"""One call chooses every observer's gains on some recordings, reports on others, and says what was left out and why."""

from dataclasses import replace

import numpy as np
import pytest
from efficiency_study import compared
from examples import BOTH, NOISY, ONE
from refusals import refuses

from percept_obs import PerspectiveSystem, ekf, figures, ibo, ismo, pinhole, record, rigid, scenarios, track
from percept_obs.observers import OBSERVERS, de_luca, sliding_mode
from percept_obs.observers.gains import grid
from percept_obs.studies.all_observers import LEAST_SQUARES, all_observers
from percept_obs.studies.comparison import relative_distance_errors
from percept_obs.studies.least_squares import moving_window_least_squares
from percept_obs.tracking.following import DoesNotFit

SEEN = [record(scenarios.ma2005_eq35(), 2.5, replace(NOISY, period=0.05), seed) for seed in range(4)]
GAINS = {de_luca: grid(measured_gain=(5, 10), hidden_gain=(0.1, 50))}


def found(recordings=SEEN, candidates=GAINS, **settings):
    return all_observers(recordings, candidates=candidates, **settings)


def test_the_grid_has_every_combination():
    assert grid(a=(1, 2), b=(3, 4)) == ({"a": 1, "b": 3}, {"a": 1, "b": 4}, {"a": 2, "b": 3}, {"a": 2, "b": 4})


@pytest.mark.parametrize("make", OBSERVERS, ids=lambda make: make.key)
def test_there_are_candidates_for_every_observer_and_all_are_valid(make):
    observer = make(BOTH)
    different = {tuple(observer.with_gains(**gains).gain_values.items()) for gains in make.candidates}
    assert len(different) == len(make.candidates) > 1


def test_the_line_has_the_errors_of_the_chosen_gains_on_the_other_half():
    one_call = found(length=1.0)
    start = {"y3": 1 / (2 * np.median(np.concatenate([1 / each.truth[:, 2] for each in SEEN[::2]])))}

    def errors(recordings, gains, after):
        return relative_distance_errors([track(r, de_luca(BOTH, **gains), start) for r in recordings], after)

    least = min(GAINS[de_luca], key=lambda gains: sum(np.median(errors(SEEN[::2], gains, t)) for t in (1, 2)))
    row = one_call.table.iloc[0]
    assert row["gains"] == ", ".join(f"{name} {value:.3g}" for name, value in least.items())
    line, theirs = one_call.summary.loc["De Luca"], errors(SEEN[1::2], least, 2)
    assert line["truth 2 s"] == pytest.approx(np.median(theirs))
    assert line["truth 2 s_most"] == pytest.approx(max(theirs))
    assert (line["runs"], line["behind"], line["reset"], line["diverged"]) == (2, 0, 0, 0)
    assert one_call.start == pytest.approx(start)
    assert one_call.left_out == {"errors after 3 s": "no recording in one of the halves lasts longer than 2.5 s"}
    batch = relative_distance_errors([moving_window_least_squares(each) for each in SEEN[1::2]], 2)
    assert one_call.summary.loc[LEAST_SQUARES, "truth 2 s"] == pytest.approx(np.median(batch))
    given = found(SEEN[1::2], choosing=SEEN[::2], form=BOTH, length=1.0)
    assert given.table.drop(columns="cost").equals(one_call.table.drop(columns="cost"))


def test_recordings_are_split_in_two_ways():
    later = [replace(each, time=each.time + shift) for each, shift in zip(SEEN, (3, 1, 2, 0), strict=True)]
    for split, choosing in (("alternating", [0, 2]), ("earlier and later", [3, 1])):
        one_call = found(later, split=split, start={"y3": 0.1})
        assert [later.index(each) for each in one_call.choosing] == choosing
        assert sorted(map(later.index, one_call.reporting)) == sorted({0, 1, 2, 3} - set(choosing))


def test_what_cannot_be_used_is_left_out_and_told():
    blind, first = replace(SEEN[0], truth=None), SEEN[0].outputs.copy()
    half = replace(SEEN[0], outputs=SEEN[0].outputs[:, :1], names=("y1",))
    first[0] = np.nan
    others = {
        "has no truth to compare with": blind,
        "its first sample was lost": replace(SEEN[0], outputs=first),
        "it lasts 0.5 s, and the first error is asked for after 1 s": SEEN[0].between(0, 0.5),
        "its outputs are y1, those of the first y1, y2": half,
        "its motion is rigid with other": replace(
            SEEN[0], motion=rigid(camera_angular_velocity=[0, 0, -0.1], camera_velocity=[0.1, 0, 0])
        ),
        "its truth is known at no sample": replace(SEEN[0], truth=SEEN[0].truth * np.nan),
    }
    one_call = found([*SEEN, *others.values()])
    whys = [why for what, why in one_call.left_out.items() if what.startswith("recording")]
    assert len(whys) == len(others)
    for expected, why in zip(others, whys, strict=True):
        assert expected in why
        assert why in repr(one_call)
        assert why in one_call._repr_html_()
    assert len(one_call.choosing) == len(one_call.reporting) == 2


def test_observers_that_cannot_run_say_why():
    for settings in ({}, {"form": ONE}):  # one output recorded, or one of two looked at
        one = [replace(each, outputs=each.outputs[:, :1], names=("y1",)) for each in SEEN]
        one_call = found(SEEN if settings else one, candidates={ismo: ({},), sliding_mode: ({},)}, **settings)
        assert one_call.summary["runs"].to_dict() == {"integral sliding mode": 0, "sliding mode": 2}
        line = one_call.side_by_side.loc["integral sliding mode"]
        assert line["remark"].startswith("cannot: y2, y3 are hidden; measure every image coordinate")
        assert set(line.drop("remark")) == {"–"}


def test_steps_that_are_too_long_are_told_beside_the_numbers():
    line = found(candidates={ismo: ({"sharpening": 10.0},)}).side_by_side.loc["integral sliding mode"]
    assert "too fast for a step of 0.01 s" in line["remark"]
    assert line["truth 1 s"] != "–"


def test_where_there_is_no_estimate_all_recordings_are_behind():
    """A start may still be half of an estimate."""
    one_call = found(candidates={ismo: ({},)}, after=(0.1,), start={"y1": 0.0, "y2": 0.0, "y3": 0.0})
    assert one_call.summary.loc["integral sliding mode", ["truth 0.1 s", "behind"]].tolist() == [np.inf, 2]
    lines = one_call.side_by_side
    assert lines.loc["integral sliding mode", ["truth 0.1 s", "behind"]].tolist() == ["none (none)", "2"]


def test_the_table_says_from_when_on_an_observer_is_usable():
    """An error that grows again does not count before."""
    one_call = found()
    rows = one_call.table[one_call.table["observer"] == "De Luca"]
    for errors, said in (((0.2, 0.1, 0.05), "2 s"), ((0.05, 0.2, 0.3), "not within 3 s"), ((0.01, 0.02, 0.1), "1 s")):
        table = rows.assign(**{f"truth {k} s": error for k, error in enumerate(errors, 1)})
        assert replace(one_call, table=table).side_by_side.loc["De Luca", "usable after"] == said


test_what_makes_no_table_is_refused = refuses(
    lambda recordings, settings: found(recordings, **settings),
    ([], {}, "there are no recordings"),
    (SEEN[:1], {}, r"1 of 1 recordings can be used, and two are needed.*between\(\)"),
    ([replace(each, truth=None) for each in SEEN], {"references": ("laser",)}, "0 of 4 (?s:.*) it has no laser"),
    (SEEN, {"after": (30.0,)}, "0 of 4 (?s:.*)the first error is asked for after 30 s"),
    (SEEN, {"after": ()}, "1 references and 0 times after"),
    (SEEN, {"after": (np.nan,)}, "after is .*finite and not negative"),
    (SEEN, {"references": ("sonar",)}, "it has no sonar to compare with"),
    (SEEN, {"choosing": SEEN[:1]}, "in both halves"),
    (SEEN[1:], {"choosing": [SEEN[0].between(0, 0.5)]}, "3 of 4 recordings can be used"),
    (SEEN, {"candidates": {}}, "at least one candidate"),
    (SEEN, {"candidates": {de_luca: ()}}, "at least one candidate"),
    (SEEN, {"candidates": {de_luca: ({"hidden_gain": -1},)}}, "out of range"),
    (SEEN, {"max_tracks": 1}, "max_tracks is 1; two are needed"),
)


def test_recordings_of_another_motion_than_the_form_are_refused():
    with pytest.raises(DoesNotFit, match="use the same kind of motion for both"):
        found(form=PerspectiveSystem(rigid(), pinhole()).measure("y1", "y2"))


def test_of_many_recordings_some_are_enough(monkeypatch):
    monkeypatch.setattr("percept_obs.studies.all_observers.MOST_CHOOSING", 2)
    many = [replace(each, source=f"{k}") for k, each in enumerate(SEEN * 2)]
    one_call = found(many, start={"y3": 0.1})
    assert [each.source for each in one_call.choosing] == ["0", "4"]
    assert [each.source for each in one_call.reporting] == ["1", "2", "3", "5", "6", "7"]
    assert "2 recordings, evenly sampled, are enough to choose gains on" in repr(one_call)
    one_call = found(many, start={"y3": 0.1}, split="earlier and later")
    assert [len(one_call.choosing), len(one_call.reporting)] == [2, 4]
    one_call = found(many[:7], start={"y3": 0.1}, max_tracks=3)
    assert sorted(each.source for each in (*one_call.choosing, *one_call.reporting)) == ["0", "3", "6"]
    assert "3 of 7 recordings were taken, evenly sampled" in repr(one_call)


# Without a truth.

BLIND = [replace(each, truth=None) for each in SEEN]


def test_without_a_truth_and_a_filter_least_squares_stand_for_it():
    one_call = found(BLIND, after=(1.0, 2.0))
    names = [f"{LEAST_SQUARES} {seconds} s" for seconds in (1, 2)]
    line = one_call.summary.loc["De Luca"]
    assert one_call.summary.loc[LEAST_SQUARES, names].isna().all()
    true = found(SEEN, after=(1.0, 2.0), start=one_call.start).summary
    for name, truth in zip(names, ("truth 1 s", "truth 2 s"), strict=True):
        off, error = true.loc[LEAST_SQUARES, f"{truth}_most"], true.loc["De Luca"]
        assert abs(line[name] - error[truth]) < (1 + error[f"{truth}_most"]) * off / (1 - off)
    assert line["trusted"] in {0.0, 0.5, 1.0}
    assert one_call.start["y3"] == pytest.approx(found(SEEN, after=(1.0,)).start["y3"], rel=0.2)
    for said in ("There is no truth: the table has differences from least squares", "differences on 2 others"):
        assert said in repr(one_call)
    claims = ["claimed 1 s", "claimed 2 s", "trusted at the end"]
    assert one_call.side_by_side.columns.tolist()[-5:] == [*claims, "cost", "remark"]


@pytest.mark.night(reason="a search of a filter's gains")
@pytest.mark.slow
def test_without_a_truth_the_filter_is_tuned_by_its_likelihood():
    one_call = found(BLIND, candidates=GAINS | {ekf: ekf.candidates}, after=(1.0, 2.0))
    line = one_call.summary.loc["extended Kalman"]
    assert np.isnan(line["extended Kalman 1 s"])
    assert line["trusted"] == 1
    rows = one_call.table[one_call.table["observer"] == "extended Kalman"]
    noise = float(rows["gains"].iloc[0].split()[1].rstrip(","))
    assert noise == pytest.approx(NOISY.noise.variance, rel=0.4)
    errors = found(SEEN, candidates={ekf: ({"noise_variance": noise},)}, after=(1.0, 2.0), start=one_call.start).summary
    for seconds in (1, 2):
        assert errors.loc["extended Kalman", f"truth {seconds} s"] < 4 * line[f"claimed {seconds} s"]
    assert "tuned by the likelihood of its innovations" in one_call._repr_html_()


def test_without_a_truth_what_nothing_estimates_is_left_out_and_measured_distances_are_named():
    lost = np.where(np.arange(len(BLIND[1].time))[:, None] < 1, BLIND[1].outputs, np.nan)
    laser = [replace(each, distances={"laser": np.ones(len(each.time))}) for each in BLIND]
    one_call = found([*laser, replace(laser[0], outputs=lost)], after=(1.0,))
    assert len(one_call.choosing) == len(one_call.reporting) == 2
    assert "1 recordings are left out, for least squares on 2 s has no estimate" in repr(one_call)
    assert "name references, such as laser" in repr(one_call)
    one = [replace(each, outputs=each.outputs[:, :1], names=("y1",)) for each in BLIND]
    with pytest.raises(ValueError, match="no filter or least squares for its place; add a filter to candidates"):
        found(one)


# Beside the Cramer-Rao bound.


@pytest.mark.night(reason="scatter of eight recordings of each scene")
@pytest.mark.slow
def test_nobody_is_below_the_bound_beyond_chance_and_only_filters_come_near_it():
    cases = compared(8, {make: make.candidates[-4:] for make in (ibo, ekf, ismo)}, real=False)
    for found in (each.summary.drop(LEAST_SQUARES, errors="ignore") for each in cases.values()):
        known = found[np.isfinite(found["over_bound"])]
        assert len(known) >= 2
        assert (known["over_bound"] + 3 * known["over_bound_scatter"] > 1).all()
        assert found.loc["extended Kalman", "over_bound"] < 2
        assert found.loc["identifier-based", "over_bound"] > 4
    refused = cases["Ma (35), y1 alone"].table["refusal"]
    assert "measure every image coordinate" in max(refused)
    assert "Ma (35), y1 alone: " in figures.efficiencies(cases).text
