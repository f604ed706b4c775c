"""Mistakes of a camera's owner are named with their size, and nothing is named where nothing is wrong."""

from dataclasses import replace

import numpy as np
import pytest
from diagnosis_study import FAULTS, alone, clean, diagnosed, drawn, spoiled, together
from sample_sizes import sampled
from scipy.spatial.transform import Rotation

from percept_obs import (
    Camera,
    Gaussian,
    PixelCamera,
    Poses,
    Recording,
    Scenario,
    diagnose,
    pinhole,
    record,
    rigid,
    scenarios,
)
from percept_obs.figures import causes
from percept_obs.recording import Unlikely
from percept_obs.studies.diagnosis.causes import NUMBERS
from percept_obs.studies.diagnosis.fitting import fit
from percept_obs.studies.diagnosis.search import LIMITS, _fewest
from percept_obs.studies.diagnosis.tracks import guess, seen, spikes, track_of

TURNING = rigid(
    camera_angular_velocity=lambda t: [-np.sin(2 * t), -np.cos(3 * t), -0.5],
    camera_velocity=lambda t: [np.cos(t), 0.3, 0],
)
SCENE = Scenario("turning", TURNING, (0.2, 0.1, 6), 2, pinhole())
SESSION, DRAW = drawn(3, points=2)
BLIND = [replace(each, truth=None, signal=None) for each in SESSION]


def test_the_point_that_explains_a_track_leaves_its_noise():
    found = fit([track_of(SESSION[0])], "nothing", ())
    assert found.rms**2 == pytest.approx(SESSION[0].noise_variance, rel=0.2)
    assert abs(found.correlation) < 0.2
    exact = record(scenarios.ma2005_eq36(), 60, Camera(0.1))  # the point leaves for 35 km
    assert fit([track_of(exact)], "nothing", ()).rms < 1e-9


def test_a_path_is_of_fourth_order_where_rotations_do_not_commute():
    assert fit([track_of(record(SCENE, camera=Camera(0.05)))], "nothing", ()).rms < 2e-6


def test_a_number_that_was_not_fitted_is_estimated_by_one_step():
    late = spoiled(SESSION, ["focal length"], np.random.default_rng(2))
    tracks = [track_of(each) for each in late]
    (fitted,) = fit(tracks, "nothing", ["focal length"]).wrong.values()
    estimate = fit(tracks, "nothing", ()).estimates(["focal length"])["focal length"]
    assert estimate.value == pytest.approx(fitted, rel=0.3)


@pytest.mark.parametrize(("ratio", "kept"), [(1.1, ["focal length"]), (1.004, [])])
def test_numbers_that_are_not_needed_or_small_are_dropped(ratio, kept):
    """A focal length that is wrong by 0.4 % is sure and makes the samples much likelier, but is not worth a word."""
    exact = record(SCENE, camera=Camera(0.05, Gaussian(1e-4)))
    found = fit([track_of(replace(exact, outputs=ratio * exact.outputs))], "nothing", ["focal length", "gyro bias"])
    assert found.estimates(["focal length"])["focal length"].sure > LIMITS.surely
    assert [*_fewest(found).wrong] == kept


def test_lost_samples_and_one_output_are_explained_as_well():
    exact = record(scenarios.ma2005_eq35(), 4)
    outputs = exact.outputs.copy()
    outputs[50:120, 1] = np.nan
    assert fit([track_of(replace(exact, outputs=outputs))], "nothing", ()).rms < 1e-9
    single = replace(exact, outputs=outputs[:, :1], names=("y1",), signal=None, truth=None)
    assert fit([track_of(single)], "nothing", ()).rms < 1e-6


