"""A bad call ends at once, in a right result or in an error of ours that names the argument and what to do."""

import json
import subprocess
import sys
from pathlib import Path

import bad_calls
import pytest
from sample_sizes import sampled

COUNT, SEED, QUICK = sampled(300, 1200), 11, 60


@pytest.mark.slow
def test_the_calls_work_before_they_are_spoilt():
    for _, function, arguments in bad_calls.calls():
        function(*arguments.get("*", []), **{key: value for key, value in arguments.items() if key != "*"})


@pytest.mark.slow
def test_no_text_runs_as_code():
    ends = [
        bad_calls.outcome(function, arguments, key, text)
        for _, function, arguments in bad_calls.calls()
        for key in arguments
        for text in (bad_calls.CANARY, [bad_calls.CANARY, 0, 1], {bad_calls.CANARY: bad_calls.CANARY})
    ]
    assert len(ends) > 500
    assert "it ran text" not in ends


def test_a_sample_of_bad_calls():
    ends = [bad_calls.outcome(*call[1:]) for call in bad_calls.drawn(QUICK, SEED)]
    assert set(ends) <= {"right", "ours"}, [end for end in ends if end not in ("right", "ours")]
    assert ends.count("ours") > QUICK / 2


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="only Linux says and limits how much memory a process uses")
def test_bad_calls_within_time_and_memory():
    program = [sys.executable, str(Path(bad_calls.__file__)), str(COUNT), str(SEED)]
    found = json.loads(subprocess.check_output(program, text=True))
    assert found["others"] == []
    assert found["right"] + found["ours"] == COUNT
    assert found["ours"] > COUNT / 2
