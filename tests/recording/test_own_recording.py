"""Files of one's own become recordings: what is written is read back, and the real recording rebuilt is the same."""

import ast

import numpy as np
import pytest
from camera_paths import poses, seen, write_stereo_mat
from places import DATA
from scipy.io import loadmat, savemat

from percept_obs import Clock, PixelCamera, Poses, Recording, pinhole, read_euroc, read_tum, sphere
from percept_obs.recording import Unlikely
from percept_obs.recording.pose_files import write_tum
from percept_obs.recording.stereo_mat import read_stereo_mat
from percept_obs.recording.track_files import write_tracks
from percept_obs.recording.utias import UTIAS_CUT
from percept_obs.recording.worked import WORKED_CAMERA, worked_folder
from percept_obs.site import TEXTS

TIME = np.arange(0, 2, 0.01)
POSES = poses(TIME)
MOTION = POSES.motion()
CAMERA = PixelCamera((484.5, 480.0), (321.7, 247.5))
LENS = PixelCamera((484.5, 480.0), (321.7, 247.5), distortion=(-0.28, 0.09, 0.001, -0.0005, 0.01))
EXACT = {"rtol": 1e-12, "atol": 1e-12}


def tracks(lost=5, stereo=True):
    """Two points, irregularly sampled; the second is lost for a moment and has no truth there."""
    rows = np.flatnonzero(np.random.default_rng(0).random(180) < 0.3)
    found = []
    for number, points in enumerate(seen(TIME)[:2]):
        truth = pinhole().project(points[rows])
        outputs = truth[:, :2].copy()
        if number:
            outputs[lost], truth[lost, 2] = np.nan, np.nan
        distances = {"stereo": 1.01 * points[rows, 2]} if stereo else {}
        found.append(Recording(TIME[rows], outputs, ("y1", "y2"), pinhole(), MOTION, truth, distances=distances))
    return found


MOUNT = Poses(np.arange(2.0), np.tile([0.1, 0.0, -0.05], (2, 1)), np.tile([0, 0, np.sqrt(0.5), np.sqrt(0.5)], (2, 1)))


def write_stereo(path, landmarks=True):
    """Write a file of a stereo camera mounted on a body that moves as `POSES`; return its images."""
    images = np.random.default_rng(1).uniform(200, 300, (len(TIME), 3, 4))
    images[..., 2] -= 150
    images[50:60, 1] = np.nan
    places = np.array([[0.1, 0, 2], [0, 0.1, 3], [0.2, 0.2, 2.5]]) if landmarks else None
    write_stereo_mat(path, POSES, MOUNT, images, CAMERA, 0.24, places)
    return images


# Written and read back.


def test_tum_is_read_back(tmp_path):
    write_tum(tmp_path / "p", POSES)
    back = read_tum(tmp_path / "p")
    for name in ("time", "position", "orientation"):
        np.testing.assert_allclose(getattr(back, name), getattr(POSES, name), **EXACT, err_msg=name)


def test_the_orders_of_the_quaternions_are_those_of_the_formats(tmp_path):
    (tmp_path / "tum").write_text("# a comment\n0 1 2 3 0.1 0.2 0.3 0.927361849549570\n1 1 2 3 0 0 0 1\n")
    (tmp_path / "euroc").write_text(
        "#time [ns], p, q_w q_x q_y q_z, v\n0,1,2,3,0.927361849549570,0.1,0.2,0.3,9,9\n20000000,1,2,3,1,0,0,0,9,9\n"
    )
    for back in (read_tum(tmp_path / "tum"), read_euroc(tmp_path / "euroc")):
        np.testing.assert_allclose(back.orientation, [[0.1, 0.2, 0.3, 0.92736184954957], [0, 0, 0, 1]])
        assert back.position[0].tolist() == [1, 2, 3]
    assert read_euroc(tmp_path / "euroc").time == pytest.approx([0, 0.02])
    assert read_euroc(tmp_path / "euroc", Clock(zero=20_000_000, tick=1e-9)).time.tolist() == pytest.approx([-0.02, 0])
    assert read_tum(tmp_path / "tum", Clock(zero=1, tick=0.5)).time.tolist() == [-0.5, 0]


