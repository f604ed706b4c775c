"""A file that is none is refused before any work: what was wrong, in which row, what was expected, what to do."""

import numpy as np
import pytest
from test_own_recording import CAMERA, MOTION, TIME, write_stereo

from percept_obs import BehindCamera, Clock, PixelCamera, Recording, read_euroc, read_tum
from percept_obs.recording.stereo_mat import read_stereo_mat

GOOD = "0 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n2 0 0 0 0 0 0 1\n"


def in_tum(text):
    return read_tum, text


def in_euroc(text):
    rows = [line.split() for line in text.splitlines()]
    seconds = {"0": "0", "1": "1000000000", "2": "2000000000", "0.5": "500000000"}
    return read_euroc, "\n".join(",".join([seconds.get(t, t), *row[:3], *row[6:], *row[3:6]]) for t, *row in rows)


@pytest.mark.parametrize("written", [in_tum, in_euroc])
@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (GOOD, "", "is no table of text .*expected rows such as"),
        (GOOD, "# only comments\n", "is no table of text"),
        ("1 0 0 0 0 0 0 1", "1 nan 0 0 0 0 0 1", "'nan' in row 2 of the column '(tx|p_x)'; write"),
        ("1 0 0 0 0 0 0 1", "1 inf 0 0 0 0 0 1", "'inf' in row 2 of the column '(tx|p_x)'; write"),
        ("1 0 0 0 0 0 0 1", "1 left 0 0 0 0 0 1", "'left' in row 2 of the column '(tx|p_x)'; write"),
        ("1 0 0 0 0 0 0 1", "when 0 0 0 0 0 0 1", "column 'timestamp': row 2 has the time 'when'; every row needs"),
        ("1 0 0 0 0 0 0 1", "inf 0 0 0 0 0 0 1", "row 2 has the time 'inf'"),
        ("1 0 0 0 0 0 0 1", "1e9999999 0 0 0 0 0 0 1", "row 2 has the time '1e9999999'"),
        ("2 0", "0.5 0", r"increase strictly; look at row 3, .*sort the rows"),
        ("1 0 0 0 0 0 0 1", "1 0 0 0 0 0 0 2", "quaternion in row 2 has the length 2, expected 1"),
        ("1 0 0 0 0 0 0 1", "1 0 0 0 0 0 0 0", "quaternion in row 2 has the length 0, expected 1"),
        (GOOD, "0 0 0 0\n1 0 0 0\n", "has 4 columns, and 8 are needed: timestamp, "),
        (GOOD, GOOD[:16], "at least two seconds"),
    ],
)
def test_files_of_poses_that_are_none_are_refused(tmp_path, written, old, new, message):
    assert old in GOOD
    read, text = written(GOOD.replace(old, new, 1))
    (tmp_path / "poses.txt").write_text(text)
    with pytest.raises(ValueError, match=f"(?s){message}"):
        read(tmp_path / "poses.txt")


TABLE = "time,id,u,v,depth\n0,a,300,200,2\n0.1,a,301,200,2\n0.2,a,302,200,2\n"


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (TABLE, "", "is no table of text .*expected rows such as time,id,u,v"),
        (TABLE, TABLE[:18], "header and no rows"),
        (TABLE, TABLE.replace(",", ";"), "put commas between"),
        ("301", "inf", "'inf' in row 2 of the column 'u'; write"),
        ("301", "left", "'left' in row 2 of the column 'u'; write"),
        ("0.1,a", ",a", "column 'time': row 2 has the time ''"),
        ("0.1,a", "0.2,a", "times of the point a do not increase at row 3; sort the rows by time"),
        ("0.1,a", "-0.1,a", "do not increase at row 2"),
        ("0.1,a", "0.1,", "row 2 has no id; every row needs the name of its point"),
        ("id,u", "id,x", "it needs 'u' for the pixels: rename the column, or give its name"),
        ("id,u,v,", "id,u,u,", "two columns of one name, u, among time, id, u, u, depth"),
        ("301", "3_01", "'3_01' in row 2 of the column 'u'; write"),
        ("0.1,a", "0.1_0,a", "row 2 has the time '0.1_0'"),
        ("301,200", "301 # blurred,200", "'301 # blurred' in row 2 of the column 'u'"),
        ("0.1,a", "0.1 # blurred,a", "row 2 has the time '0.1 # blurred'"),
        (TABLE, TABLE.replace("200", ""), "no sample: in no row are all of y1, y2 there"),
        ("time,id,u,v,depth", "time,id,u,v", "rows with more cells than its header"),
        ("301,200,2", "301,200,-2", "has the depth -2 in row 2; a point that is seen is in front of the camera"),
        ("301,200,2", "301,200,0", "has the depth 0 in row 2"),
        ("301,200,2\n", "301,200,2,7\n", "is no table of text"),
        (
            "0,a,300,200,2\n0.1,a,301,200,2\n0.2",
            "50,a,300,200,2\n51,a,301,200,2\n52",
            "the clocks do not overlap; give",
        ),
        (TABLE, "time,id,u,v,depth\n0,a,300,200,2\n0.1,b,300,200,2\n", "no point that is seen twice"),
    ],
)
@pytest.mark.filterwarnings("ignore::percept_obs.recording.Unlikely")
def test_tables_that_are_none_are_refused(tmp_path, old, new, message):
    assert old in TABLE
    (tmp_path / "t.csv").write_text(TABLE.replace(old, new, 1))
    with pytest.raises(ValueError, match=f"(?s){message}"):
        Recording.from_csv(tmp_path / "t.csv", MOTION, camera=CAMERA, point="id", depth="depth")


