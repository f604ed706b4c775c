"""Files are known by their first lines; times that cannot be and repeated ones are told, and what to do with them."""

import numpy as np
import pytest
from camera_paths import poses

from percept_obs import Clock, PixelCamera, Recording, read_euroc, read_folder, read_kitti, read_tum
from percept_obs.recording import Unlikely
from percept_obs.recording.imu import read_imu

TIME = np.arange(20) / 20
SECONDS = tuple(map(str, TIME))
POSES = poses(TIME)
NANO = 1403636579763555584
NANOS = [str(NANO + 50_000_000 * k) for k in range(20)]


def rows(time, *columns, separator=" "):
    """Text of rows with times as text and columns of numbers."""
    cells = zip(time, np.column_stack(columns).tolist(), strict=True)
    return "\n".join(separator.join([text, *map(repr, numbers)]) for text, numbers in cells) + "\n"


def tum(time=SECONDS):
    return rows(time, POSES.position, POSES.orientation)


def euroc(time=tuple(NANOS)):
    return rows(time, POSES.position, POSES.orientation[:, [3, 0, 1, 2]], separator=",")


def imu(time=tuple(NANOS)):
    return rows(time, 5 * np.ones((20, 6)), separator=",")


def kitti():
    matrices = np.dstack([POSES.rotation.as_matrix(), POSES.position]).reshape(20, 12)
    return "\n".join(" ".join(f"{number:.9e}" for number in row) for row in matrices)


def written(folder, text, name="file.txt"):
    (folder / name).parent.mkdir(parents=True, exist_ok=True)
    (folder / name).write_text(text)
    return folder / name


OTHERS = {
    "KITTI: poses as 12 numbers a line": kitti(),
    "matrices 4 x 4": kitti().replace("\n", " 0 0 0 1\n"),
    "a trajectory in TUM's format": tum(),
    "a trajectory in EuRoC's format": euroc(),
    "an IMU's table": imu(),
    "a list of images": "1.5 rgb/1.5.png\n",
    "a list of times": "0.0\n0.1\n",
    "a calibration of KITTI": "P0: " + " ".join(["1.0"] * 12),
    "a bag of ROS": "#ROSBAG V2.0\n",
    "no text": "\1\0\0\0",
}
READERS = {
    read_tum: "a trajectory in TUM's",
    read_euroc: "a trajectory in EuRoC's",
    read_imu: "an IMU's",
    read_kitti: "KITTI",
    lambda file: Recording.from_csv(file, POSES.motion()): "a table",
}


@pytest.mark.parametrize("reader", READERS)
@pytest.mark.parametrize("kind", OTHERS)
def test_every_reader_says_what_another_file_is(tmp_path, reader, kind):
    if not kind.startswith(READERS[reader]):
        with pytest.raises(ValueError, match=f"file.txt: this is {kind}"):
            reader(written(tmp_path, OTHERS[kind]))


def test_poses_of_kitti_have_the_times_of_their_sequence(tmp_path):
    file, times = written(tmp_path, kitti()), written(tmp_path, "\n".join(map(str, TIME)), "times.txt")
    for found in (read_kitti(file, times), read_kitti(file, rate=20)):
        np.testing.assert_allclose(found.time, TIME)
        np.testing.assert_allclose(found.position, POSES.position, atol=1e-8)
        assert (found.rotation.inv() * POSES.rotation).magnitude().max() < 1e-7
    with pytest.raises(ValueError, match=r"have no times; give times='times.txt', or rate=10"):
        read_kitti(file)
    with pytest.raises(ValueError, match="not both"):
        read_kitti(file, times, rate=20)
    with pytest.raises(ValueError, match=r"has 20 poses, and .* 3 times"):
        read_kitti(file, written(tmp_path, "0\n0.1\n0.2\n", "few.txt"))


@pytest.mark.parametrize(("reader", "text"), [(read_tum, tum), (read_euroc, euroc), (read_imu, imu)])
def test_repeated_times_are_refused_or_dropped_and_counted(tmp_path, reader, text):
    lines = text().splitlines()
    file = written(tmp_path, "\n".join([*lines[:5], lines[4], *lines[5:9], lines[8], lines[8], *lines[9:]]))
    with pytest.raises(ValueError, match=r'3 of 23 rows .* the first is row 6; repeated="drop" leaves them out'):
        reader(file)
    with pytest.warns(Unlikely, match="3 of 23 rows of .* have the time of the row before, and are left out"):
        found = reader(file, repeated="drop")
    assert len(getattr(found, "time", None) if reader is not read_imu else found.signal.times) == 20


