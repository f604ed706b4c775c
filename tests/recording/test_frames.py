"""Frames are PNG or JPEG files, whatever they are made of, and a recording can be drawn as a film."""

import matplotlib.image
import numpy as np
import pytest
from PIL.Image import fromarray

from percept_obs import Camera, Scenario, affine, pinhole, record
from percept_obs.labs import observer_lab
from percept_obs.recording import Frames, Recording, render
from percept_obs.recording import frames as module
from percept_obs.validation import TooMuchWork

EXTENT = (-1.0, 1.0, -1.0, 1.0)
RAMP = np.linspace(0, 1, 12).reshape(3, 4)


@pytest.fixture(scope="module")
def film():
    motion = affine(np.zeros((3, 3)), [0.1, 0.0, -0.2])
    return record(Scenario("walk", motion, (-0.4, 0.1, 3.0), 4.0, pinhole()), camera=Camera(0.05))


def pixels(data, tmp_path):
    path = tmp_path / "one.png"
    path.write_bytes(data)
    return matplotlib.image.imread(path)


def test_arrays_paths_and_a_folder_are_the_same_frames(tmp_path):
    coloured = np.stack([RAMP, 1 - RAMP, RAMP**2], axis=-1)
    frames = Frames([RAMP, (255 * RAMP).round().astype(int), coloured], [0, 1, 2], EXTENT)
    np.testing.assert_allclose(pixels(frames.images[0], tmp_path), RAMP, atol=1 / 255)
    assert frames.images[0] == frames.images[1]
    np.testing.assert_allclose(pixels(frames.images[2], tmp_path), coloured, atol=1 / 255)
    folder = tmp_path / "frames"
    folder.mkdir()
    for k, image in enumerate(frames.images):
        (folder / f"{k:03}.png").write_bytes(image)
    assert Frames(folder, [0, 1, 2], EXTENT).images == frames.images
    assert Frames(sorted(folder.iterdir()), [0, 1, 2], EXTENT).images == frames.images


def test_files_and_bytes_of_jpeg_are_kept_as_they_are(tmp_path):
    files = []
    for k, name in enumerate(("a.jpg", "b.JPEG", "c.png")):
        fromarray((255 * RAMP).astype(np.uint8)).save(tmp_path / name)
        files.append((tmp_path / name).read_bytes())
        (tmp_path / f"{k}.txt").write_text("no frame")
    assert Frames(tmp_path, [0, 1, 2], EXTENT).images == Frames(files, [0, 1, 2], EXTENT).images == tuple(files)


def test_what_is_no_film_is_refused_with_the_reason(tmp_path, monkeypatch):
    other = tmp_path / "a.png"
    other.write_bytes(b"GIF89a")
    for images, time, extent, reason in (
        ([RAMP], [0.0, 1.0], EXTENT, "there are 1 frames and times of shape"),
        ([RAMP, RAMP], [1.0, 1.0], EXTENT, "give each frame a time, increasing"),
        ([RAMP], [0.0], (0, 0, 1, 2), "give y1 of left and right"),
        ([np.zeros(3)], [0.0], EXTENT, r"frame 1 has the shape \(3,\)"),
        ([other], [0.0], EXTENT, "a.png', is no PNG or JPEG file; convert it"),
        ([b"GIF89a"], [0.0], EXTENT, "frame 1, is no PNG or JPEG file"),
        (tmp_path / "nowhere", [0.0], EXTENT, "holds no .png or .jpg files"),
    ):
        with pytest.raises(ValueError, match=reason):
            Frames(images, time, extent)
    monkeypatch.setattr(module, "MOST_BYTES", 10)
    with pytest.raises(TooMuchWork, match="take fewer or smaller ones"):
        Frames([RAMP], [0.0], EXTENT)


def test_a_drawn_ball_is_where_the_point_is_seen_and_looms(film, tmp_path):
    drawn = render(film, count=5, size=90)
    left, right, lower, upper = drawn.extent
    sizes = []
    for time, image in zip(drawn.time, drawn.images, strict=True):
        dark = np.argwhere(pixels(image, tmp_path) < 0.7)
        row, column = dark.mean(axis=0) / 89
        (sample,) = np.flatnonzero(film.time == time)
        y1, y2, inverse = film.truth[sample]
        assert left + column * (right - left) == pytest.approx(y1, abs=0.02)
        assert upper + row * (lower - upper) == pytest.approx(y2, abs=0.02)
        sizes.append((len(dark), inverse))
    assert sizes == sorted(sizes)
    blind = Recording(film.time, film.outputs, film.names, film.view, film.motion)
    with pytest.raises(ValueError, match="no truth to draw"):
        render(blind)


def test_a_lab_takes_frames_of_its_own_recordings_only(film):
    drawn = render(film, count=3, size=20)
    (shown,) = observer_lab(film, frames=drawn).frames
    assert shown["time"] == drawn.time.tolist()
    with pytest.raises(ValueError, match="which is no recording of this lab"):
        observer_lab(frames=drawn)
    late = Frames(drawn.images and [RAMP], [99.0], EXTENT)
    with pytest.raises(ValueError, match="give their times by the recording's clock"):
        observer_lab(film, frames=late)