@pytest.mark.parametrize("mix_up", ["nothing", "w", "vehicle", "uv", "fisheye", "mount 5"])
def test_derivatives_by_the_point_and_by_every_cause_are_those_of_differences(mix_up):
    track = track_of(SESSION[0])
    point, wrong = guess(track, mix_up, {})[0], {key: np.full(cause.size, 0.01) for key, cause in NUMBERS.items()}
    point = point / np.linalg.norm(point)
    found = seen(track, point, mix_up, wrong, [*NUMBERS])

    def difference(change):
        return (change(1e-6) - change(-1e-6)) / 2e-6

    for k in range(4):
        by = difference(lambda h, k=k: seen(track, point + h * np.eye(4)[k], mix_up, wrong).outputs)
        np.testing.assert_allclose(found.by_point[:, :, k], by, atol=1e-5 * np.abs(by).max())
    steps = [(key, step) for key, cause in NUMBERS.items() for step in np.eye(cause.size)]
    for k, (key, step) in enumerate(steps):
        by = difference(
            lambda h, key=key, step=step: seen(track, point, mix_up, {**wrong, key: wrong[key] + h * step}).outputs
        )
        np.testing.assert_allclose(found.by_cause[:, :, k], by, atol=5e-3 * np.abs(by).max(), err_msg=key)


@pytest.mark.parametrize("seed", [0, 3, 7])
def test_nothing_is_said_of_clean_recordings(seed):
    found = diagnosed(clean(seed))
    assert not found.findings, found
    assert found.explained


CAMERA = PixelCamera((500, 500), (320, 240))
MOUNT = np.array([0.05, -0.1, 0.02]), Rotation.from_euler("zxy", [1.5, 0.1, -0.05]).as_matrix()
BACK = -MOUNT[1].T @ MOUNT[0], MOUNT[1].T


AHEAD = np.array([[0.5, 0.2, 5.0], [-0.8, 0.1, 4.0], [0.2, -0.6, 6.0]])


def carried_past(poses, changed, camera=CAMERA, places=AHEAD):
    """Recordings of points that carried poses see, as somebody brings them with other poses and pixels."""
    seen = np.stack([poses.rotation.inv().apply(place - poses.position) for place in places])
    draw, (given, change) = np.random.default_rng(0), changed
    for track in CAMERA.pixels(seen[..., :2] / seen[..., 2:]) + draw.normal(0, 0.3, (3, len(poses.time), 2)):
        outputs, variance = camera.image(change(track)), camera.variance(0.3)
        yield Recording(poses.time, outputs, ("y1", "y2"), pinhole(), given.motion(), noise_variance=variance)


def on_a_path():
    time = np.arange(100) / 20
    turning = np.stack([0.1 * np.sin(2 * time), 0.12 * np.cos(1.5 * time), 0.3 * np.sin(time)], axis=1)
    position = np.stack([0.4 * np.sin(2 * time), 0.3 * np.cos(1.3 * time), 0.2 * np.sin(0.9 * time)], axis=1)
    return Poses(time, position, Rotation.from_rotvec(turning).as_quat())


def inverted(poses):
    back = poses.rotation.inv()
    return Poses(poses.time, -back.apply(poses.position.copy()), back.as_quat())


def body(poses):
    return replace(poses.mounted(*BACK), mount=None)


def with_quaternions(poses, quaternions):
    return Poses(poses.time, poses.position, quaternions)


def same(value):
    return value


@pytest.mark.slow
@pytest.mark.parametrize(
    ("wanted", "poses", "pixels", "camera"),
    [
        ("poses inverted", inverted, same, CAMERA),
        ("rotations inverted", lambda p: with_quaternions(p, p.rotation.inv().as_quat()), same, CAMERA),
        ("quaternion order", lambda p: with_quaternions(p, np.roll(p.orientation, 1, axis=1)), same, CAMERA),
        ("quaternion order", lambda p: with_quaternions(p, np.roll(p.orientation, -1, axis=1)), same, CAMERA),
        ("mount inverted", lambda p: body(p).mounted(*BACK), same, CAMERA),
        ("mount left out", body, same, CAMERA),
        ("u and v exchanged", same, lambda pixels: pixels[:, ::-1], CAMERA),
        ("image size", same, lambda pixels: pixels / 2, CAMERA),
        ("focal length", same, same, PixelCamera((1000, 1000), (320, 240))),
        ("focal length", same, same, PixelCamera((250, 250), (320, 240))),
        ("nothing", same, same, CAMERA),
    ],
)
def test_mix_ups_of_files_and_calibration_are_named(wanted, poses, pixels, camera):
    exact = on_a_path()
    found = diagnosed([*carried_past(exact, (poses(exact), pixels), camera)])
    assert (found.named, found.explained) == (wanted, True), found.sentence


