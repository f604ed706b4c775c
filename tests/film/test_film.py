"""A film of a printed board gives its camera, its poses, and how far things are, as the renderer knows them."""

from dataclasses import replace
from itertools import islice

import av
import numpy as np
import pytest
from film_renderer import quick_film
from film_study import AFTER, error
from sample_sizes import sampled

from percept_obs import diagnose
from percept_obs.film import Board, read_film
from percept_obs.film.film import TRIANGULATION
from percept_obs.film.lens import reaches
from percept_obs.film.triangulation import triangulate
from percept_obs.film.video import open_film
from percept_obs.studies.all_observers import all_observers


@pytest.fixture(scope="module")
def cache(tmp_path_factory):
    """A cache of the module's own."""
    folder = tmp_path_factory.mktemp("cache")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CACHE_HOME", str(folder))
        yield folder


@pytest.fixture(scope="module")
def filmed(cache, tmp_path_factory):
    """A film, and what is true of it."""
    path, truth = quick_film(7, tmp_path_factory.mktemp("film"))
    return read_film(path), truth


def errors(film, truth, board):
    """Relative errors of the filter after some seconds, by the renderer's truth; of the board's corners or others."""
    runs = [run for run in film.runs if (run.recording.truth is not None) == board]
    late = [np.flatnonzero((run.elapsed >= AFTER) & run.recording.seen) for run in runs]
    return np.array([error(run, truth, film, rows[0]) for run, rows in zip(runs, late, strict=True) if len(rows)])


@pytest.mark.slow
def test_the_camera_is_found(filmed):
    film, truth = filmed
    assert not film.findings
    path = film.path.at(film.seen.poses.time)
    np.testing.assert_allclose(path.time, truth.time, atol=1e-6)
    assert abs(film.camera.focal[0] / truth.camera.focal[0] - 1) < min(0.03, 3 * film.focal_deviation)
    off = np.linalg.norm(path.position - truth.poses.position, axis=1)
    assert np.median(off) < 0.02 * film.depth
    claimed = film.seen.covariance[:, 3:, 3:].trace(axis1=1, axis2=2) + 3 * (film.focal_deviation * film.depth) ** 2
    assert np.median(off**2 / claimed) < 4


@pytest.mark.slow
@pytest.mark.parametrize(("board", "median", "most"), [(True, 0.03, 0.08), (False, 0.05, 0.2)])
def test_distances_are_found(filmed, board, median, most):
    found = errors(*filmed, board)
    assert len(found) >= 10
    assert np.median(found) < median
    assert np.quantile(found, 0.9) < most


@pytest.mark.slow
def test_what_is_claimed_holds(filmed):
    film, _ = filmed
    table = replace(film, recordings=film.recordings[:: sampled(8, 1)]).distances()
    assert (abs(table["distance"] - table["known"]) < table["claimed"]).mean() > 0.8
    assert table["trusted"].mean() > 0.5
    assert set(table["reference"]) == {"board", TRIANGULATION}


@pytest.mark.slow
def test_a_film_goes_where_recordings_go(filmed):
    film, _ = filmed
    found = all_observers(film, after=[2.0], max_tracks=6)
    assert np.isfinite(found.summary.loc["extended Kalman", ["board 2 s", f"{TRIANGULATION} 2 s"]].astype(float)).all()
    assert diagnose(film).given == len(film)


@pytest.mark.slow
def test_a_film_is_read_once(filmed, cache, monkeypatch):
    film, _ = filmed
    kept = [*cache.rglob("*.npz")]
    assert kept
    monkeypatch.setattr(Board, "detect", None)
    again = read_film(film.video.path)
    np.testing.assert_allclose(again[0].outputs, film[0].outputs, atol=1e-8)  # threads add in their own order
    for each in kept:  # cut off while it was written, say
        each.write_bytes(each.read_bytes()[:1000])
    with pytest.raises(TypeError, match="not callable"):
        read_film(film.video.path)


@pytest.mark.slow
def test_distances_are_drawn_in(filmed, tmp_path):
    film, truth = filmed
    last = (each for each in film if each.seen[-1] and each.time[-1] == film.path.time[-1])
    film = replace(film, recordings=tuple(islice(last, 3)))
    film.overlay(tmp_path / "with distances.mp4")
    with av.open(str(tmp_path / "with distances.mp4")) as file:
        frames = [(float(frame.time), frame.to_ndarray(format="rgb24").astype(float)) for frame in file.decode(video=0)]
    np.testing.assert_allclose([time for time, _ in frames], truth.time, atol=1e-3)
    _, last = frames[-1]
    u, v = film.camera.pixels(film[0].outputs[-1]).round().astype(int)
    red, _, blue = last[v - 1 : v + 2, u - 1 : u + 2].mean(axis=(0, 1))
    assert blue > red + 60


