"""Faults of a film of a board are found by name with their size, and a clean film is accused of nothing."""

from dataclasses import replace

import cv2
import numpy as np
import pytest
from film_renderer import quick_film
from film_sightings import BOARD, FAULTS, frames, read, sight
from sample_sizes import sampled

from percept_obs import PixelCamera, Poses
from percept_obs.film import read_film
from percept_obs.film.adjustment import SHUTTER, USUAL, _rows, start
from percept_obs.film.faults import find_faults
from percept_obs.film.sharpness import edge_width

NAMED = {"ms": "rolling shutter", "focus": "focus", "stabilised": "stabilisation"}


def names(found):
    return {each.key for each in found.findings}


@pytest.mark.slow
def test_derivatives_by_every_column_are_those_of_differences():
    film = sight(1)
    pixels, poses = (each[:40] if isinstance(each, np.ndarray) else each for each in (film.pixels, film.read[1]))
    poses = Poses(poses.time[:40], poses.position[:40], poses.orientation[:40])
    corners, state = start(pixels, BOARD.points, np.array(film.size, float), film.read[0], poses)
    own = state.own + 0.1 * USUAL * np.random.default_rng(1).normal(size=18) * ~np.isin(np.arange(18), SHUTTER)
    rows = _rows(corners, replace(state, own=own))[0][corners.seen]
    for column, step in enumerate(1e-3 * USUAL):
        aside = [own + sign * step * np.eye(18)[column] for sign in (1, -1)]
        more, less = (_rows(corners, replace(state, own=each))[0][corners.seen][..., -1] for each in aside)
        by = (less - more) / (2 * step)
        np.testing.assert_allclose(rows[..., 6 + column], by, atol=1e-4 * np.abs(by).max(), err_msg=str(column))


@pytest.mark.slow
def test_a_clean_film_is_accused_of_nothing():
    """Two hundred with ALL_SAMPLES=1, half of them with noise that is correlated over pictures."""
    accused = [seed for seed in range(sampled(2, 200)) if sight(seed, "clean").found.findings]
    assert not accused


@pytest.mark.slow
@pytest.mark.parametrize("fault", [each for each in FAULTS if each != "clean"])
def test_a_fault_is_found_by_name(fault):
    """Twenty films each with ALL_SAMPLES=1; shifted pictures hide other faults, and with them may pass for unknown."""
    wanted = {name for part, name in NAMED.items() if part in fault}
    wanted &= {"stabilisation"} if "stabilised" in fault else wanted
    for seed in range(sampled(1, 20)):
        named = names(sight(seed, fault).found)
        assert named == wanted or ("unknown" in named and "stabilised" in fault), (seed, named)


@pytest.mark.slow
def test_the_time_of_read_out_is_within_its_deviations():
    """Forty films with ALL_SAMPLES=1."""
    films = [sight(seed, fault) for seed in range(sampled(1, 20)) for fault in ("20 ms", "10 ms")]
    off = np.array([(film.found.readout - film.readout) / film.found.deviation for film in films])
    assert np.abs(off).max() < 3.5
    assert np.sqrt((off**2).mean()) < 1.3
    assert np.median([film.found.deviation.min() for film in films]) < 5e-4


@pytest.mark.slow
def test_corners_are_put_to_where_they_were_at_the_time_of_the_picture():
    film = sight(3, "20 ms")
    exact = frames(film.path, film.time, film.size)
    before, after = (np.nanmedian(np.abs(each - exact)) for each in (film.pixels, film.found.corners))
    assert before > 1.5 * after
    assert after < 0.75 * film.found.noise  # half of normal errors are under 0.67 deviations


@pytest.mark.slow
def test_a_fault_whose_name_noise_hides_is_said_to_be_unknown():
    """Twenty films with ALL_SAMPLES=1, with noise that stays alike for a third of a second."""
    named = [names(sight(seed, "stabilised", correlated=(0.9,)).found) for seed in (5, *range(sampled(1, 20)))]
    assert named[0] == {"unknown"}
    assert all(each & {"stabilisation", "unknown"} for each in named)


