"""One call runs every observer on any set of recordings, and says which recordings and times were left out and why."""

from dataclasses import replace

import numpy as np
import pytest
from examples import BOTH, NOISY, ZERO

from percept_obs import ekf, record, rigid, scenarios, track
from percept_obs.observers import de_luca, immersion_and_invariance, integral_sliding_mode, sliding_mode
from percept_obs.studies.all_observers import LEAST_SQUARES, all_observers
from percept_obs.studies.comparison import relative_distance_errors
from percept_obs.studies.tuning import choose_and_report

SEEN = [record(scenarios.ma2005_eq35(), 2.5, replace(NOISY, period=0.05), seed) for seed in range(4)]
GAINS = {de_luca: ({"measured_gain": 5.0, "hidden_gain": 1.0}, {"measured_gain": 10.0, "hidden_gain": 5.0})}


def found(recordings=SEEN, candidates=GAINS, **settings):
    return all_observers(recordings, candidates=candidates, **settings)


@pytest.mark.slow
def test_it_is_what_choosing_and_reporting_finds():
    start = {"y3": 1 / (2 * np.median(np.concatenate([1 / each.truth[:, 2] for each in SEEN[::2]])))}
    table = choose_and_report(SEEN[::2], SEEN[1::2], BOTH, lambda r, o: track(r, o, start), GAINS, after=(1.0, 2.0))
    one_call = found()
    mine = one_call.table[one_call.table["observer"] == "De Luca"].reset_index(drop=True)
    assert mine.drop(columns="cost").equals(table.drop(columns="cost"))
    assert one_call.start == pytest.approx(start)
    assert one_call.left_out == {"errors after 3 s": "no recording in one of the halves lasts longer than 2.5 s"}
    assert set(one_call.table["observer"]) == {"De Luca", LEAST_SQUARES}


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
    one = [replace(each, outputs=each.outputs[:, :1], names=("y1",)) for each in SEEN]
    one_call = found(one, candidates={immersion_and_invariance: ({},), sliding_mode: ({},)})
    assert LEAST_SQUARES not in set(one_call.table["observer"])
    assert set(one_call.table["observer"]) == {"immersion and invariance", "sliding mode"}


def test_steps_that_are_too_long_are_told_beside_the_numbers():
    one_call = found(candidates={integral_sliding_mode: ({"sharpening": 10.0},)})
    line = one_call.side_by_side.loc["integral sliding mode"]
    assert "too fast for a step of 0.01 s" in line["remark"]
    assert line["truth 1 s"] != "–"


def test_references_that_are_known_now_and_then_count_when_they_are():
    sparse = SEEN[0].truth[:, 2].copy()
    laser = np.where(np.arange(len(sparse)) % 7 == 0, 1 / sparse, np.nan)
    run = track(replace(SEEN[0], distances={"laser": laser}), de_luca(BOTH), ZERO)
    error = relative_distance_errors([run], 1.0, "laser")
    k = 21  # 1.05 s, the first one from 1 s on
    assert error == pytest.approx(abs(run.distance[k] * sparse[k] - 1))


@pytest.mark.parametrize(
    ("recordings", "settings", "message"),
    [
        ([], {}, "there are no recordings"),
        (SEEN[:1], {}, r"1 of 1 recordings can be used, and two are needed.*between\(\)"),
        ([replace(each, truth=None) for each in SEEN], {"references": ("laser",)}, "0 of 4 .* it has no laser"),
        (SEEN, {"after": (30.0,)}, "0 of 4 .*the first error is asked for after 30 s"),
        (SEEN, {"after": ()}, "1 references and 0 times after"),
        (SEEN, {"after": (np.nan,)}, "after is .*finite and not negative"),
        (SEEN, {"split": "at random"}, "the split 'at random' is none of"),
        (SEEN, {"references": ("sonar",)}, "it has no sonar to compare with"),
    ],
)
def test_what_makes_no_table_is_refused(recordings, settings, message):
    with pytest.raises(ValueError, match=f"(?s){message}"):
        found(recordings, **settings)


# Many recordings, and none with a truth.

BLIND = [replace(each, truth=None) for each in SEEN]


