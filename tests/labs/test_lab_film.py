"""A lab shows a film behind its tracks: each image is sent once, stands under its track in time, and tells metres."""

import base64
import re
from dataclasses import replace

import numpy as np
import pytest
from first_screens import at_the_end, overlaps
from lab_alone import DRAWN
from lab_browser import control

from percept_obs import Camera, Scenario, pinhole, record, rigid
from percept_obs.labs import observer_lab
from percept_obs.recording import Frames
from percept_obs.recording.footage import Footage

BEGIN, RATE, DURATION = 100.0, 30, 3.0
LATER = 0.5
"""Seconds after which the second track begins."""
WIDE, HIGH = 0.8, 0.45
"""Half the width and height of the film in the image."""
SIDE = 0.06
"""Half the side of the square."""
TURN, TRAVEL = [0.0, -0.2, 0.0], [0.2, 0.0, 0.05]
CORNER, POINT = (0.25, -0.05, 0.6), (-0.1, 0.08, 0.7)


TIMES = np.arange(0, DURATION + 1 / RATE, 1 / RATE)
MOTION = rigid(camera_angular_velocity=np.tile(TURN, (len(TIMES), 1)), camera_velocity=TRAVEL, times=BEGIN + TIMES)


def seen(name, place, later=0.0, truth=True):
    """A track of a point, by the film's clock, from later on."""
    scenario = Scenario(name, rigid(camera_angular_velocity=TURN, camera_velocity=TRAVEL), place, DURATION, pinhole())
    track = record(scenario, camera=Camera(1 / RATE)).between(later, DURATION)
    known = {"truth": track.truth} if truth else {"truth": None, "distances": {"triangulation": 1 / track.truth[:, 2]}}
    return replace(
        track, time=BEGIN + track.time, motion=MOTION, signal=None, noise_variance=1e-6, source=name, **known
    )


def pictures(track, down, size=(96, 54)):
    """Frames with a yellow square where the track is, at its samples; y2 points down or up."""
    y1 = np.linspace(-WIDE, WIDE, size[0])[None, :]
    y2 = np.linspace(-HIGH, HIGH, size[1])[:, None] * (1 if down else -1)
    inside = [np.maximum(abs(y1 - at[0]), abs(y2 - at[1])) < SIDE for at in track.outputs]
    images = [np.where(each[..., None], [1.0, 0.9, 0.0], [0.2, 0.2, 0.2]) for each in inside]
    for k, image in enumerate(images):
        image[0, 0] = k / len(images)  # no two are the same
    return Frames(images, track.time, (-WIDE, WIDE, HIGH, -HIGH) if down else (-WIDE, WIDE, -HIGH, HIGH))


def film(down=True, points=1):
    corner = seen("board corner 7", CORNER)
    tracks = [seen(f"point {k}", np.add(POINT, [0.01 * k, 0, 0]), LATER, truth=False) for k in range(points)]
    return Footage((*tracks, corner), ("truth", "triangulation"), pictures(corner, down), "film.mp4")


def test_images_and_motion_are_sent_once_with_each_tracks_offset(tmp_path):
    shown = film()
    lab = observer_lab(shown)
    (sent,) = lab.frames
    assert list(sent["images"]) == list(shown.frames.images)
    assert sent["time"] == shown.frames.time.tolist()
    (motion,) = lab.model["motions"]
    assert motion["times"] == MOTION.signal.times.tolist()
    tracks = lab.model["recordings"]
    assert {name: (t["film"], t["motion"], t["begin"]) for name, t in tracks.items()} == {
        "board corner 7": (0, 0, BEGIN),
        "point 0": (0, 0, BEGIN + LATER),
    }
    assert tracks["point 0"]["measured"][0] == "triangulation"
    lab.save(tmp_path / "lab.html")
    page = (tmp_path / "lab.html").read_text()
    assert {page.count(base64.b64encode(image).decode()) for image in sent["images"]} == {1}
    written = sum(len(base64.b64encode(image)) for image in sent["images"])
    assert len(page) - written < 430_000 + 240 * 3 * len(TIMES)  # a sample of a track or of the motion is that long


def test_it_opens_with_the_longest_known_track_in_metres_and_offers_a_dozen():
    shown = film(points=40)
    tracks = tuple(track.in_own_unit() for track in shown.recordings)
    lab = observer_lab(replace(shown, recordings=tracks))
    offered = list(lab.model["recordings"])
    assert lab.settings["scenario"] == "board corner 7"
    assert lab.settings["observers"] == ["extended_kalman"]
    assert len(offered) == 12
    assert (offered[0], offered[-2:]) == ("point 0", ["point 39", "board corner 7"])
    run = lab.run()["extended_kalman"]
    np.testing.assert_allclose(run.recording.truth[:, 2], tracks[-1].truth[:, 2])
    assert run.relative_error[-1] < 0.01


def test_what_is_no_film_of_tracks_is_refused():
    shown = film()
    short = tuple(track.between(BEGIN + 1, BEGIN + 1.5) for track in shown.recordings)
    with pytest.raises(ValueError, match=r"the film 'film.mp4' has no track of one point that lasts 1 s; move"):
        observer_lab(replace(shown, recordings=short))
    late = replace(shown.frames, time=shown.frames.time + 2 * DURATION)
    with pytest.raises(ValueError, match=r"the frames are from 5.5 to 8.5 s after .*by the recording's clock"):
        observer_lab(replace(shown, frames=late))