LENSES = {
    "EuRoC, cam0": (-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05),
    "KITTI, image_00": (-0.3691481, 0.1968681, 0.001353473, 0.0005677587, -0.06770705),
    "TUM RGB-D, fr2": (0.2312, -0.7849, -0.0033, -0.0001, 0.9172),
}
"""Lenses of public recordings, as they are published with them."""


FISHEYE = PixelCamera(CAMERA.focal, CAMERA.centre, distortion=(0, 0, 0, 0), lens="equidistant")


def through(lens, places):
    """Diagnosis of recordings that a camera with some lens took, and that are divided as those of a pinhole."""
    exact = on_a_path()
    changed = exact, lambda pixels: lens.pixels(CAMERA.directions(pixels))
    return diagnosed([*carried_past(exact, changed, places=places)])


@pytest.mark.slow
@pytest.mark.parametrize("name", LENSES)
def test_a_lens_that_bends_is_told_from_a_fisheye(name):
    found = through(PixelCamera(CAMERA.focal, CAMERA.centre, distortion=LENSES[name]), AHEAD * [3.0, 3.0, 1.0])
    assert found.named == "distortion ignored", found.sentence
    assert found.explained == (name != "TUM RGB-D, fr2")  # which bends outwards and back


@pytest.mark.slow
def test_a_fisheye_is_named_or_both_are_where_it_sees_too_little():
    wide, narrow = (through(FISHEYE, AHEAD * [scale, scale, 1.0]) for scale in (3.0, 1.0))
    assert (wide.named, wide.findings[0].instead) == ("fisheye ignored", ())
    assert {narrow.named, *narrow.findings[0].instead} == {"fisheye ignored", "distortion ignored"}


@pytest.mark.night(reason="shares of 460 recordings")
@pytest.mark.slow
def test_mistakes_are_named_or_the_motion_cannot_tell():
    """Twenty recordings with each mistake and 200 clean ones with ALL_SAMPLES=1."""
    for fault in FAULTS:
        named = [alone(fault, seed) for seed in range(sampled(1, 20))]
        right = named.count(fault) + named.count("cannot tell")
        assert right >= 0.9 * len(named), (fault, named)
        assert right + named.count("nothing") == len(named), (fault, named)
    for seed in range(sampled(4, 200)):
        assert not diagnosed(clean(seed)).findings, seed


@pytest.mark.night(reason="shares of 60 pairs")
@pytest.mark.slow
def test_of_two_mistakes_both_are_named_or_something_is_left():
    """Sixty pairs with ALL_SAMPLES=1."""
    count = sampled(4, 60)
    good = false = 0
    for seed in range(count):
        pair, found = together(seed)
        named = {each.key for each in found.findings}
        told = {*named, *found.not_told, *(key for each in found.findings for key in each.instead)}
        false += not named <= set(pair)
        good += named <= set(pair) and (set(pair) <= told or (bool(named) and not found.explained))
    assert good >= 0.8 * count
    assert false <= 0.03 * count


def test_the_offset_is_found_with_its_size_and_drawn():
    late = spoiled(SESSION, ["time offset"], np.random.default_rng(1))
    found = diagnose(late)
    assert found.named == "time offset"
    first = found.findings[0]
    assert f"the images are {abs(first.value):.3f} s" in found.sentence
    assert first.deviation < 0.002
    assert found.before > 2 * found.left
    drawing = causes(found)
    assert drawing.text.endswith(found.sentence)