def test_of_many_recordings_some_are_enough_to_choose_on(monkeypatch):
    monkeypatch.setattr("percept_obs.studies.all_observers.MOST_CHOOSING", 2)
    many = [replace(each, source=f"{k}") for k, each in enumerate(SEEN * 2)]
    one_call = found(many, start={"y3": 0.1})
    assert [each.source for each in one_call.choosing] == ["0", "4"]
    assert [each.source for each in one_call.reporting] == ["1", "2", "3", "5", "6", "7"]
    assert "2 recordings, evenly sampled, are enough to choose gains on" in repr(one_call)
    one_call = found(many, start={"y3": 0.1}, split="earlier and later")
    assert [len(one_call.choosing), len(one_call.reporting)] == [2, 4]


def test_at_most_so_many_tracks_are_taken_evenly():
    many = [replace(each, source=f"{k}") for k, each in enumerate(SEEN + SEEN[:3])]
    one_call = found(many, start={"y3": 0.1}, max_tracks=3)
    assert sorted(each.source for each in (*one_call.choosing, *one_call.reporting)) == ["0", "3", "6"]
    assert "3 of 7 recordings were taken, evenly sampled" in repr(one_call)
    with pytest.raises(ValueError, match="max_tracks is 1; two are needed"):
        found(many, max_tracks=1)


def test_without_a_truth_and_a_filter_least_squares_stand_for_it():
    one_call = found(BLIND, after=(1.0, 2.0))
    table = one_call.table.set_index("observer")
    assert set(table["reference"]) == {LEAST_SQUARES}
    assert table.loc[LEAST_SQUARES, ["median", "nine_in_ten"]].isna().all(axis=None)
    true = found(SEEN, after=(1.0, 2.0), start=one_call.start).table.set_index("observer")
    errors, off = (true.loc[name, ["median", "nine_in_ten"]].to_numpy(float) for name in ("De Luca", LEAST_SQUARES))
    differences = table.loc["De Luca", "median"].to_numpy()
    assert (abs(differences - errors[:, 0]) < (1 + errors[:, 1]) * off[:, 1] / (1 - off[:, 1])).all()
    assert set(table["trusted"]) <= {0.0, 0.5, 1.0}
    assert one_call.start["y3"] == pytest.approx(found(SEEN, after=(1.0,)).start["y3"], rel=0.2)
    for said in ("There is no truth: the table has differences from least squares", "differences on 2 others"):
        assert said in repr(one_call)
    assert one_call.side_by_side.columns.tolist()[-5:] == [
        "claimed 1 s",
        "claimed 2 s",
        "trusted at the end",
        "cost",
        "remark",
    ]


@pytest.mark.slow
def test_without_a_truth_the_filter_is_tuned_by_its_likelihood():
    one_call = found(BLIND, candidates=GAINS | {ekf: ekf.candidates}, after=(1.0, 2.0))
    table = one_call.table.set_index("observer")
    assert set(table["reference"]) == {"extended Kalman"}
    assert table.loc["extended Kalman", "median"].isna().all()
    assert (table.loc["extended Kalman", "trusted"] == 1).all()
    noise = float(table.loc["extended Kalman", "gains"].iloc[0].split()[1].rstrip(","))
    assert noise == pytest.approx(NOISY.noise.variance, rel=0.4)
    claimed = table.loc["extended Kalman", "claimed"].to_numpy()
    errors = found(SEEN, candidates={ekf: ({"noise_variance": noise},)}, after=(1.0, 2.0), start=one_call.start).table
    errors = errors[errors["observer"] == "extended Kalman"]["median"].to_numpy()
    assert (errors < 4 * claimed).all()
    assert "tuned by the likelihood of its innovations" in one_call._repr_html_()


def test_one_output_without_a_truth_needs_a_filter():
    one = [replace(each, outputs=each.outputs[:, :1], names=("y1",)) for each in BLIND]
    with pytest.raises(ValueError, match="no filter or least squares for its place; add a filter to candidates"):
        found(one)
    with pytest.raises(ValueError, match="every observer needs at least one candidate"):
        found(BLIND, candidates={de_luca: ()})


def test_without_a_truth_what_nothing_estimates_is_left_out_and_measured_distances_are_named():
    lost = np.where(np.arange(len(BLIND[1].time))[:, None] < 1, BLIND[1].outputs, np.nan)
    laser = [replace(each, distances={"laser": np.ones(len(each.time))}) for each in BLIND]
    one_call = found([*laser, replace(laser[0], outputs=lost)], after=(1.0,))
    assert len(one_call.choosing) == len(one_call.reporting) == 2
    assert "1 recordings are left out, for least squares on 2 s has no estimate" in repr(one_call)
    assert "name references, such as laser" in repr(one_call)
