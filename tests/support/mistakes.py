"""Typical mistakes in the notebooks' exercises: by notebook and solution, at least three each."""

MISTAKES = {
    "00_start": {
        "quotient": [
            "y1' = b1 y3 + b3 y1 y3",  # the sign of the second term
            "y1' = b1 y3",  # the derivative of 1/Z is forgotten
            "y1' = b1 y3 - b3 y1 y3^2",
            "y1' = b1 y3 - b3 y2 y3",
            "y2' = b2 y3 - b3 y2 y3",  # right, and not asked for
        ],
        "second": ["a", "b", "d"],
        "gain": [1, 3, 15, 30],
    },
    "01_perspective_dynamics": {
        "turning": [
            "y1' = -w_c2 + w_c3 y2",  # the derivative of 1/Z is forgotten
            "y1' = -w_c2 + w_c3 y2 + y1 (w_c2 y1 - w_c1 y2)",
            "y1' = -w_c3 + w_c2 y2 - y1 (w_c2 y1 - w_c1 y2)",
            "y1' = -w_c2 + w_c3 y2 - w_c2 y1 + w_c1 y2",
        ],
        "excited": ["a", "b", "c"],
        "gain-for-one": [2, 3, 8, 10, 20],
    },
    "02_two_observers": {
        "slow": [
            "e3' = -G P (b1^2 + b2^2) e3 / A",
            "e3' = G^2 P (b1^2 + b2^2) e3 / A",  # one G is not divided out
            "e3' = G P (b1 + b2)^2 e3 / A",
            "e3' = G P (b1^2 + b2^2) e3",
        ],
        "double": ["a", "b", "d"],
        "gains": [
            {"gain": 10, "lyapunov": -0.5},
            {"gain": 20, "lyapunov": -0.5},
            {"gain": 8, "lyapunov": -0.5},
            {"gain": 10, "lyapunov": -2},
        ],
    },
    "03_real_camera": {
        "translating": [
            ["y1' = (v1 - v3 y1) y3", "y2' = (v2 - v3 y2) y3"],  # as if the landmark moved with v
            ["y1' = -v1 y3", "y2' = -v2 y3"],
            ["y1' = (v3 y1 - v1) y3", "y2' = (v3 y1 - v2) y3"],
            ["y1' = (v3 y1 - v1) y3"],  # one line is missing
        ],
        "far-start": ["a", "c", "d"],
        "sooner": [
            {"gain": 5, "push": 100},
            {"gain": 1, "push": 50},
            {"gain": 10, "push": 50},
            {"gain": 1, "push": 400},
        ],
    },
    "04_all_observers": {
        "spring": ["s^2 + H s - Lambda b1^2", "s^2 - H s + Lambda b1^2", "s^2 + H s + Lambda b1", "s^2 + Lambda b1^2"],
        "same-numbers": ["b", "c", "d"],
        "from-the-sample": [
            {"measured_gain": 5, "hidden_gain": 10},  # the gains it comes with
            {"measured_gain": 5, "hidden_gain": 100},
            {"measured_gain": 20, "hidden_gain": 50},
            {"measured_gain": 10, "hidden_gain": 100},
        ],
    },
    "05_structure_and_motion": {
        "which-velocity": ["v_c1 ybar3", "v_c3 ybar3", "v_c2", "v_c2 y1 ybar3"],
        "twice-as-fast": ["a", "c", "d"],
        "switching": [5, 15, 30, 60],
    },
    "06_many_points": {
        "second-point": [
            "r_x + d2_x - y1_2 r_z",  # the point is at r + d2 in depth as well
            "r_x + d2_x + y1_2 (r_z + d2_z)",
            "r_x + d2_x - y1_1 (r_z + d2_z)",
            "d2_x - y1_2 d2_z",
        ],
        "hide-the-first": ["a", "b", "d"],
        "noisy-point": [1 / 3, 1, 10],
    },
    "07_your_own_recording": {
        "lost-motion": [
            "h^2 / 10",  # of a third derivative of 1, and here it is 6
            "3 h^2",  # the velocity at the end of the window
            "h^2",  # the slope of the chord
            "3 h / 5",
        ],
        "half-the-poses": ["a", "b", "d"],
        "own-window": [0.01, 0.03, 0.5, 1.0],
    },
    "08_check_a_derivation": {
        "tilted": [
            "y1' = (b1 + y1 (n1 b1 + n2 b2 + n3 b3)) y3",
            "y1' = b1 y3",  # the derivative of 1/eta is forgotten
            "y1' = (b1 - n3 b3 y1) y3",  # as if the plane were upright
            "y1' = (b1 - y1 (n1 b1 + n2 b2 + n3 b3)) y3^2",
        ],
        "which-step": ["a", "b", "d"],
        "derived-gain": [3, 5, 30],
    },
    "09_reading_papers": {
        "xi": [
            "xi2' = G w P xi1 + (g - ghat) / G^2",  # as it is printed
            "xi2' = -G^2 w P xi1 + (g - ghat) / G^2",
            "xi2' = -G w P xi1 + g - ghat",
            "xi2' = -w P xi1 + (g - ghat) / G^3",  # in the time s
        ],
        "window": ["a", "b", "d"],
        "plan": [10, 28, 60],
        "enter": [
            "chi' = -v_z chi^2 + (y omega_x - x omega_y) chi",
            "chi' = v_z chi^2 - (y omega_x - x omega_y) chi",  # the world turns, not the camera
            "chi' = v_z chi + (y omega_x - x omega_y) chi",
            "chi' = v_z chi^2",
        ],
    },
    "10_imaging_surfaces": {
        "direction": [
            "y1' = b1 y4",  # the range's own change is forgotten
            "y1' = (b1 + y1 (b1 y1 + b2 y2 + b3 y3)) y4",
            "y1' = (b1 - b3 y1) y4",  # that of the pinhole
            "y1' = b1 - y1 (b1 y1 + b2 y2 + b3 y3)",
        ],
        "ahead": ["a", "b", "d"],
        "lens": [0.0, 0.5, 0.8, 1.0],
    },
    "11_observability": {
        "rate": [
            "y1' = a12 y2 - b1 y3",
            "y1' = a12 y2 + b1",  # divided by Z in the first term only
            "y1' = a12 y1 y2 + b1 y3",
            "y1' = a12 y2",
        ],
        "dip": ["a", "b", "d"],
        "best": [(0, 0, 1), (1, 0, 0), (0.4, 0.2, 1), (-0.2, 0.4, 0)],
    },
    "12_the_limit": {
        "linear": ["e3' = -b3 y3 e3", "e3' = 2 b3 y3 e3", "e3' = -2 b3 y3^2 e3", "e3' = -b3 y3^2"],
        "half": ["a", "b", "d"],
        "wait": [2, 5, 7, 10],
    },
    "13_maps_and_basins": {
        "scale-formula": ["x - s y3", "s x + y3", "x - y3"],
        "too-slow": ["a", "c", "d"],
        "quiet": [6, 10, 30],
    },
    "14_a_million_runs": {
        "enough": ["p (1 - p) - N s", "p - N s^2", "p (1 - p) N - s^2"],
        "four": ["a", "c", "d"],
        "tail-gain": [8, 10, 16],
    },
    "15_where_scale_comes_from": {
        "growing": [
            "s' = b3 s y3",  # the sign
            "s' = -b3 y3^2",  # the rate of y3
            "s' = -b3 s",
            "s' = -b3 s y3^2",
        ],
        "bigger": ["a", "c", "d"],
        "slow": [0.3, 0.6, 1.2],
    },
    "16_your_own_film": {
        "baseline": [
            "Z s / (f B)",  # the relative error
            "-Z^2 s / (f B)",  # the sign
            "Z^2 s / B",
            "Z s / f",  # what the error is across, not along
        ],
        "twice": ["a", "b", "d"],
        "carry": [
            (0, 0, 0.06),  # the point in the middle is told nothing
            (0.02, 0, 0),
            (0.2, 0, 0),  # off the table
            (0, 0, 0),
        ],
    },
    "17_closing_the_loop": {
        "error": [
            "e' = k y3 e / x",  # the sign
            "e' = -k x e / y3",  # the truth for the belief
            "e' = -k e",
            "e' = -k y3 e",
        ],
        "half": ["a", "b", "d"],
        "brisk": [0.5, 1, 1.5, 6],
    },
}
