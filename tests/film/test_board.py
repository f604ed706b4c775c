"""A board is printed to true size, OpenCV finds its corners where it says they are, and its code holds its numbers."""

import json
from dataclasses import asdict

import cv2
import matplotlib
import numpy as np
import pypdfium2 as pdfium
import pytest

from percept_obs import cli
from percept_obs.film import Board, board_pdf
from percept_obs.film.board import other_markers
from percept_obs.film.printing import largest_square

MM = 10  # pixels in the pictures of pages
BOARDS = [Board(), Board(9, 6, 0.029, 0.02), Board(3, 3, 0.059, 0.04425)]


@pytest.fixture(scope="module", params=["A4", "letter"])
def paper(request):
    return request.param


@pytest.fixture(scope="module", params=BOARDS, ids=lambda board: board.name)
def board(request):
    return request.param


@pytest.fixture(scope="module")
def page(board, paper):
    """The printed page in grey values."""
    document = pdfium.PdfDocument(board_pdf(board, paper))
    assert len(document) == 1
    picture = document[0].render(scale=25.4 * MM / 72, grayscale=True).to_numpy().copy()
    document.close()
    return picture


@pytest.fixture(scope="module")
def found(board, page):
    """The corners on the page in mm from its upper left, and their numbers; a pixel's centre is half a pixel in."""
    numbers, pixels, _ = board.detect(page)
    return numbers, (pixels + 0.5) / MM


def runs(line):
    """Begin and end of the black parts of a line of pixels."""
    edges = np.diff((np.r_[255, line, 255] < 128).astype(int))
    return np.flatnonzero(edges == 1), np.flatnonzero(edges == -1)


@pytest.mark.parametrize(("paper", "size"), [("A4", (297, 210)), ("letter", (11 * 25.4, 8.5 * 25.4))])
def test_the_page_has_the_paper_s_size(paper, size):
    document = pdfium.PdfDocument(board_pdf(Board(), paper))
    assert np.multiply(document[0].get_size(), 25.4 / 72) == pytest.approx(size, abs=0.01)
    document.close()


def test_every_corner_is_where_true_size_says(board, page, found):
    numbers, corners = found
    assert numbers.tolist() == list(range(len(board.points)))
    away = corners - 1000 * board.points[:, :2]
    assert np.abs(away - away.mean(axis=0)).max() < 0.1
    left, right = away[:, 0].mean(), page.shape[1] / MM - away[:, 0].mean() - 1000 * board.size[0]
    assert left == pytest.approx(right, abs=0.2)


def test_white_surrounds_the_board_and_lines_the_page(board, page, found):
    left, top = (found[1] - 1000 * board.points[:, :2]).mean(axis=0)
    width, height = 1000 * np.array(board.size)
    y, x = (np.arange(n)[:, None] / MM + 0.5 / MM for n in page.shape)
    outside = np.maximum(np.maximum(left - x.T, x.T - left - width), np.maximum(top - y, y - top - height))
    assert page[np.abs(outside) < 0.3].min() == 0, "the board ends elsewhere"
    assert page[(outside > 0.3) & (outside < board.marker * 1000 / 6 - 0.1)].min() == 255
    page = page.copy()
    page[5 * MM : -5 * MM, 5 * MM : -5 * MM] = 255
    assert page.min() == 255, "a printer would cut it"


def test_the_ruler_is_100_mm_long(board, page, found):
    below = round(MM * (found[1][:, 1].max() + 1000 * board.square)) + 2
    longest, row = max((np.max(np.subtract(*reversed(runs(page[y]))), initial=0), y) for y in range(below, len(page)))
    assert longest / MM == pytest.approx(100, abs=0.2)
    begin, end = runs(page[row - 7])  # through the ticks, which stand on the line
    ticks = ((begin + end) / 2)[:101] / MM
    assert ticks - ticks[0] == pytest.approx(np.arange(101), abs=0.1)


def test_the_code_holds_what_the_file_holds(board, page, tmp_path):
    text, *_ = cv2.QRCodeDetector().detectAndDecode(page)
    (tmp_path / "board.json").write_text(board.text)
    assert text == board.text
    assert json.loads(text) == asdict(board)
    assert Board.from_json(tmp_path / "board.json") == board


def test_the_page_names_the_board(board):
    document = pdfium.PdfDocument(board_pdf(board))
    text = document[0].get_textpage().get_text_range()
    document.close()
    assert board.name in text
    assert "the ruler must be 100 mm" in text


def test_the_points_are_opencv_s(board):
    assert board.points == pytest.approx(board.charuco.getChessboardCorners(), abs=1e-8)


@pytest.mark.slow
def test_a_board_of_other_markers_is_named():
    other = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_APRILTAG_36h11)
    picture = cv2.aruco.CharucoBoard((7, 5), 0.036, 0.027, other).generateImage((280, 200), marginSize=10)
    assert other_markers(255 - picture) == ["markers white on black, of another dictionary, DICT_APRILTAG_36h11"]
    ours = np.pad(Board().picture(20), 80, constant_values=255)
    ours[16:64, 16:64] = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_1000).generateImageMarker(700, 48)
    assert other_markers(ours) == []