@pytest.mark.slow
def test_what_is_none_of_the_faults_is_not_passed_over():
    film = sight(2)
    wobble = 0.01 * np.random.default_rng(1).normal(size=(len(film.time), 1))
    sheared = film.pixels + np.stack([wobble * film.pixels[..., 1], 0 * film.pixels[..., 0]], axis=-1)
    assert names(find_faults(film.time, sheared, BOARD, film.size, *read(film.time, sheared, film.size)))


@pytest.mark.slow
def test_a_bent_board_is_named_with_its_size():
    x = BOARD.points[:, 0] - BOARD.points[:, 0].mean()
    film = sight(4, places=BOARD.points + np.outer((x / np.abs(x).max()) ** 2, [0, 0, 0.002]))
    (bent,) = film.found.findings
    assert bent.key == "board"
    assert abs(bent.value) == pytest.approx(0.002, rel=0.05)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("key", "moved"),
    [
        ("no parallax", {"sway": 0.004, "along": 0.004}),
        ("along the axis", {"sway": 0.004, "along": 0.06}),
        ("small board", {"distance": 1.5}),
    ],
)
def test_a_path_that_shows_little_is_named(key, moved):
    for seed in range(sampled(1, 20)):
        named = names(sight(seed, **moved).found)
        assert key in named
        assert named <= {key, "focal length", "lens"}  # the reader's lens may be far off then


@pytest.mark.slow
def test_times_that_vary_or_break_off_are_used_as_they_are():
    draw = np.random.default_rng(1)
    varied = np.cumsum(draw.uniform(0.02, 0.05, 400))
    assert names(sight(1, time=varied).found) == {"frame rate"}
    film = sight(5, "20 ms", time=np.delete(np.arange(450) / 30, slice(200, 260)))
    (rolling,) = film.found.findings
    assert rolling.value == pytest.approx(film.readout.sum(), abs=4 * rolling.deviation)
    again = np.append(film.time, film.time[-1])
    found = find_faults(again, film.pixels[[*range(390), -1]], BOARD, film.size, *film.read)
    assert "1 are no later" in found.findings[-1].evidence


def test_the_width_of_edges_is_that_of_the_blur():
    sharp, pixels = BOARD.picture(80), 80 * BOARD.points[:, :2] / BOARD.square - 0.5
    for sigma in (1.0, 2.0):
        wide = edge_width(cv2.GaussianBlur(sharp, (0, 0), sigma), pixels, BOARD)
        assert wide == pytest.approx(np.sqrt(2 * np.pi) * sigma, rel=0.1)
    moved = cv2.blur(sharp, (5, 1))  # half of the edges are blurred
    assert edge_width(moved, pixels, BOARD) == pytest.approx(5, rel=0.1)
    assert np.isnan(edge_width(sharp, np.full_like(pixels, np.nan), BOARD))
    assert np.isnan(edge_width(np.full_like(sharp, 90), pixels, BOARD))


@pytest.mark.slow
def test_blur_is_named_with_the_exposure_that_explains_it():
    film = sight(6)
    speed = np.linalg.norm(np.gradient(frames(film.path, film.time, film.size).mean(axis=1), film.time, axis=0), axis=1)
    for width, said in ((1.5 + 0 * speed, None), (3.0 + 0 * speed, "3 pixels"), (1.5 + 0.02 * speed, "exposure")):
        found = find_faults(film.time, film.pixels, BOARD, film.size, *film.read, width)
        assert names(found) == ({"blur"} if said else set())
        assert said is None or said in found.findings[0].evidence


def test_a_film_of_a_few_pictures_is_refused():
    film = sight(0, time=np.arange(12) / 30)
    camera, poses = PixelCamera((1000, 1000), (640, 360)), Poses(film.time, *film.path(film.time))
    with pytest.raises(ValueError, match=r"12 pictures with a pose .* 30 are needed"):
        find_faults(film.time, np.nan_to_num(film.pixels), BOARD, film.size, camera, poses)


@pytest.mark.night
@pytest.mark.slow
@pytest.mark.parametrize(("fault", "wanted"), [({"readout": 0.02}, "rolling shutter"), ({"blur": 1.2}, "blur")])
def test_a_rendered_film_shows_its_faults(tmp_path, monkeypatch, fault, wanted):
    """It takes the night to draw and read films: every run finds the faults of corners and of edges."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert names(read_film(quick_film(0, tmp_path, **fault)[0])) == {wanted}
