"""Figures of comparisons show every run with its spread, count failures, and say all of it in words."""

import numpy as np
import pytest
from examples import BOTH, NOISY, ONE, ZERO

from percept_obs import figures, record, scenarios
from percept_obs.observers import de_luca, extended_kalman, identifier_based, sliding_mode
from percept_obs.studies.chatter import chatter, effort
from percept_obs.studies.comparison import compare, summary

RECORDINGS = [record(scenarios.ma2005_eq35(), 5, NOISY, seed) for seed in range(4)]
OBSERVERS = {
    "good": extended_kalman(ONE),
    "bounded": identifier_based(BOTH, bound=0.3),
    "blown": sliding_mode(BOTH, switching_gain=1e150, bound=1e160),
}


@pytest.fixture(scope="module")
def table():
    return compare(RECORDINGS, OBSERVERS, ZERO, after=2)


def drawn_at(ax, place, marker):
    """Abscissae of the markers of a kind that stand in a row."""
    lines = [line for line in ax.lines if line.get_marker() == marker]
    return [x for line in lines for x, y in zip(*line.get_data(), strict=True) if y == place]


def test_every_run_its_median_and_its_spread_are_drawn(table):
    settling, rms = figures.comparison(table).axes
    found = summary(table).loc["good"]
    for ax, column in ((settling, "settling_time"), (rms, "rms")):
        runs = table.loc[table["observer"] == "good", column]
        ends = [found[f"{column}_low"], found[f"{column}_high"]]
        assert sorted(drawn_at(ax, 0, "|")) == pytest.approx(sorted([*runs, *ends]))
        assert drawn_at(ax, 0, "o") == [found[column]]


def test_what_is_missing_stands_at_the_edge_and_is_counted(table):
    settling, rms = figures.comparison(table).axes
    for ax, places in ((settling, [1, 2]), (rms, [2])):
        crosses = [x for place in range(3) for x in drawn_at(ax, place, "X")]
        assert [place for place in range(3) if drawn_at(ax, place, "X")] == places
        finite = table[["settling_time", "rms"][ax is rms]]
        assert min(crosses) > finite[np.isfinite(finite)].max()
        assert max(crosses) < ax.get_xlim()[1]
    labels = [label.get_text() for label in settling.get_yticklabels()]
    assert labels == ["good\n0 of 4 fail", "bounded\n4 of 4 fail, 4 reset", "blown\n4 of 4 fail, 4 reset, 4 diverge"]


def test_the_text_has_medians_spreads_and_counts(table):
    found, text = summary(table), figures.comparison(table).text
    good = found.loc["good"]
    assert f"good: 0 of 4 fail; settling time {good['settling_time']:.2g} s in the median" in text
    assert (
        f"rms error {good['rms']:.2g} 1/m in the median, {good['rms_low']:.2g} 1/m to {good['rms_high']:.2g} 1/m"
        in text
    )
    assert "bounded: 4 of 4 fail, 4 reset; settling time none in the median" in text
    assert "blown: 4 of 4 fail, 4 reset, 4 diverge; settling time none in the median" in text


def test_a_single_run_that_fails_can_be_drawn(table):
    figure = figures.comparison(table[table["observer"] == "blown"].head(1))
    assert "blown: 1 of 1 fail, 1 reset, 1 diverge" in figure.text
    figure._repr_html_()


@pytest.fixture(scope="module")
def chattering():
    scenario = scenarios.ma2005_eq35()
    smooth, switching = sliding_mode(BOTH), sliding_mode(BOTH, switch="sign")
    errors = {"sign": chatter(record(scenario, 2), switching, [0.01, 0.005], ZERO, 1)}
    efforts = {"sign": effort(scenario, switching, 2, most=2000), "fraction": effort(scenario, smooth, 2)}
    return errors, efforts


def test_chatter_draws_errors_over_steps_and_steps_over_time(chattering):
    errors, efforts = chattering
    left, right = figures.chatter(errors, efforts).axes
    np.testing.assert_array_equal(left.lines[0].get_data(), errors["sign"][["step", "y3"]].T)
    for line, one in zip(right.lines, efforts.values(), strict=True):
        np.testing.assert_array_equal(line.get_data(), [one.time[1:], one.steps])
    assert left.lines[0].get_linestyle() == right.lines[0].get_linestyle() != right.lines[1].get_linestyle()
    names = [[text.get_text() for text in ax.get_legend().get_texts()] for ax in (left, right)]
    assert names == [["sign"], ["fraction"]]


def test_the_text_of_chatter_says_how_each_solver_got_on(chattering):
    errors, efforts = chattering
    text = figures.chatter(errors, efforts).text
    stopped = efforts["sign"]
    assert f"sign: error at a step of 0.01 s {errors['sign']['y3'][0]:.2g}" in text
    assert f"sign: RK45 gave up at {stopped.time[-1]:.2g} s after {stopped.evaluations[-1]} evaluations" in text
    assert f"fraction: RK45 arrived at 2 s after {efforts['fraction'].evaluations[-1]} evaluations" in text


def test_bad_input_is_refused_in_words(table, chattering):
    for wrong in (table.head(0), table.drop(columns="rms"), summary(table)):
        with pytest.raises(ValueError, match="has no runs"):
            figures.comparison(wrong)
    errors, efforts = chattering
    for given in ((errors, {}), ({}, efforts)):
        with pytest.raises(ValueError, match="at least one of each"):
            figures.chatter(*given)


def test_failures_of_a_part_reach_the_edge():
    """A spread whose upper end has no settling time ends at the edge; the median has its place."""
    observers = {"De Luca": de_luca(BOTH)}
    part = compare(RECORDINGS, observers, ZERO, after=2)
    part.loc[0, "settling_time"] = np.inf
    settling, _ = figures.comparison(part).axes
    assert drawn_at(settling, 0, "o") == [summary(part).loc["De Luca", "settling_time"]]
    assert max(drawn_at(settling, 0, "|")) > part["settling_time"][1:].max()
    assert "1 of 4 fail" in settling.get_yticklabels()[0].get_text()