@pytest.mark.parametrize("landmarks", [True, False])
def test_a_stereo_file_is_read_back(tmp_path, landmarks):
    images = write_stereo(tmp_path / "s.mat", landmarks)
    back = read_stereo_mat(tmp_path / "s.mat", shortest=0.4, gap=0.1)
    np.testing.assert_allclose(back.images, images, **EXACT)
    camera = POSES.mounted(MOUNT.position[0], MOUNT.orientation[0])
    for name in ("time", "position"):
        np.testing.assert_allclose(getattr(back.poses, name), getattr(camera, name), **EXACT)
    assert np.abs((back.poses.rotation.inv() * camera.rotation).as_rotvec()).max() < 1e-12
    assert (back.camera, back.baseline) == (CAMERA, 0.24)
    assert landmarks == (back.landmarks is not None)
    recordings = back.recordings("mine")
    assert [len(each.time) for each in recordings] == [50, 200, 200, 140]
    assert recordings[0].distances["stereo"][0] == pytest.approx(484.5 * 0.24 / (images[0, 1, 0] - images[0, 1, 2]))
    assert (recordings[0].truth is not None) == landmarks


def test_poses_beyond_the_images_are_cut_and_told(tmp_path):
    """Most drives of KITTI have them."""
    write_stereo(tmp_path / "s.mat")
    values = {key: each for key, each in loadmat(tmp_path / "s.mat").items() if not key.startswith("__")}
    longer = {key: np.hstack([values[key], np.full((3, 40), np.nan)]) for key in ("r_i_vk_i", "theta_vk_i")}
    savemat(tmp_path / "long.mat", values | longer)
    with pytest.warns(Unlikely, match="240 poses and 200 times: the first 200 poses are read, and the last 40"):
        back = read_stereo_mat(tmp_path / "long.mat")
    there = read_stereo_mat(tmp_path / "s.mat").path
    for name in ("time", "position", "orientation", "velocity", "angular_velocity"):
        np.testing.assert_array_equal(getattr(back.path, name), getattr(there, name), err_msg=name)


@pytest.mark.parametrize("camera", [None, CAMERA, LENS], ids=["image coordinates", "pixels", "pixels behind a lens"])
def test_a_table_is_read_back(tmp_path, camera):
    written = tracks()
    write_tracks(tmp_path / "t.csv", written, camera)
    depth = {"camera": camera, "point": "point_id", "depth": "depth", "distances": ["stereo"]}
    back = Recording.from_csv(tmp_path / "t.csv", MOTION, **depth)
    for one, two in zip(back, written, strict=True):
        np.testing.assert_allclose(one.time, two.time, **EXACT)
        np.testing.assert_allclose(one.outputs, two.outputs, **EXACT)
        np.testing.assert_allclose(one.truth[:, 2], two.truth[:, 2], **EXACT)
        np.testing.assert_allclose(one.distances["stereo"], two.distances["stereo"], **EXACT)


def test_what_a_clock_reads_is_exact_however_late():
    late = Clock(zero=1403636579763555584, tick=1e-9)
    assert late.seconds(["1403636579763555585"])[0] == 1e-9
    assert Clock(np.int64(1403636579763555584), np.float64(1e-9)) == late


# The table of a class's own.


def worked(**settings):
    motion = read_tum(worked_folder() / "poses.txt").motion()
    clock = {"clock": Clock(zero=500, tick=1e-3), "camera": WORKED_CAMERA, "point": "point_id"}
    return Recording.from_csv(worked_folder() / "tracks.csv", motion, **(clock | settings))


