"""A camera is read from the files that calibration programs write, and a model of COLMAP becomes recordings."""

import struct

import numpy as np
import pytest
from camera_paths import PLACES, carried, poses, seen

from percept_obs import Clock, PerspectiveSystem, PixelCamera, ekf, read_folder, record, scenarios, track
from percept_obs.recording.camera_files import read_mount
from percept_obs.recording.colmap import read_colmap
from percept_obs.recording.pose_files import read_tum

LENS = [-0.28, 0.07, 1e-5, -2e-5]
EXPECTED = PixelCamera((458.5, 457.25), (367.5, 248.0), (752, 480), LENS)
TURN = [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
MATRIX = "[458.5, 0., 367.5, 0., 457.25, 248., 0., 0., 1.]"
ROS = f"""image_width: 752
image_height: 480
camera_matrix:
  rows: 3
  cols: 3
  data: {MATRIX}
distortion_model: plumb_bob
distortion_coefficients: {{rows: 1, cols: 4, data: [-0.28, 0.07, 1e-5, -2e-5]}}
"""
OPENCV = f"""%YAML:1.0
---
calibration_time: "Mon"
image_width: 752
image_height: 480
Camera_Matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: {MATRIX}
Distortion_Coefficients: !!opencv-matrix
   rows: 12
   cols: 1
   dt: d
   data: [ -2.8e-01, 7.e-02, 1e-5, -2e-5, 0., 0., 0., 0., 0., 0., 0., 0. ]
"""
EUROC = """# the sensor
sensor_type: camera
T_BS:
  cols: 4
  rows: 4
  data: [0.0, -1.0, 0.0, 0.1,
         1.0, 0.0, 0.0, 0.2,
         0.0, 0.0, 1.0, 0.3,
         0.0, 0.0, 0.0, 1.0]
resolution: [752, 480]
camera_model: pinhole
intrinsics: [458.5, 457.25, 367.5, 248.0] #fu, fv, cu, cv
distortion_model: radial-tangential
distortion_coefficients: [-0.28, 0.07, 1.0e-05, -2.0e-05]
"""
KALIBR = """cam0:
  T_cam_imu: [[0, 1, 0, -0.2], [-1, 0, 0, 0.1], [0, 0, 1, -0.3], [0, 0, 0, 1]]
  camera_model: pinhole
  distortion_coeffs: [-0.28, 0.07, 1.0e-05, -2.0e-05]
  distortion_model: radtan
  intrinsics: [458.5, 457.25, 367.5, 248.0]
  resolution: [752, 480]
  timeshift_cam_imu: 0.25
cam1:
  camera_model: pinhole
  distortion_coeffs: [0, 0, 0, 0]
  distortion_model: equidistant
  intrinsics: [1, 1, 0, 0]
"""
VINS = """%YAML:1.0
---
model_type: PINHOLE
image_width: 752
image_height: 480
distortion_parameters:
   k1: -0.28
   k2: 0.07
   p1: 1.0e-05
   p2: -2.0e-05
projection_parameters:
   fx: 458.5
   fy: 457.25
   cx: 367.5
   cy: 248.0
"""


def written(folder, text):
    (folder / "camera.yaml").write_text(text)
    return folder / "camera.yaml"


@pytest.mark.parametrize("text", [ROS, OPENCV, EUROC, KALIBR, VINS], ids=["ROS", "OpenCV", "EuRoC", "Kalibr", "VINS"])
def test_a_camera_is_read_from_the_files_of_calibration(tmp_path, text):
    camera = PixelCamera.from_yaml(written(tmp_path, text), "cam0" if "cam0" in text else None)
    assert (camera.focal, camera.centre, camera.size) == (EXPECTED.focal, EXPECTED.centre, EXPECTED.size)
    assert camera.distortion[:4] == pytest.approx(LENS)
    assert not any(camera.distortion[4:])


def test_a_fisheye_is_read(tmp_path):
    assert PixelCamera.from_yaml(written(tmp_path, KALIBR), "cam1") == PixelCamera(
        (1, 1), (0, 0), distortion=[0.0] * 4, lens="equidistant"
    )


@pytest.mark.parametrize(("text", "name"), [(EUROC, None), (KALIBR, "cam0")], ids=["EuRoC", "Kalibr"])
def test_the_mount_is_that_of_the_camera_on_its_body(tmp_path, text, name):
    place, turn, shift = mount = read_mount(written(tmp_path, text), name)
    np.testing.assert_allclose(place, [0.1, 0.2, 0.3])
    np.testing.assert_allclose(turn, TURN)
    assert shift == (0.25 if name else 0)
    camera = poses(np.arange(3.0)).mounted(*mount)
    np.testing.assert_allclose(camera.time, np.arange(3.0) - shift)  # t_imu = t_cam + shift
    np.testing.assert_allclose(camera.mount[1], TURN, atol=1e-12)


@pytest.mark.parametrize(
    ("text", "camera", "message"),
    [
        (KALIBR, None, "has the cameras cam0, cam1; give one of these names, not None"),
        (KALIBR, "cam7", "give one of these names, not 'cam7'"),
        (KALIBR.replace("equidistant", "mei"), "cam1", "the lens 'mei'; a PixelCamera is a pinhole behind one of"),
        (KALIBR.replace("[0, 0, 0, 0]", "[0, 0, 0, 0, 0]"), "cam1", "it must be 4 finite numbers, k1, k2, k3, k4, or"),
        (EUROC.replace("pinhole", "omni"), None, "with the model 'omni'"),
        (EUROC.replace("458.5,", ""), None, r"has intrinsics = \[457.25, .*\]; expected 4 finite numbers"),
        (EUROC.replace("458.5,", ".inf,"), None, "expected 4 finite numbers"),
        (EUROC.replace("458.5,", "wide,"), None, "expected 4 finite numbers"),
        (ROS.replace("458.5, 0.,", "458.5, 3.,"), None, "expected fx 0 cx, 0 fy cy, 0 0 1"),
        (
            ROS.replace("coefficients", "coefficents"),
            None,
            "the lens 'plumb_bob' and no distortion_coefficients; there",
        ),
        (ROS.replace("1e-5,", ""), None, "the distortion is .* it must be 4, 5, 8"),
        ("a: [", None, "is no YAML file of a camera"),
        ("just text", None, "is no YAML file of a camera .no names of values"),
        ("a: !!python/object/apply:os.system ['true']", None, "is no YAML file of a camera"),
        ("a: 1", None, "has a; a camera needs camera_matrix, or intrinsics"),
    ],
)
def test_what_is_no_camera_is_refused(tmp_path, text, camera, message):
    with pytest.raises(ValueError, match=message):
        PixelCamera.from_yaml(written(tmp_path, text), camera)


@pytest.mark.parametrize("diagonal", [(0, 0, 0, 0), (-1, 1, 1, 1), (2, 1, 1, 1), (1, 1, 1, 7)])
def test_a_mount_is_a_rotation_and_a_place(tmp_path, diagonal):
    with pytest.raises(ValueError, match="expected a rotation beside p, above 0 0 0 1"):
        read_mount(written(tmp_path, f"T_BS: {np.diag(diagonal).tolist()}"))


def test_no_file_and_no_mount_are_told(tmp_path):
    with pytest.raises(FileNotFoundError, match="there is no file"):
        PixelCamera.from_yaml(tmp_path / "none.yaml")
    with pytest.raises(ValueError, match="it needs T_BS, T_imu_cam or T_cam_imu"):
        read_mount(written(tmp_path, ROS))


# Models of COLMAP.

TIME = np.arange(40) / 20
NAMES = [f"frame_{k + 3:04}.png" for k in range(40)]


def write_colmap(folder, model="OPENCV 752 480 458.5 457.25 367.5 248.0 -0.28 0.07 0.00001 -0.00002", names=NAMES):
    """Write what a carried camera sees of three places as a model; the second place is lost for a while."""
    position, rotation, *_ = carried(TIME)
    back = rotation.inv()
    shift, turn = -back.apply(position), back.as_quat()[:, [3, 0, 1, 2]]
    pixels = np.stack([EXPECTED.pixels(place[:, :2] / place[:, 2:]) for place in seen(TIME)[:3]], axis=1)
    rows = ["# Image list with two lines of data per image:"]
    for k in np.random.default_rng(0).permutation(40):
        rows.append(" ".join(map(str, [k + 1, *turn[k], *shift[k], 1, names[k]])))
        kept = [j for j in range(3) if j != 1 or not 15 <= k < 20]
        rows.append(" ".join(f"{pixels[k, j, 0]} {pixels[k, j, 1]} {10 * j + 7}" for j in kept) + " 5 5 -1")
    (folder / "images.txt").write_text("\n".join(rows))
    (folder / "cameras.txt").write_text(f"# cameras\n1 {model}\n")
    lines = [f"{10 * j + 7} {x} {y} {z} 1 2 3 0.5 1 0" for j, (x, y, z) in enumerate(PLACES[:3])]
    (folder / "points3D.txt").write_text("\n".join(lines))
    return folder


def test_a_model_of_colmap_becomes_poses_tracks_and_points(tmp_path):
    model = read_colmap(write_colmap(tmp_path), rate=20)
    np.testing.assert_allclose(model.poses.time, TIME, atol=1e-12)
    np.testing.assert_allclose(model.poses.position, poses(TIME).position, atol=1e-12)
    assert np.abs((model.poses.rotation.inv() * poses(TIME).rotation).as_rotvec()).max() < 1e-12
    np.testing.assert_allclose(model.points, PLACES[:3])
    assert (model.camera.focal, model.camera.distortion) == (EXPECTED.focal, pytest.approx(LENS))
    found = model.recordings("kitchen", pixel_sigma=0.5, gap=0.2)
    assert [each.source for each in found] == [
        "kitchen, point 7",
        "kitchen, point 17, part 1",
        "kitchen, point 17, part 2",
        "kitchen, point 27",
    ]
    place = seen(TIME)[2]
    np.testing.assert_allclose(found[3].outputs, place[:, :2] / place[:, 2:], atol=1e-9)
    assert np.abs(found[3].distance / place[:, 2] - 1).max() < 0.01  # from the smoothed poses


def pack_colmap(text, folder, model=4):
    """Write the binary model of one in text."""
    folder.mkdir()
    read = [[line.split() for line in (text / f"{name}.txt").read_text().splitlines() if line[:1] != "#"]
            for name in ("cameras", "images", "points3D")]  # fmt: skip
    (cameras, images, points), packed = read, [b"", b"", b""]
    for number, _, width, height, *numbers in cameras:
        packed[0] += struct.pack("<iiQQ8d", int(number), model, int(width), int(height), *map(float, numbers))
    for head, body in zip(images[::2], images[1::2], strict=True):
        packed[1] += struct.pack("<i7di", int(head[0]), *map(float, head[1:8]), int(head[8])) + head[9].encode() + b"\0"
        packed[1] += struct.pack("<Q", len(body) // 3)
        for u, v, point in zip(body[::3], body[1::3], body[2::3], strict=True):
            packed[1] += struct.pack("<ddq", float(u), float(v), int(point))
    for number, *place in (row[:4] for row in points):
        packed[2] += struct.pack("<Q3d3BdQii", int(number), *map(float, place), 1, 2, 3, 0.5, 1, 1, 0)
    counts = len(cameras), len(images) // 2, len(points)
    for name, count, content in zip(("cameras", "images", "points3D"), counts, packed, strict=True):
        (folder / f"{name}.bin").write_bytes(struct.pack("<Q", count) + content)
    return folder


def test_a_binary_model_is_that_in_text(tmp_path):
    text = read_colmap(write_colmap(tmp_path), rate=20)
    binary = read_colmap(pack_colmap(tmp_path, tmp_path / "sparse"), rate=20)
    assert (binary.camera, binary.numbers) == (text.camera, text.numbers)
    for mine, other in ((binary.pixels, text.pixels), (binary.seen, text.seen), (binary.points, text.points)):
        np.testing.assert_array_equal(mine, other)
    np.testing.assert_array_equal(binary.poses.position, text.poses.position)
    found = read_folder(tmp_path, rate=20)
    assert found.sentence == f"This is a folder of COLMAP, with 40 images, 3 points in {tmp_path}."
    fisheye = read_colmap(pack_colmap(tmp_path, tmp_path / "fisheye", 5), rate=20).camera
    assert (fisheye.lens, fisheye.distortion) == ("equidistant", text.camera.distortion)
    for cut, message in ((20, "ends too early"), (-3, "no model of COLMAP")):
        (tmp_path / "sparse" / "images.bin").write_bytes((tmp_path / "sparse" / "images.bin").read_bytes()[:cut])
        with pytest.raises(ValueError, match=message):
            read_colmap(tmp_path / "sparse", rate=20)


def test_times_are_read_from_the_names_of_images(tmp_path):
    names = [f"{1403636579763555584 + 50_000_000 * k}.png" for k in range(40)]
    model = read_colmap(write_colmap(tmp_path, names=names), clock=Clock(1403636579763555584, 1e-9))
    np.testing.assert_allclose(model.poses.time, TIME, atol=1e-9)
    letters = [f"{chr(97 + k // 26)}{chr(97 + k % 26)}.png" for k in range(40)]
    np.testing.assert_allclose(read_colmap(write_colmap(tmp_path, names=letters), rate=20).poses.time, TIME)


@pytest.mark.parametrize(
    ("settings", "how", "message"),
    [
        ({"model": "FOV 752 480 1 1 0 0 0"}, {"rate": 20}, "model FOV, none of SIMPLE_PIN"),
        ({"model": "PINHOLE 752 480 wide 1 0 0"}, {"rate": 20}, "is no model of COLMAP"),
        ({"model": "OPENCV_FISHEYE 752 480 500 500 320 240"}, {"rate": 20}, "with 4 parameters, not 8"),
        ({"names": ["a.png"] * 40}, {}, "image 'a.png' without a number for its time; give its rate"),
        ({"names": ["1.png"] * 40}, {}, "images with the same time"),
        ({"names": [""] * 40}, {"rate": 20}, "expected two images, and names"),
        ({}, {"rate": -1.0}, "rate is -1.0; it must be positive"),
        ({"model": "PINHOLE 752"}, {"rate": 20}, r"line 2 of cameras\.txt"),
        ({}, {"rate": 20, "clock": Clock(tick=1e-9)}, "give one of the two"),
    ],
)
def test_what_is_no_model_is_refused(tmp_path, settings, how, message):
    with pytest.raises(ValueError, match=message):
        read_colmap(write_colmap(tmp_path, **settings), **how)


@pytest.mark.parametrize("settings", [{"gap": 0.0}, {"shortest": -1.0}])
def test_tracks_of_a_model_are_split_by_times(tmp_path, settings):
    with pytest.raises(ValueError, match="expected a positive gap, and 0 or more"):
        read_colmap(write_colmap(tmp_path), rate=20).recordings(**settings)


def test_a_folder_without_a_model_and_images_for_poses_are_told(tmp_path):
    with pytest.raises(FileNotFoundError, match=r"name a folder with cameras.txt"):
        read_colmap(tmp_path)
    with pytest.raises(ValueError, match=r"this is images.txt of COLMAP, .* read its folder with .*read_colmap"):
        read_tum(write_colmap(tmp_path) / "images.txt")


# Tables of pandas.


def test_recordings_and_runs_are_tables_of_pandas():
    recording = record(scenarios.ma2005_eq35(), 1)
    table = recording.to_pandas()
    assert table.columns.tolist() == ["time", "y1", "y2", "true_y1", "true_y2", "true_y3"]
    np.testing.assert_array_equal(table[["y1", "y2"]], recording.outputs)
    run = track(recording, ekf(form_of(recording)))
    table = run.to_pandas()
    np.testing.assert_array_equal(table["estimated_y3"], run.estimate[:, 2])
    np.testing.assert_allclose(table["deviation_y3"] ** 2, run.covariance[:, 2, 2])


def form_of(recording):

    return PerspectiveSystem(recording.motion, recording.imaging_surface).measure(*recording.names)