POINTED = "(time) => tests.first().screen.clock.put(time)"
NOW = "() => [tests.settings().scenario, tests.first().state.cursor]"
ESTIMATE = "() => Array.from(tests.first().shown.runs[0].estimate)"
SIZES = [(1280, 800), (390, 800)]


@pytest.fixture
def page_of(browser, tmp_path):
    """Opens a saved lab; nothing goes wrong in the page."""
    wrong, pages = [], []

    def opened(lab, size=SIZES[0], theme="light"):
        lab.save(tmp_path / "lab.html")
        viewport = dict(zip(("width", "height"), size, strict=True))
        page = browser.new_page(offline=True, viewport=viewport, color_scheme=theme)
        page.on("pageerror", lambda error: wrong.append(str(error)))
        page.on("console", lambda said: said.type == "error" and wrong.append(said.text))
        page.goto((tmp_path / "lab.html").as_uri())
        page.set_default_timeout(15_000)
        page.wait_for_function("() => tests.ready()")
        page.wait_for_function(DRAWN)
        at_the_end(page)
        pages.append(page)
        return page

    yield opened
    for page in pages:
        page.close()
    assert wrong == []


def yellow(colour):
    return colour[0] - colour[2] > 60


def written(run, sample):
    """The words of an estimate and of its interval of two deviations, along the ray."""
    y1, y2, inverse = run.estimate[sample]
    ray, doubt = np.hypot(np.hypot(y1, y2), 1), 2 * np.sqrt(run.covariance[sample, 2, 2])
    if inverse == 0:
        return f"∞ (over {ray / doubt:.2f} m)"
    low, high = ray / (inverse + doubt), ray / (inverse - doubt)
    half = (high - low) / 2
    if half > 0.3 * ray / inverse:
        return f"{ray / inverse:.2f} m ({low:.2f} m to {high:.2f} m)"
    digits = 3 if half < 0.01 else 2
    return f"{ray / inverse:.{digits}f} ± {max(half, 0.001):.{digits}f} m"


@pytest.mark.browser
@pytest.mark.slow
@pytest.mark.parametrize(("theme", "down"), [("light", True), ("dark", False)])
@pytest.mark.parametrize("size", SIZES)
def test_the_film_stands_under_the_track_while_one_scrubs_and_metres_at_the_point(theme, size, down, page_of):
    lab = observer_lab(film(down))
    page = page_of(lab, size, theme)
    counts = page.evaluate("tests.counts()")
    assert counts["controls"] <= 12
    assert counts["words"] <= 60
    assert page.evaluate("document.documentElement.scrollWidth") <= size[0]
    run = lab.run()["extended_kalman"]
    np.testing.assert_allclose(np.reshape(page.evaluate(ESTIMATE), (-1, 3)), run.estimate, atol=1e-9)
    pad = page.locator(".time .scrub").bounding_box()
    for part in (0.2, 0.5, 0.8):
        page.mouse.click(pad["x"] + part * pad["width"], pad["y"] + 30)
        found = page.evaluate("tests.under()")
        assert found["shown"]
        assert found["above"] == down  # its y2 is negative: the picture is upright
        assert yellow(found["inside"]), (part, found["inside"])
        assert found["outside"][3] > 0
        assert not yellow(found["outside"])
    for sample in (0, 1, 2, 15, 60):
        page.evaluate(POINTED, float(run.recording.elapsed[sample]))
        found = page.evaluate("tests.under()")
        assert yellow(found["inside"])
        texts = [each["text"] for each in found["texts"]]
        actual = np.linalg.norm(pinhole().locate(run.recording.truth[sample]))
        assert f"true {actual:.2f} m" in texts
        assert written(run, sample) in texts
        assert overlaps(page) == []


@pytest.mark.browser
@pytest.mark.slow
def test_another_track_is_chosen_by_its_dot_or_by_keys_at_the_same_frame(page_of):
    page = page_of(observer_lab(film()))
    page.evaluate(POINTED, 2.0)
    page.evaluate("tests.still()")
    x, y = page.evaluate("() => tests.first().screen.seen.tracks[0].at")
    box = page.locator(".view.image").bounding_box()
    page.mouse.click(box["x"] + x, box["y"] + y)
    page.wait_for_function(DRAWN)
    assert page.evaluate(NOW) == ["point 0", pytest.approx(2.0 - LATER)]
    page.evaluate("tests.still()")
    found = page.evaluate("tests.under()")
    assert found["shown"]
    assert any(re.fullmatch(r"triangulation 0\.\d\d m", each["text"]) for each in found["texts"])
    assert "triangulation" in page.inner_text(".says")
    page.focus(control("track"))
    page.keyboard.press("ArrowDown")
    page.wait_for_function(DRAWN)
    assert page.evaluate(NOW) == ["board corner 7", pytest.approx(2.0)]
    assert page.locator(".views .handle:visible").count() == 0