@pytest.mark.parametrize(("columns", "rows"), [(7, 5), (3, 3), (3, 33)])
def test_the_largest_squares_fit_and_larger_ones_do_not(columns, rows, paper):
    square = largest_square(columns, rows, papers=[paper])
    assert board_pdf(Board(columns, rows, square / 1000, 0.75 * square / 1000), paper)
    with pytest.raises(ValueError, match=f"on {paper} paper; with squares of {square} mm they do"):
        board_pdf(Board(columns, rows, (square + 1) / 1000, 0.75 * (square + 1) / 1000), paper)


def test_what_is_left_out_gives_the_default_board():
    assert largest_square(7, 5) == 36
    assert min(largest_square(7, 5, papers=[paper]) for paper in ("A4", "letter")) == 36


def test_the_same_board_gives_the_same_bytes_whatever_the_settings():
    usual = board_pdf(Board())
    with matplotlib.rc_context({"savefig.bbox": "tight", "figure.facecolor": "black", "text.color": "white"}):
        assert board_pdf(Board()) == usual
    assert board_pdf(Board(marker=0.026)) != usual


@pytest.mark.parametrize("ruler", [97.5, 100, 104.0])
def test_a_board_printed_otherwise_has_the_ruler_s_scale(ruler):
    printed = Board().printed(ruler)
    assert printed.points == pytest.approx(Board().points * ruler / 100)
    assert printed.marker / printed.square == pytest.approx(0.75)


@pytest.mark.parametrize(
    ("make", "sentence"),
    [
        (lambda: Board(2, 5), "2 x 5 squares; it needs 3 x 3"),
        (lambda: Board(11, 10), "at most 100 squares"),
        (lambda: Board(square=0.03, marker=0.03), "the marker must be smaller"),
        (lambda: Board(square=36), "the square 1 m at most"),
        (lambda: Board().picture(3), "give at least 8 a square"),
        (lambda: Board().detect("picture.png"), "expected grey values of 8 bits"),
        (lambda: Board().printed(9.75), "the ruler measures 9.75 mm; expected about 100"),
        (lambda: board_pdf(Board(square=36e-6, marker=27e-6)), "markers of 0.027 mm are too small to be filmed"),
        (lambda: board_pdf(Board(), "A5"), "there is no paper 'A5'; there are A4, letter"),
    ],
)
def test_a_wrong_board_is_refused_with_a_sentence(make, sentence):
    with pytest.raises(ValueError, match=sentence):
        make()


@pytest.mark.parametrize(
    "text", ["[" * 100_000, "", "[7, 5]", '{"columns": 7}', '{"columns": 7, "square": "0.04"}', '{"colour": "red"}']
)
def test_a_file_of_something_else_is_no_board(tmp_path, text):
    file = tmp_path / "my board.json"
    file.write_text(text)
    with pytest.raises(ValueError, match=r"my board.json' is no file of a board.*percept-obs board"):
        Board.from_json(file)


def test_the_command_writes_the_page_and_the_numbers_and_says_what_to_do(tmp_path, capsys):
    folder = tmp_path / "new" / "to print"
    for _ in range(2):  # the second time nothing changes
        assert cli.main(["board", str(folder)]) == 0
        assert {file.name for file in folder.iterdir()} == {"board.pdf", "board.json"}
        assert Board.from_json(folder / "board.json") == Board()
        assert (folder / "board.pdf").read_bytes() == board_pdf(Board())
        first, second, name, *steps = capsys.readouterr().out.splitlines()
        assert (first, second) == (f"wrote   {folder / 'board.pdf'}", f"wrote   {folder / 'board.json'}")
        assert name == Board().name
        assert [step[:2] for step in steps] == ["1.", "2.", "3."]


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["--square", "40"], "with squares of 36 mm they do"),
        (["--square", "0.036"], "too small to be filmed"),
        (["--marker", "36"], "the marker must be smaller"),
        (["--columns", "2"], "2 x 5 squares"),
        (["--columns", "3000"], "at most 100 squares"),
    ],
)
def test_the_command_refuses_a_wrong_board_and_writes_nothing(tmp_path, capsys, arguments, sentence):
    assert cli.main(["board", str(tmp_path / "new"), *arguments]) == 2
    assert sentence in capsys.readouterr().err
    assert not (tmp_path / "new").exists()


@pytest.mark.parametrize("name", ["board.pdf", "board.json"])
def test_the_command_overwrites_nothing_else(tmp_path, capsys, name):
    (tmp_path / name).write_text("mine")
    assert cli.main(["board", str(tmp_path)]) == 2
    assert f"{name} is there and holds something else" in capsys.readouterr().err
    assert [file.read_text() for file in tmp_path.iterdir()] == ["mine"]


def test_a_missing_opencv_is_named_and_how_to_get_it(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr("percept_obs.validation.environment.find_spec", lambda name: None)
    assert cli.main(["board", str(tmp_path / "new")]) == 2
    assert 'cv2 is missing; get it with: python -m pip install "percept-obs[film]"' in capsys.readouterr().err
    assert not (tmp_path / "new").exists()
