"""Settings of the lab of many points that its tests try, and the page's engine run on them in Node.js."""

from functools import lru_cache

import numpy as np

from percept_obs.labs import points_lab
from percept_obs.labs.points.settings import SCHEMA, WEIGHTS
from percept_obs.labs.points.texts import STATES

NOISY = {"kind": "uniform", "size": 0.01}
ONE = {"points": [[0.0, 1.2, 2.5]]}
CASES = {
    "opening": {},
    "independent points": {"state": "independent"},
    "a body with an origin": {"state": "origin", "spin": 0.7},
    "an origin that is lost": {"state": "origin"},
    "one point": ONE,
    "one point and an origin": {**ONE, "state": "origin"},
    "eight points": {"points": [[0.1 * k, 1.2 - 0.1 * k, 2.5 + 0.05 * k] for k in range(8)], "duration": 8.0},
    "a given error": {"start": "error", "error": 0.7},
    "from zero": {"start": "zero"},
    "Riccati": {"weight": "riccati", "size": 0.01},
    "Riccati, independent": {"weight": "riccati", "size": 0.01, "state": "independent", "forgetting": 0.0},
    "Riccati, an origin": {"weight": "riccati", "size": 0.02, "state": "origin", "spin": 1.0},
    "Lyapunov": {"weight": "lyapunov", "size": 2.0, "decrease": 0.02},
    "Lyapunov that runs out": {"weight": "lyapunov", "size": 0.5, "decrease": 0.05},
    "a schedule": {"weight": "scheduled", "size": 0.3, "final": 3.0},
    "hidden": {"hidden": [None, [3.0, 9.0], None]},
    "hidden from the beginning": {"hidden": [[0.0, 4.0], [0.0, 2.0], None]},
    "all but one late": {"hidden": [[0.0, 4.0], [0.0, 4.0], None], "weight": "riccati", "size": 0.01},
    "never seen": {"hidden": [None, [0.0, 99.0], None]},
    "nothing is seen": {"hidden": [[0.0, 99.0]] * 3, "start": "error"},
    "noise, held": {"noise": NOISY, "hold": "zero", "seed": 5},
    "Gaussian noise, a line": {"noise": {"kind": "gaussian", "size": 0.02}, "hold": "first", "seed": 2**32 - 1},
    "lost samples": {"noise": NOISY, "dropout": 0.3, "hold": "zero", "seed": 4, "weight": "riccati", "size": 0.02},
    "lost samples, a line": {"dropout": 0.2, "hold": "first"},
    "a narrow view": {"view": 0.6},
    "no input": {"input": 0.0, "turning": 0.2, "spin": 1.0},
    "no motion": {"input": 0.0, "turning": 0.0},
    "along the line of sight": {
        **ONE,
        "input": 0.0,
        "turning": 0.0,
        "camera_velocity": [0.0, -0.12, -0.25],
        "depth": 1.4,
    },
    "another input": {"camera_velocity": [-0.2, 0.1, -0.3], "turning": 0.5, "spin": 1.5, "input": -0.4},
    "large gain": {"size": 0.05, "step": 0.01, "duration": 10.0},
    "diverges": {"size": 0.001},
    "short steps": {"period": 0.03, "step": 0.004, "duration": 5.0, "window": 2.0},
    "a window as long as the run": {"duration": 5.0, "window": 5.0},
}


@lru_cache(maxsize=1)
def _lab():
    return points_lab()


def run_of(settings):
    """Python's run of settings in the package's own lab."""
    return _lab().runs(settings)


def random_settings(seed):
    """Settings that make sense, drawn over every control of the lab."""
    rng = np.random.default_rng(seed)
    points = int(rng.integers(1, 9))

    def one(*values):
        return values[rng.integers(len(values))]

    weight = one(*WEIGHTS)
    return {
        "state": one(*STATES),
        "points": np.column_stack([rng.uniform(-1, 1, (points, 2)), rng.uniform(1.5, 4, points)]).tolist(),
        "hidden": [one(None, None, sorted(rng.uniform(0, 12, 2).tolist())) for _ in range(points)],
        "turning": float(one(1, rng.uniform(-2, 2))),
        "spin": float(one(0, rng.uniform(-2, 2))),
        "input": float(one(1, 0, rng.uniform(-2, 2))),
        "camera_velocity": one([0.0] * 3, rng.uniform(-0.5, 0.5, 3).tolist()),
        "weight": weight,
        "size": float(rng.uniform(0.02, 0.1) if weight == "riccati" else rng.uniform(0.3, 3)),
        "final": float(rng.uniform(0.3, 3)),
        "decrease": float(rng.uniform(0, 0.1)),
        "forgetting": float(rng.uniform(0, 1)),
        "start": one(*SCHEMA["start"].names),
        "noise": {"kind": one("uniform", "gaussian"), "size": float(one(0, rng.uniform(0, 0.05)))},
        "dropout": float(one(0, rng.uniform(0, 0.9))),
        "seed": int(rng.integers(100)),
        "period": float(rng.uniform(0.02, 0.2)),
        "view": float(rng.uniform(0.5, 3)),
        "hold": one(*SCHEMA["hold"].names),
        "duration": float(rng.uniform(4, 12)),
        "window": float(rng.uniform(0.5, 8)),
    }
