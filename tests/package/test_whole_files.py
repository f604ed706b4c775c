"""A file is written whole or stays as it was, everywhere in the package; a file of JSON is read or refused in words."""

import ast
import errno
import re
from pathlib import Path

import pytest

import percept_obs
from percept_obs.validation import read_json, whole, write_whole

PACKAGE = Path(percept_obs.__file__).parent
SOURCES = {
    path.relative_to(PACKAGE).as_posix(): path.read_text("utf-8")
    for depth in ("*", "*/*", "*/*/*")
    for path in PACKAGE.glob(f"{depth}.py")
}
WRITERS = re.compile(
    r"write_text|write_bytes|savefig|save|savez\w*|savetxt|savemat|tofile|dump|to_(csv|json|excel|pickle|netcdf|hdf)|"
    r"imwrite|VideoWriter|ZipFile|copy\w*|open"
)
MADE = re.compile(r"(?:with |, |^\s*)whole\(.*?\) as (\w+)|(\w+) :?= (?:io\.)?(?:Bytes|String)IO\(", re.MULTILINE)
"""What gives a place that may be written: another file of `whole`, or memory."""
BUILT_ANEW = {"site/__init__.py", "site/slides.py", "site/lite.py"}
"""Modules that fill the folder of a site, which is built anew after a fault."""
OUR_LABS = ("observer_lab(found)", "super()")
"""Owners of our own `save`."""


def writers(text):
    """Calls in a source that may leave half a file."""
    made = {name for names in MADE.findall(text) for name in names if name}
    for call in (node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Call)):
        name = getattr(call.func, "attr", getattr(call.func, "id", ""))
        if not WRITERS.fullmatch(name):
            continue
        owner = ast.unparse(call.func).rpartition(".")[0]
        given = [ast.unparse(each) for each in (*call.args, *(word.value for word in call.keywords))]
        place = " ".join([owner] if name.startswith("write_") else given[:1])
        harmless = (
            (name == "open" and not any(re.fullmatch("'[wax][bt]?'|'r\\+b?'", each) for each in given))
            or (name.startswith("to_") and not call.args)  # whose text is returned
            or (name.startswith("copy") and owner != "shutil")
            or owner in OUR_LABS
        )
        if not harmless and not made & {*re.findall(r"\w+", place)}:
            yield ast.unparse(call)


def test_whatever_writes_a_file_writes_it_whole():
    found = {name: [*writers(text)] for name, text in SOURCES.items()}
    assert {name for name, calls in found.items() if calls} == BUILT_ANEW, found
    for call in ("open(path, 'w')", "figure.savefig(path)", "table.to_csv(path)", "av.open(str(path), 'w')"):
        assert [*writers(f"with whole(path) as other:\n    {call}")] == [call]
        assert [*writers(f"with whole(path) as other:\n    {call.replace('path', 'other')}")] == []


@pytest.mark.parametrize("error", [OSError(errno.ENOSPC, "No space left on device"), KeyboardInterrupt()])
def test_a_file_that_cannot_be_ended_leaves_the_one_that_was_there(tmp_path, error):
    file = tmp_path / "film.mp4"
    write_whole(file, b"old")

    def write_half():
        with whole(file) as other:
            other.write_bytes(b"ha")
            raise error

    with pytest.raises(type(error)) as told:
        write_half()
    assert getattr(told.value, "filename", str(file)) == str(file)
    assert [path.read_bytes() for path in tmp_path.iterdir()] == [b"old"]
    with whole(file) as other:
        other.write_bytes(b"new")
    assert [path.read_bytes() for path in tmp_path.iterdir()] == [b"new"]


@pytest.mark.parametrize(
    ("content", "said"),
    [("[" * 100_000 + "]" * 100_000, "nested too deep"), ("{", "cannot be read as JSON"), (b"\xff", "read as JSON")],
)
def test_what_is_no_json_is_refused_in_words(tmp_path, content, said):
    file = tmp_path / "board.json"
    write_whole(file, content if isinstance(content, bytes) else content.encode())
    with pytest.raises(ValueError, match=said):
        read_json(file)
    write_whole(file, b"[" * 100 + b"]" * 100)
    assert str(read_json(file)) == "[" * 100 + "]" * 100


def test_no_file_of_json_is_read_otherwise():
    ours = {"exercises/models.py", "validation/environment.py"}  # the notebooks that are shipped, and `read_json`
    assert {name for name, text in SOURCES.items() if re.search(r"json\.loads?\(.*read", text)} == ours