@pytest.mark.slow
def test_known_poses_need_no_board(cache, tmp_path):
    path, truth = quick_film(3, tmp_path, duration=4.0, rate=8, boards=0)
    with pytest.raises(ValueError, match="no camera; give also camera="):
        read_film(path, poses=truth.poses)
    film = read_film(path, camera=truth.camera, poses=truth.poses)
    assert all(recording.truth is None for recording in film)
    assert np.median(errors(film, truth, board=False)) < 0.05


@pytest.mark.slow
def test_a_film_that_was_held_upright_stands_upright(cache, tmp_path):
    path, truth = quick_film(5, tmp_path, size=(360, 640), rate=8, upside_down=True, uneven=0.4, duration=4.0)
    film = read_film(path)
    assert film.video.size == (360, 640)
    assert np.median(errors(film, truth, board=True)) < 0.03
    assert film.frames.extent[2] > film.frames.extent[3]


@pytest.mark.parametrize(
    ("content", "said"),
    [(None, "there is no film"), (b"", "no film that can be read"), (b"a text, not a film\n" * 99, "no film that can")],
)
def test_what_is_no_film_is_refused(tmp_path, content, said):
    file = tmp_path / "a film %d.mp4"
    if content is not None:
        file.write_bytes(content)
    with pytest.raises((ValueError, FileNotFoundError), match=said):
        open_film(file)


def blank(path, count, rate=10, size=(320, 240), grey=0, layout=None, **options):
    """Write a film of empty pictures."""
    with av.open(str(path), "w", options=layout or {}) as file:
        stream = file.add_stream("libx264", rate=rate, options=options)
        stream.width, stream.height, stream.pix_fmt = *size, "yuv420p"
        for _ in range(count):
            picture = np.full(size[::-1], grey, np.uint8)
            file.mux(stream.encode(av.VideoFrame.from_ndarray(picture, format="gray")))
        file.mux(stream.encode())


def test_an_empty_film_is_refused(cache, tmp_path):
    blank(tmp_path / "black.mp4", 30)
    with pytest.raises(ValueError, match="0 of 30 pictures"):
        read_film(tmp_path / "black.mp4")
    blank(tmp_path / "short.mp4", 5)
    with pytest.raises(ValueError, match=r"too short: 5 pictures in 0.4 s"):
        read_film(tmp_path / "short.mp4")


@pytest.mark.slow
def test_two_boards_are_refused(cache, tmp_path):
    path, _ = quick_film(2, tmp_path, duration=2.5, rate=8, boards=2)
    with pytest.raises(ValueError, match="two boards with the same markers"):
        read_film(path)


def test_a_cut_off_file_gives_what_there_is(tmp_path):
    blank(tmp_path / "whole.mp4", 60, layout={"movflags": "+faststart"})
    whole = (tmp_path / "whole.mp4").read_bytes()
    (tmp_path / "cut.mp4").write_bytes(whole[: -len(whole) // 10])
    assert 0 < len([*open_film(tmp_path / "cut.mp4").shots("x")]) < 60


def test_pictures_out_of_order_keep_their_times(tmp_path):
    blank(tmp_path / "film.avi", 40, bf="2")
    time = [seconds for seconds, _ in open_film(tmp_path / "film.avi").shots("x")]
    np.testing.assert_allclose(np.diff(time), 0.1, atol=1e-9)
    assert len(time) == 40


@pytest.mark.parametrize(
    ("lens", "corner", "reached"),
    [((-0.33, 0), 1.0, False), ((-0.33, 0), 0.669, False), ((-0.33, 0), 0.5, True), ((0.1, 0.05), 0.8, True)],
)
def test_a_lens_that_folds_reaches_no_corner(lens, corner, reached):
    assert reaches(np.array(lens, dtype=float), corner) is reached


def test_rays_meet_in_a_point_and_outliers_do_not_count():
    rng = np.random.default_rng(1)
    place, positions = np.array([0.1, -0.2, 2.0]), rng.normal(0, 0.2, (60, 3))
    turns = np.stack([np.eye(3)] * 60)
    image = (place - positions)[:, :2] / (place - positions)[:, 2:] + rng.normal(0, 1e-3, (60, 2))
    image[::10] += 0.1
    found = triangulate(positions, turns, image)
    assert np.linalg.norm(found.position - place) < 4 * found.deviation * 2
    assert not found.agree[::10].any()
    assert found.agree.mean() > 0.8
    assert found.spread == pytest.approx(1e-3, rel=0.3)


def test_an_estimate_is_not_trusted_where_the_film_is_doubted():
    from percept_obs import PerspectiveSystem, affine, ibo, pinhole, record, scenarios, track

    form = PerspectiveSystem(affine(), pinhole()).measure("y1", "y2")
    run = track(replace(record(scenarios.ma2005_eq35(), 5), doubt="the lens focuses anew"), ibo(form))
    assert run.trust().sentence == "Do not trust the estimate: the lens focuses anew."
