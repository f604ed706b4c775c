"""A comparison shows every observer the same noise, and says what became of each run."""

import math

import numpy as np
import pytest
from examples import BOTH, NOISY, ONE, ZERO
from refusals import refuses

from percept_obs import Camera, ekf, ibo, pinhole, record, scenarios, smo, track
from percept_obs.cli import main
from percept_obs.recording import Recording
from percept_obs.studies.comparison import best_setting, compare, relative_distance_errors, summary

RECORDINGS = [record(scenarios.ma2005_eq35(), 5, NOISY, seed=s) for s in range(3)]


def test_a_row_is_a_run():
    table = compare(RECORDINGS, [ibo(BOTH), ekf(BOTH)], ZERO, after=2)
    assert list(table["observer"]) == ["identifier-based", "extended Kalman"] * 3
    run = track(RECORDINGS[1], ibo(BOTH), ZERO)
    row = table.iloc[2]
    assert row["recording"] == RECORDINGS[1].source
    assert row["settling_time"] == run.settling_time()
    assert row["outcome"] == run.outcome().kind == "converged"
    assert row["final"] == abs(run.error[-1, 2])
    assert row["rms"] == pytest.approx(run.rms(2, 5, "y3"))
    assert row["worst"] == np.abs(run.error[200:, 2]).max()
    assert (row["resets"], row["diverged_at"]) == (0, math.inf)
    assert row["cost"] > 0


def test_failures_resets_and_divergences_are_counted():
    observers = {
        "good": ibo(BOTH),
        "bounded": ibo(BOTH, bound=0.3),
        "blown": smo(BOTH, switching_gain=1e150, bound=1e160),
    }
    found = summary(compare(RECORDINGS, observers, ZERO))
    assert found["failed"].to_dict() == {"good": 0, "bounded": 3, "blown": 3}
    assert found.loc[["good", "bounded"], "reset"].tolist() == [0, 3]
    assert found["diverged"].to_dict() == {"good": 0, "bounded": 0, "blown": 3}
    assert found.loc["blown", "rms"] == math.inf
    assert found.loc["good", "rms_low"] <= found.loc["good", "rms"] <= found.loc["good", "rms_high"]
    assert (found["runs"] == 3).all()


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


def test_the_best_setting_has_the_least_median_error():
    recordings = [record(scenarios.ma2005_eq35(), 3, Camera(), seed=0)]

    def follow(recording, observer):
        return track(recording, observer, ZERO)

    settings = [ibo(BOTH, gain=g) for g in (2, 10, 20)]
    errors = [relative_distance_errors([follow(recordings[0], s)], 1.0)[0] for s in settings]
    assert best_setting(recordings, settings, follow, (1.0,)) is settings[int(np.argmin(errors))]


def test_the_table_is_printed_from_one_command(capsys):
    assert main(["compare", "--seeds", "2", "--duration", "2"]) == 0
    printed = capsys.readouterr().out
    for name in ("identifier-based", "extended Kalman", "De Luca", "Spica", "immersion", "linear approximation"):
        assert name in printed
    assert "y2, y3 are hidden; measure every image coordinate" in printed
    with pytest.raises(SystemExit):
        main(["compare", "--seeds", "0"])
    assert "not a positive number" in capsys.readouterr().err