def test_wrong_numbers_that_a_motion_does_not_show_are_said():
    shift = rigid(camera_velocity=lambda t: [np.cos(t), 0.3 * np.sin(2 * t), 0])
    still = record(Scenario("shift", shift, (0.2, 0.1, 4), 8, pinhole()), camera=Camera(0.05, Gaussian(0.002)))
    for ratio in (0.8, 1.0, 1.2):
        found = diagnose(replace(still, outputs=ratio * still.outputs, truth=None, signal=None))
        assert found.named == "nothing"
        assert {"focal length", "sign of w_c"} <= set(found.not_told)
    assert "This motion cannot tell: focal length" in found.sentence


def test_one_recording_of_many_shows_another_landmark():
    session, draw = drawn(10, points=3)
    found = diagnose(spoiled(session, ["mismatch"], draw))
    assert found.named == "mismatch"
    assert "shows another landmark from" in found.sentence
    assert found.explained


def test_outliers_are_named_and_left_out():
    session, draw = drawn(14, points=2)
    found = diagnose(spoiled(session, ["outliers"], draw))
    assert found.named == "outliers"
    assert found.explained
    assert 0.01 < found.findings[0].value < 0.1


@pytest.mark.parametrize(("beside", "named"), [(0.0, "outliers"), (5.0, "nothing")])
def test_samples_are_no_outliers_where_the_other_points_are_restless_too(beside, named):
    """Then the camera was jolted, between two poses, and the samples are right."""
    jolted = []
    for each, size in zip(BLIND, (12.0, beside), strict=True):
        outputs, middle = each.outputs.copy(), each.time[len(each.time) // 2]
        signs = np.where(np.arange(len(each.time)) % 2, 1, -1)[:, None]
        outputs += np.where(np.abs(each.time - middle) < 0.1, size, 0.0)[:, None] * signs * np.sqrt(each.noise_variance)
        jolted.append(replace(each, outputs=outputs))
    assert diagnose(jolted).named == named


def test_what_none_of_the_mistakes_explains_is_said():
    """Noise ten times as large as it is said to be is none of them."""
    found = diagnose(replace(BLIND[0], noise_variance=BLIND[0].noise_variance / 100))
    assert found.named == "nothing"
    assert "none of the usual mistakes explains it" in found.sentence


def test_single_wild_samples_are_left_out_and_a_smooth_track_has_none():
    wild = record(scenarios.ma2005_eq35(), 4, Camera(0.05)).outputs.copy()
    assert not spikes(wild).any()
    wild[20] += 0.3
    assert np.flatnonzero(spikes(wild)[:, 0]).tolist() == [20]


def test_pixels_are_told_by_their_size():
    with pytest.warns(Unlikely):
        pixels = [replace(recording, outputs=600 * recording.outputs + 300) for recording in BLIND * 20]
    found = diagnose(pixels)
    assert found.named == "pixels"
    assert "pixels" in repr(found)
    assert "12 of 40 recordings were looked at" in found.sentence
    with pytest.raises(ValueError, match="nothing was fitted"):
        causes(found)


def test_a_constant_motion_shows_no_offset():
    steady = rigid(camera_angular_velocity=[0, -0.1, 0], camera_velocity=[0.3, 0.1, 0])
    found = diagnose(record(Scenario("steady", steady, (0.2, 0.1, 3), 5, pinhole())))
    assert "time offset" in found.not_told
    assert found.named == "nothing"


def test_what_makes_no_sense_is_refused_and_a_short_track_left_out():
    short = BLIND[0].between(0, 0.2)
    with pytest.raises(ValueError, match="there is no recording"):
        diagnose([])
    with pytest.raises(ValueError, match=r"20 are needed: give longer poses or longer tracks"):
        diagnose(short)
    found = diagnose([BLIND[1], short])
    assert (found.looked_at, found.too_short) == (1, 1)
    assert "1 were left out" in found.sentence