@pytest.mark.parametrize(
    ("reader", "text", "unit"),
    [
        (read_tum, tum([f"{each}.000000" for each in NANOS]), r"nanoseconds, give clock=Clock\(tick=1e-09\)"),
        (read_tum, tum([str(int(each) // 10**3) for each in NANOS]), r"microseconds, give clock=Clock\(tick=1e-06\)"),
        (read_tum, tum([str(int(each) // 10**6) for each in NANOS]), r"milliseconds, give clock=Clock\(tick=0.001\)"),
        (read_euroc, euroc([str(each) for each in TIME]), r"seconds, give clock=Clock\(tick=1\)"),
        (read_imu, imu([str(each) for each in TIME]), r"seconds, give clock=Clock\(tick=1\)"),
    ],
)
def test_times_that_cannot_be_are_refused_with_their_unit(tmp_path, reader, text, unit):
    with pytest.raises(ValueError, match=f"from row to row, which cannot be; if they are {unit}"):
        reader(written(tmp_path, text))


def test_nanoseconds_are_read_with_their_clock(tmp_path):
    file = written(tmp_path, tum([f"{each}.000000" for each in NANOS]))
    np.testing.assert_allclose(read_tum(file, Clock(NANO, 1e-9)).time, TIME, atol=1e-9)


def test_speeds_that_cannot_be_are_refused(tmp_path):
    with pytest.raises(ValueError, match="m/s, which cannot be; are the positions in millimetres"):
        read_tum(written(tmp_path, rows(map(str, TIME), 1e5 * POSES.position, POSES.orientation)))


@pytest.mark.parametrize("digits", [5, 7])
def test_times_that_a_spreadsheet_has_rounded_are_lost(tmp_path, digits):
    file = written(tmp_path, imu([f"{float(each):.{digits}E}" for each in NANOS]))
    with pytest.raises(ValueError, match="as a spreadsheet stores them: the steps between its rows are lost; export"):
        read_imu(file, repeated="drop")


def test_times_that_a_spreadsheet_has_rounded_a_little_are_said(tmp_path):
    with pytest.warns(Unlikely, match="rounded to 0.0001 s as a spreadsheet stores them: the steps of 0.05 s"):
        read_imu(written(tmp_path, imu([f"{float(each):.13E}".replace("E+18", "E+018") for each in NANOS])))


SENSOR = "T_BS: {data: [1, 0, 0, 0.1, 0, 1, 0, 0.2, 0, 0, 1, 0.3, 0, 0, 0, 1]}\nintrinsics: [458, 457, 367, 248]\n"


def test_a_folder_of_euroc_has_the_cameras_poses(tmp_path):
    for name, text in (
        ("state_groundtruth_estimate0/data.csv", euroc()),
        ("imu0/data.csv", imu()),
        ("cam0/sensor.yaml", SENSOR),
    ):
        written(tmp_path, text, f"mav0/{name}")
    found = read_folder(tmp_path)
    said = "the camera cam0 and its mount, an IMU, 20 poses in state_groundtruth_estimate0, of the camera."
    assert found.sentence == f"This is a folder of EuRoC, with {said}"
    body = read_euroc(tmp_path / "mav0" / "state_groundtruth_estimate0" / "data.csv")
    np.testing.assert_allclose(found.poses.position, body.mounted(*found.mount).position)
    assert (found.camera.focal, found.imu.signal.times[0]) == ((458.0, 457.0), body.time[0])


def test_a_folder_of_kitti_has_the_left_camera(tmp_path):
    written(tmp_path, kitti(), "poses/00.txt")
    written(tmp_path, "P0: 718 0 607 0 0 718 185 0 0 0 1 0\nP1: 1\n", "sequences/00/calib.txt")
    written(tmp_path, "\n".join(map(str, TIME)), "sequences/00/times.txt")
    found = read_folder(tmp_path / "sequences" / "00")
    assert found.sentence == "This is a folder of KITTI, with 20 poses in 00.txt, the left camera."
    assert found.camera == PixelCamera((718, 718), (607, 185))
    np.testing.assert_allclose(found.poses.time, TIME)


def test_a_folder_of_tum_has_its_ground_truth(tmp_path):
    written(tmp_path, tum(), "groundtruth.txt")
    written(tmp_path, tum(), "estimate.txt")
    found = read_folder(tmp_path)
    assert found.sentence == "This is a folder of TUM, with 20 poses in groundtruth.txt, and did not read estimate.txt."


def test_a_folder_of_nothing_says_what_it_has(tmp_path):
    with pytest.raises(FileNotFoundError, match="there is no folder"):
        read_folder(tmp_path / "none")
    written(tmp_path, "a,b\n", "table.csv")
    with pytest.raises(ValueError, match=r"is no folder of COLMAP .* it has table.csv"):
        read_folder(tmp_path)
