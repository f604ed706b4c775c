"""A lens that folds is told by the directions that it maps, other boards are named, and short tracks are left out."""

import numpy as np
import pytest
from cv2 import aruco

from percept_obs import Camera, diagnose, record, scenarios
from percept_obs.film.board import Board, other_markers
from percept_obs.film.lens import reaches


@pytest.mark.parametrize(
    ("lens", "corner", "reached"),
    [((-0.33, 0), 1.0, False), ((-0.33, 0), 0.669, False), ((-0.33, 0), 0.5, True), ((0.1, 0.05), 0.8, True)],
)
def test_a_lens_that_folds_reaches_no_corner(lens, corner, reached):
    assert reaches(np.array(lens, dtype=float), corner) is reached


@pytest.mark.parametrize("name", ["DICT_5X5_100", "DICT_APRILTAG_36h11"])
def test_a_board_of_other_markers_is_named(name):
    board = aruco.CharucoBoard((7, 5), 0.036, 0.027, aruco.getPredefinedDictionary(getattr(aruco, name)))
    picture = board.generateImage((700, 500), marginSize=40)
    assert "another dictionary" in other_markers(picture)[0]
    assert "white on black" in other_markers(255 - picture)[0]
    assert other_markers(Board().picture()) == []


def test_a_track_of_a_few_samples_is_left_out_of_a_diagnosis():
    whole = record(scenarios.ma2005_eq35(), 3, Camera(0.05))
    found = diagnose([whole, whole.between(0, 0.2)])
    assert (found.looked_at, found.too_short) == (1, 1)
    assert "1 were left out" in found.sentence
    with pytest.raises(ValueError, match="give longer poses or longer tracks"):
        diagnose(whole.between(0, 0.2))
