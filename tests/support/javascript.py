"""Run printed JavaScript in Node.js."""

import json
import subprocess
from pathlib import Path

import numpy as np

from percept_obs.compile import Trace, source
from percept_obs.compile.integrator import EACH


def run_script(node, script, task):
    """Answer of a script to a task, both as JSON."""
    task = json.dumps(task, allow_nan=False)
    answer = subprocess.run([node, script], input=task, capture_output=True, encoding="utf-8", check=False)
    assert answer.returncode == 0, answer.stderr
    return json.loads(answer.stdout)


def solve_in_node(node, equations, start, table, gains):
    """What `percept_obs.compile.solve` does, in JavaScript."""
    size, count = len(equations.state), len(table.steps) + 1
    measured = np.broadcast_to(table.measured, (count - 1, EACH + 1, len(equations.measured)))  # as in the page
    blocks = (start, table.steps, measured, table.parameters, table.samples, gains)
    flat = [[None if np.isnan(v) else v for v in np.ravel(np.asarray(b, dtype=float)).tolist()] for b in blocks]
    task = {
        "source": source(equations, "javascript"),
        "inputs": flat,
        "varying": len(table.parameters) > 1,
        "size": size,
        "count": count,
    }
    left = run_script(node, Path(__file__).with_name("run_kernel.mjs"), task)
    states = np.array([np.nan if v is None else v for v in left["states"]]).reshape(count, size)
    return Trace(states, np.array(left["resets"]) != 0, None if left["diverged"] < 0 else left["diverged"])