def test_the_worked_table_holds_everything():
    near, far = worked(depth="depth", distances=["laser"], pixel_sigma=0.5)
    assert (near.source, far.source) == ("tracks.csv, point near", "tracks.csv, point far")
    assert near.time[0] == pytest.approx(0.1)
    assert np.flatnonzero(np.isnan(near.outputs[:, 0])).tolist() == [5]
    assert np.flatnonzero(np.isnan(far.truth[:, 2])).tolist() == [4]
    assert np.diff(far.time).max() == pytest.approx(0.6)
    assert np.isfinite(near.distances["laser"]).sum() == 6
    assert near.noise_variance == pytest.approx((0.5 / 484.5) ** 2)
    assert worked()[0].truth is None
    parts = worked(gap=0.3)
    assert [each.source.rpartition(", ")[2] for each in parts] == ["part 1", "part 2"] * 2
    assert [each.source for each in worked(gap=0.5, shortest=1.5)] == [
        "tracks.csv, point near",
        "tracks.csv, point far",
    ]


@pytest.mark.parametrize("lost", ["", "nan", "NaN"])
def test_nothing_and_nan_are_lost_samples(tmp_path, lost):
    (tmp_path / "t.csv").write_text(f"time,y1,y2\n0,0.1,0.1\n0.1,{lost},0.1\n0.2,0.1,0.1\n")
    assert Recording.from_csv(tmp_path / "t.csv", MOTION).seen.tolist() == [True, False, True]


def test_pixels_become_rays_on_any_surface(tmp_path):
    write_tracks(tmp_path / "t.csv", tracks(), LENS)
    seen_flat, _ = Recording.from_csv(tmp_path / "t.csv", MOTION, camera=LENS, point="point_id", depth="depth")
    seen_round, _ = Recording.from_csv(tmp_path / "t.csv", MOTION, sphere(), camera=LENS, point="point_id")
    expected = sphere().project(seen_flat.points)[:, :2]
    np.testing.assert_allclose(seen_round.outputs, expected, **EXACT)


def test_rows_without_a_motion_are_left_out_and_told(tmp_path):
    write_tracks(tmp_path / "t.csv", tracks())
    known = poses(np.arange(0.5, 1.5, 0.01)).motion()
    with pytest.warns(Unlikely, match=r"rows are left out; if these are two clocks, give clock=Clock\(zero="):
        first, _ = Recording.from_csv(tmp_path / "t.csv", known, point="point_id")
    assert first.time[0] >= 0.5
    assert first.time[-1] < 1.5
    for last, told in (
        ("0.1,b,0,0", "1 sightings of a single sample"),
        ("0,b,,\n0.1,b,,", "1 points without any sample"),
    ):
        (tmp_path / "t.csv").write_text(f"time,id,y1,y2\n0,a,0,0\n0.1,a,0,0\n{last}\n")
        with pytest.warns(Unlikely, match=f"{told} are left out"):
            assert len(Recording.from_csv(tmp_path / "t.csv", MOTION, point="id")) == 1


def test_a_table_with_comments_and_spaces_is_the_plain_one(tmp_path):
    """Plain tables are read in another way."""
    rows = [
        "time , id,u,v, note",
        "0.50, b ,300,200,x",
        "0.5,a,301,,",
        "0.60,b,302.5,1e2,y",
        "0.6,a,nan,2,",
        "0.7,a,1,3,",
    ]
    rows += ["0.8,a,1,4,z"]
    (tmp_path / "t.csv").write_text("# a comment\n\n" + "\n# another\n".join(rows))
    (tmp_path / "plain.csv").write_text("\n".join(rows).replace(" ", ""))
    (tmp_path / "headed.csv").write_text("\ufeff# a comment\n\n" + "\n".join(rows).replace(" ", ""), encoding="utf-8")
    files = ("t.csv", "plain.csv", "headed.csv")
    read = [Recording.from_csv(tmp_path / name, MOTION, camera=CAMERA, point="id") for name in files]
    for recordings in read:
        assert [each.source[-7:] for each in recordings] == ["point b", "point a"]
        for one, two in zip(recordings, read[0], strict=True):
            np.testing.assert_array_equal(one.time, two.time)
            np.testing.assert_array_equal(one.outputs, two.outputs)


