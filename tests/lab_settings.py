"""Settings of the observer lab that its tests try, and the page's engine run on them in Node.js."""

import json
import subprocess
from pathlib import Path

import numpy as np

import percept_obs.labs
from percept_obs.labs.structures import BY_NAME, KEYS, texts_of

FRONT = Path(percept_obs.labs.__file__).parent / "front"

NOISY = {"kind": "uniform", "size": 0.01}
SMOOTH = ["identifier_based", "extended_kalman"]
ALL = list(BY_NAME)
B_AT_THE_SIDE = [0.4, 0.3, 0.3]
PLANE = [0.2, -0.1, 0.9]

SMOOTH_CASES = {
    "opening": {},
    "both filters": {"observers": SMOOTH},
    "y1 alone": {"outputs": ["y1"], "observers": SMOOTH},
    "y2 alone": {"outputs": ["y2"], "observers": SMOOTH, "duration": 30.0},
    "noise and losses": {"noise": NOISY, "dropout": 0.2, "seed": 4, "observers": SMOOTH},
    "Gaussian noise": {"noise": {"kind": "gaussian", "size": 0.005}, "seed": 4294967295, "observers": SMOOTH},
    "a line to the next sample": {"hold": "first", "noise": NOISY, "dropout": 0.3, "period": 0.037},
    "the exact signal": {"hold": "exact", "period": 0.05},
    "start at zero": {"start": {"mode": "zero", "values": [0.0, 0.0, 0.0]}, "observers": SMOOTH},
    "chosen start": {"start": {"mode": "chosen", "values": [0.2, 0.7, 1.0]}, "observers": SMOOTH},
    "another b": {"b": B_AT_THE_SIDE, "observers": SMOOTH},
    "the point leaves": {"b": [0.5, 0.25, -0.9], "observers": SMOOTH, "noise": NOISY, "dropout": 0.1},
    "chained": {"surface": "chained", "observers": SMOOTH},
    "plane": {"surface": "plane", "normal": PLANE, "observers": SMOOTH, "outputs": ["y1"]},
    "gains": {"gains": {"identifier_based": {"gain": 3.7, "noise_variance": 2e-5}}, "noise": NOISY},
    "a motion that is not the true one": {"believed": {"A": np.eye(3).tolist(), "b": [0.1, 0.2, 0.3]}},
    "(36)": {"scenario": "ma2005_eq36", "observers": SMOOTH, "outputs": ["y1"]},
    "few samples": {"period": 0.2, "duration": 1.0, "observers": SMOOTH},
}


def run_in_node(node, lab, tasks):
    """What the page's engine makes of each of the settings, once all parts of the model have come."""
    model = {**lab.model, "structures": {key: texts_of(key) for key in KEYS}}
    task = json.dumps({"model": model, "tasks": tasks}, allow_nan=False)
    script = FRONT / "tests/run_settings.js"
    answer = subprocess.run([node, script], input=task, capture_output=True, text=True, check=False)
    assert answer.returncode == 0, answer.stderr
    return json.loads(answer.stdout)


def as_array(numbers, width):
    """Numbers that came as JSON, where null stands for what is not finite, in rows."""
    return np.array([np.nan if v is None else v for v in numbers]).reshape(-1, width)
