"""The corollaries of the paper as settings of the lab."""

from __future__ import annotations

from typing import Any

from percept_obs.structure import COROLLARIES
from percept_obs.structure.scenarios import chwa2019_experiment


def case_of(number: int) -> dict[str, Any]:
    """Settings in which a corollary holds: the paper's values where it states some, and velocities that swing."""
    corollary = COROLLARIES[number - 1]
    stated = corollary.choice()
    fixed: dict[str, Any] = {"unknown": list(stated.unknown), "earlier": "d_s" in stated.earlier, "w": [0.0] * 3}
    if number in (3, 5):
        swings = [[0.3, 0.3, -0.1], [0.2, 0.2, 0.1 if number == 5 else 0.0]]
        return fixed | {
            **{"ybar": [0.4, 0.4, 0.05], "scale": 4.0, "v_c": [0.0, 0.0, -0.3], "v_p": [0.0] * 3, "rate": 1.0},
            **{"v_c_swing": swings[0], "v_p_swing": swings[1]},
        }
    case = chwa2019_experiment(corollary.section)
    known = case.motion.known(0.0)[0].tolist()
    return fixed | {
        **{"ybar": [0.32, 0.3, 0.05], "scale": case.scale, "v_c": known[3:6], "v_p": known[6:]},
        **{"v_c_swing": [0.0] * 3, "v_p_swing": [0.0] * 3},
    }
