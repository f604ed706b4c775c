"""The film that ships is what the renderer draws, and its distances are true; who only turns is told not to trust."""

import errno
import os
from dataclasses import replace
from itertools import islice

import av
import numpy as np
import pandas as pd
import pytest
from film_renderer import example_film as draw
from film_renderer import quick_film
from sample_sizes import sampled

from percept_obs import track
from percept_obs.film import example_film, read_film


def shots(path, count):
    """Times and grey pictures of the beginning of a film."""
    with av.open(str(path)) as film:
        frames = islice(film.decode(video=0), count)
        frames = [(frame.time, frame.to_ndarray(format="gray").astype(float)) for frame in frames]
    return [np.array(part) for part in zip(*frames, strict=True)]


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    path = tmp_path_factory.mktemp("film") / "film.mp4"
    return path, draw(path)


@pytest.mark.slow
def test_it_is_drawn_by_the_renderer_and_small(made):
    (time, shipped), (again, drawn) = (shots(path, sampled(20, None)) for path in (example_film(), made[0]))
    assert time.tolist() == again.tolist()
    assert np.abs(shipped - drawn).mean() < 3  # encoders differ from version to version
    assert sum(path.stat().st_size for path in example_film().parent.glob("*.*")) < 1e6


@pytest.mark.slow
def test_its_distances_are_true(made):
    known = pd.read_csv(example_film().with_name("distances.csv"))
    assert len(known) > 40
    assert made[1].distance_at(known["time"], known[["u", "v"]].to_numpy()) == pytest.approx(known["depth"], abs=1e-4)


@pytest.mark.slow
def test_it_shows_the_board_and_the_camera_is_found(made):
    film = read_film(example_film())
    off = [film.sighting.corners[k] - made[1].corners(k) for k in range(len(film.sighting.time))]
    assert np.isfinite(off).mean() > 0.95
    assert np.sqrt(np.nanmean(np.square(off))) < 0.15
    assert film.camera.focal[0] == pytest.approx(405, rel=3 * film.focal_deviation)


@pytest.mark.slow
def test_turning_is_not_trusted(tmp_path):
    film = read_film(quick_film(11, tmp_path, kind="turn", duration=4.0, rate=8, tremor=0.3, quick=0.0)[0])
    trusts = [run.trust() for run in replace(film, recordings=film.recordings[::8]).runs]
    assert not any(trust.trusted for trust in trusts)
    assert "Do not trust the estimate" in trusts[0].sentence


@pytest.mark.slow
def test_a_full_disk_leaves_the_film_that_was_there(tmp_path, monkeypatch):
    film, path = read_film(example_film()), tmp_path / "film.mp4"
    path.write_bytes(b"old")
    shots = type(film.video).shots

    def until_full(video, label):
        yield from islice(shots(video, label), 3)
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(type(film.video), "shots", until_full)
    with pytest.raises(OSError, match=r"No space left on device: '.*/film.mp4'"):
        film.overlay(path)
    assert [file.read_bytes() for file in tmp_path.iterdir()] == [b"old"]


@pytest.mark.slow
def test_what_is_of_another_film_is_refused(tmp_path):
    film = read_film(example_film())
    other = replace(film[0])
    run = track(other, film.observer)
    for call in (film.index, lambda _: film.claimed(run), lambda _: replace(film, recordings=(run,))):
        with pytest.raises(ValueError, match=r"none of the film's recordings|each entry a Recording"):
            call(other)
    with pytest.raises(ValueError, match="in a folder that is there"):
        film.overlay(tmp_path / "no" / "film.mp4")