@pytest.mark.parametrize("header", ["time,y1,Y2", "time,y1,y_2", "time,y1,y2,Y3", "time,y1, y 2 "])
def test_a_misspelt_column_is_asked_back(tmp_path, header):
    cells = ",0.1" * header.count(",")
    (tmp_path / "t.csv").write_text(f"{header}\n0{cells}\n0.1{cells}\n")
    meant = "y3" if "Y3" in header else "y2"
    with pytest.raises(ValueError, match=f"the column '.*'; did you mean '{meant}'"):
        Recording.from_csv(tmp_path / "t.csv", MOTION)


def test_a_point_behind_the_camera_has_its_own_error(tmp_path):
    (tmp_path / "t.csv").write_text(TABLE.replace("301,200,2", "301,200,-2"))
    with pytest.raises(BehindCamera):
        Recording.from_csv(tmp_path / "t.csv", MOTION, camera=CAMERA, point="id", depth="depth")


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"gap": 0.0}, "gap is 0.0 s .* expected a positive gap"),
        ({"shortest": -1.0}, "shortest is -1.0 s"),
        *(({"pixels": names}, "pixels names the columns") for names in (["u"], ["u", "u"])),
        ({"camera": None, "pixel_sigma": 1.0}, "pixel_sigma is in pixels; give also camera"),
        ({"camera": None}, r"it needs 'time' and at least one of y1, y2, or a camera=PixelCamera"),
        ({"point": None, "gap": 1.0}, "name the column of these"),
        ({"point": "nobody"}, "it needs 'nobody'"),
        ({"depth": "height"}, "it needs 'height'"),
        ({"distances": ["laser"]}, "it needs 'laser'"),
        ({"pixel_sigma": -1.0}, "the pixel sigma is -1"),
        ({"camera": PixelCamera((500, 500), distortion=(-2, 0, 0, 0))}, "no direction is seen at the pixel"),
    ],
)
def test_settings_that_no_table_meets_are_refused(tmp_path, settings, message):
    (tmp_path / "t.csv").write_text(TABLE)
    with pytest.raises(ValueError, match=message):
        Recording.from_csv(tmp_path / "t.csv", MOTION, **({"camera": CAMERA, "point": "id"} | settings))


@pytest.mark.parametrize("clock", [{"tick": 0.0}, {"zero": float("inf")}])
def test_a_clock_that_reads_no_time_is_refused(clock):
    with pytest.raises(ValueError, match="reads no time"):
        Clock(**clock)


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("t", None, "has no variable t; it needs t, y_k_j"),
        ("t", np.zeros((2, 2)), r"has the shape \(4, 200, 3\), .* of shape \(4, 4, 3\)"),
        ("t", TIME[::-1], "increase strictly"),
        ("r_i_vk_i", np.zeros((3, 250)), r"has the shape \(3, 250\), .* of shape \(3, 200\)"),
        ("t", TIME[:50], r"has the shape .*expected finite numbers"),
        (
            "theta_vk_i",
            np.full((3, len(TIME)), np.nan),
            "variable theta_vk_i of .* is not finite; expected .* -1 for what was not seen",
        ),
        ("y_k_j", np.full((4, len(TIME), 3), np.inf), "variable y_k_j of .* is not finite"),
        ("y_k_j", np.zeros((3, len(TIME), 3)), r"has the shape \(3, 200, 3\), .* of shape \(4, 200, 3\)"),
        ("rho_i_pj_i", np.zeros((3, 7)), r"has the shape \(3, 7\), .* of shape \(3, 3\)"),
        ("C_c_v", np.zeros((3, 3)), "row 1 is no rotation"),
        ("fu", "wide", "expected real numbers"),
        ("b", -1.0, "baseline b = -1.0 m; it must be positive"),
    ],
)
def test_stereo_files_that_are_none_are_refused(tmp_path, name, value, message):
    from scipy.io import loadmat, savemat

    path = tmp_path / "s.mat"
    write_stereo(path)
    values = {key: each for key, each in loadmat(path).items() if not key.startswith("__")}
    values.pop(name)
    savemat(path, values if value is None else values | {name: value})
    with pytest.raises(ValueError, match=message):
        read_stereo_mat(path)


@pytest.mark.parametrize("content", [b"", b"time,u,v\n0,1,2\n", b"MATLAB 7.3 MAT-file" + bytes(600)])
def test_what_is_no_matlab_file_is_refused(tmp_path, content):
    (tmp_path / "s.mat").write_bytes(content)
    with pytest.raises(ValueError, match="which is no MATLAB file up to version 7"):
        read_stereo_mat(tmp_path / "s.mat")
    with pytest.raises(FileNotFoundError, match="there is no file"):
        read_stereo_mat(tmp_path / "none.mat")


@pytest.mark.parametrize("read", [read_tum, read_euroc, lambda path: Recording.from_csv(path, MOTION)])
def test_what_is_no_text_or_not_there_is_refused(tmp_path, read):
    (tmp_path / "b").write_bytes(bytes(range(256)) * 4)
    with pytest.raises(ValueError, match=r"is no table of text|this is no text|it needs|has \d+ columns"):
        read(tmp_path / "b")
    with pytest.raises(FileNotFoundError, match="there is no file"):
        read(tmp_path / "none")
