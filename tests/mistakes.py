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
            "y1' = w2 - w3 y2",  # the derivative of 1/Z is forgotten
            "y1' = w2 - w3 y2 + y1 (w1 y2 - w2 y1)",
            "y1' = w3 - w2 y2 - y1 (w1 y2 - w2 y1)",
            "y1' = w2 - w3 y2 - w1 y2 + w2 y1",
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
}