# The real recording, the way of one's own.


@pytest.fixture(scope="module")
def utias_files(tmp_path_factory):
    """The real recording as poses.txt and tracks.csv, with the poses as they were recorded."""
    folder, recorded = tmp_path_factory.mktemp("own"), read_stereo_mat(UTIAS_CUT)
    write_tum(folder / "poses.txt", recorded.poses)
    recordings = recorded.recordings("UTIAS")
    write_tracks(folder / "tracks.csv", recordings, recorded.camera)
    return folder, recordings


def test_the_real_recording_rebuilt_is_the_same(utias_files):
    folder, recordings = utias_files
    motion = read_tum(folder / "poses.txt").motion()
    np.testing.assert_allclose(motion.signal.samples, recordings[0].motion.signal.samples, atol=1e-9)
    camera = read_stereo_mat(UTIAS_CUT).camera
    back = Recording.from_csv(
        folder / "tracks.csv", motion, camera=camera, point="point_id", depth="depth", distances=["stereo"]
    )
    assert len(back) == 44
    for one, two in zip(back, recordings, strict=True):
        np.testing.assert_allclose(one.time, two.time, **EXACT)
        np.testing.assert_allclose(one.outputs, two.outputs, **EXACT)
        np.testing.assert_allclose(one.distance, two.distance, **EXACT)
        np.testing.assert_allclose(one.distances["stereo"], two.distances["stereo"], **EXACT)


def test_tracks_that_another_program_wrote_are_the_same(utias_files):
    """It names its columns in its own way, prints thousandths of a pixel, and smooths the poses in another way."""
    file, recordings = DATA / "utias/tracks.csv", utias_files[1]
    camera = read_stereo_mat(UTIAS_CUT).camera
    named = {"time": "time_s", "pixels": ("u_px", "v_px"), "point": "point_id", "depth": "depth_m_truth"}
    back = Recording.from_csv(file, recordings[0].motion, camera=camera, **named)
    assert len(back) == 44
    for one, two in zip(back, recordings, strict=True):
        rows = np.searchsorted(two.time, one.time - 1e-3)
        np.testing.assert_allclose(one.time, two.time[rows], atol=1e-6)
        np.testing.assert_allclose(one.outputs, two.outputs[rows], atol=2e-6)
        np.testing.assert_allclose(one.distance, two.distance[rows], rtol=0.01)


@pytest.mark.slow
def test_from_a_folder_to_a_table_of_all_observers_in_eight_lines(tmp_path, monkeypatch):
    """The lines are those of the page on recordings."""
    lines = (TEXTS / "own.md").read_text("utf-8").split("<!-- own recording -->\n```python\n")[1].split("```")[0]
    assert len(list(filter(None, lines.splitlines()))) <= 8
    *program, table = ast.parse(lines).body
    names = {}
    exec(compile(ast.Module(program[:2], []), "<own.md>", "exec"), names)
    exec(compile(ast.Module([program[3]], []), "<own.md>", "exec"), names)
    write_tum(tmp_path / "poses.txt", poses(TIME, noise=1e-4))
    films = []
    for points in seen(TIME)[:4]:
        truth = pinhole().project(points[5:190:5])
        films.append(Recording(TIME[5:190:5], truth[:, :2], ("y1", "y2"), pinhole(), MOTION, truth))
    write_tracks(tmp_path / "tracks.csv", films, names["camera"])
    monkeypatch.chdir(tmp_path)
    exec(compile(ast.Module(program, []), "<own.md>", "exec"), names)
    found = eval(compile(ast.Expression(table.value), "<own.md>", "eval"), names)
    assert (len(found.choosing), len(found.reporting)) == (2, 2)
    table = found.side_by_side
    assert len(table) == 12
    assert "needs a motion with constant coefficients" in table.loc["immersion and invariance", "remark"]
    assert found.summary.loc["extended Kalman", "truth 1 s"] < 0.05
