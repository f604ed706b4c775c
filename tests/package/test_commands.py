"""Each command that a text names, and each option, is run to its end and keeps its promise; Ctrl-C ends it in words."""

import csv
import os
import re
import shlex
import shutil
import signal
import subprocess
import sys
from itertools import chain, product
from pathlib import Path

import numpy as np
import psutil
import pytest
from jupyter_harness import is_up, wait_until
from places import ROOT

from percept_obs import cli
from percept_obs.exercises.models import notebooks
from percept_obs.film import Board, example_film
from percept_obs.site import TEXTS
from percept_obs.site.notebooks import NOT_RUN

TEXT = {path.name: path.read_text("utf-8") for path in (ROOT / "README.md", ROOT / "CONTRIBUTING.md")}
TEXT |= {path.name: path.read_text("utf-8") for path in sorted(Path(TEXTS).glob("*.md"))}
TEXT |= {
    name: "\n\n".join("".join(cell["source"]) for cell in notebook["cells"] if cell["cell_type"] == "markdown")
    for name, notebook in notebooks().items()
}
PROGRAMS = "percept-obs|python|pip|npm|git|sudo|cd|pre-commit|ruff|mypy|nbgrader|otter"


def commands(text):
    """Commands of a text: in its blocks for a shell, in indented lines and between backquotes."""
    blocks = re.findall(r"^```(?:bash|powershell)\n(.*?)^```", text, re.MULTILINE | re.DOTALL)
    yield from chain.from_iterable(parts(line) for block in blocks for line in block.splitlines())
    rest = re.sub(r"^```.*?^```", "", text, flags=re.MULTILINE | re.DOTALL)
    for quoted, indented in re.findall(r"`([^`\n]+)`|^    (\S.*)", rest, re.MULTILINE):
        for each in parts(quoted or indented):
            if re.match(rf"({PROGRAMS}) |\.ci/run", each):
                yield each


def parts(line):
    """Commands of a line, the same on every system, without what is set for them."""
    for part in line.strip("()").split(" && "):
        plain = re.sub(r"^([A-Z_]+=\S+ )*(\.venv(/bin/|\\Scripts\\))?", "", part)
        yield re.sub(r"^(python3|py) ", "python ", plain)


NAMED = {command: name for name, text in TEXT.items() for command in commands(text)}

# What each of them promises.


def has_notebooks(folder, said):
    """True if a folder has all notebooks, the first of which holds something."""
    found = {path.name: path for path in Path(folder).glob("*.ipynb")}
    return found.keys() == notebooks().keys() and said in found["00_start.ipynb"].read_text("utf-8")


def of_a_class(printed):
    assert has_notebooks("class/Ada Lovelace", '"student": "Ada Lovelace"')
    with open("marks.csv", encoding="utf-8-sig", newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["student"] for row in rows] == ["Ada Lovelace", "Emmy Noether"]
    assert not any(row["handed in"] == "missing" or row["faults"] for row in rows), rows
    assert printed.count(": see marks.csv") == 2


def of_copies(printed):
    assert has_notebooks("source/observers", '"grade_id"')
    assert has_notebooks("sources", "# ASSIGNMENT CONFIG")
    assert has_notebooks("percept_obs_notebooks", "gain = ...")
    assert has_notebooks("again", "gain = ...")


def of_an_exam(printed):
    made = {path: path.read_text("utf-8") for folder in (".", "there") for path in Path(folder).glob("exam_2026A_*")}
    assert len(made) == 4
    assert len({*made.values()}) == 2, "the same name gives the same version"


def of_a_film(printed):
    assert Board.from_json("board.json") == Board()
    assert Board.from_json("printed/board.json") == Board(9, 6, 0.0255, 0.02)
    assert all(Path(folder, "board.pdf").read_bytes()[:5] == b"%PDF-" for folder in (".", "printed"))
    means = []
    for folder in map(Path, ("film_distances", "shorter")):
        assert f"open {folder / 'index.html'}" in printed
        page = (folder / "index.html").read_text("utf-8")
        for name in ("film.mp4", "lab.html"):
            assert f'="{name}"' in page
            assert (folder / name).stat().st_size > 1e5
        rows = csv.DictReader((folder / "distances.csv").read_text("utf-8").splitlines())
        means.append(np.mean([float(row["distance"]) for row in rows]))
    assert means[1] / means[0] == pytest.approx(0.97, rel=0.01), "the ruler scales all distances"


def of_equations(printed):
    assert "Ma, Chen and Moore 2005, (38)" in printed
    assert "Ma, Chen and Moore 2005, figure 3" in printed
    assert Path("page.html").read_text("utf-8").count("<caption>") == 2
    assert "Inaba" in printed.split(" judged in ")[1]


def of_comparisons(printed):
    table = re.findall(
        r"^\| ([\w -]+) \| (\d+) \| (\d+) \| (\S+) \| ([\d.]+) \|$", TEXT["04_all_observers.ipynb"], re.M
    )
    shown = {name: [float(cell.replace("none", "inf")) for cell in cells] for name, *cells in table}
    found = {}
    for name, failed, reset, rest in re.findall(r"^(\S.*?\S) +(\d+) +(\d+) +\d+ (.*)$", printed.split("(36)")[0], re.M):
        settling, _, rms, _ = re.findall(r"(\S+) \(", rest)
        found[name] = [*map(float, (failed, reset, settling, rms))]
    assert found == shown
    assert "y1+y2, 2 seeds, uniform noise of +-0.02, 4 s" in printed.split("(36)")[1]


ROSTER = re.search(r"```\n(student.*?)```", TEXT["marks.md"], re.DOTALL)[1].encode()
DAYS = {
    of_a_class: """
        percept-obs lab --student "Ada Lovelace" --copy-only "class/Ada Lovelace"
        percept-obs lab --student "Emmy Noether" --copy-only "class/Emmy Noether"
        percept-obs collect class --roster roster.csv -o marks.csv
        percept-obs collect class --output marks.csv --run
        """,
    of_copies: """
        percept-obs lab --for nbgrader --copy-only source/observers
        percept-obs lab --for otter --copy-only sources
        percept-obs lab --copy-only
        percept-obs lab --copy-only --for students again
        """,
    of_an_exam: """
        percept-obs exam 2026A
        percept-obs exam 2026A there
        """,
    of_a_film: """
        percept-obs board
        percept-obs board printed --paper letter --columns 9 --rows 6 --square 25.5 --marker 20
        percept-obs film film.mp4 --board board.json
        percept-obs film film.mp4 shorter --ruler 97 --tracks 5
        """,
    of_equations: """
        percept-obs check 38 "figure 3" --paper Ma --html page.html
        percept-obs check --paper Inaba
        """,
    of_comparisons: """
        percept-obs compare --outputs y1 --seeds 50
        percept-obs compare --example 36 --outputs y1+y2 --seeds 2 --noise 0.02 --duration 4
        """,
}
"""Command lines of an empty folder, by what looks at all that they have made."""

SERVED = {
    "percept-obs lab": "percept_obs_notebooks",
    "percept-obs lab --for teachers with_solutions": "with_solutions",
    "percept-obs lab --no-browser": "percept_obs_notebooks",
}
"""Command lines that open JupyterLab, and the folder of the copies."""

ELSEWHERE = {
    "percept-obs check": "tests/papers/test_ledgers.py",
    "percept-obs site --for teachers --address {ADDRESS} --python": "tests/support/whole_site.py",
}
"""Costly command lines that other tests run, as these write them."""

THE_SAME = {
    "percept-obs compare": "percept-obs compare --outputs y1 --seeds 50",
    "percept-obs check --paper NAME": "percept-obs check --paper Inaba",
    "percept-obs lab --for teachers": "percept-obs lab --for teachers with_solutions",
    "percept-obs site SITE --without-running": "percept-obs site DIR --without-running",
    **dict.fromkeys(
        (
            "percept-obs site DIR",
            "percept-obs site --for teachers DIR",
            "percept-obs site DIR --python",
            "percept-obs site SITE --python",
        ),
        "percept-obs site --for teachers --address {ADDRESS} --python",
    ),
}
"""Command lines that ask for a part of what another one does, by its defaults or for a name of one's own."""

WITHOUT_RUNNING = "percept-obs site DIR --without-running"
BY_OTHERS = {
    r"sudo apt-get install python3-venv( libatomic1)?": (".ci/run", "install python3-venv"),
    r"git clone": (".github/workflows/tests.yml", "actions/checkout"),
    r"cd percept_obs/labs/front|npm ci": (".ci/run", 'cd "$front" && npm ci'),
    r"python -m venv \.venv": (".ci/run", "python3 -m venv"),
    r'python -m pip install -e "\.\[dev\]"': (".github/workflows/tests.yml", 'python -m pip install -e ".[dev]"'),
    r'python -m pip install -e "\.\[course\]"': ("binder/postBuild", '".[course]"'),
    r"(python -m )?pip install (-e )?.(\.|percept-obs)\[(site|site,lite)\].": ("pyproject.toml", "[course,site,lite,"),
    r"pip install heyoka diffrax": ("tests/benchmarks/other_packages.py", "import heyoka"),
    r"pre-commit install": (".pre-commit-config.yaml", "ruff check"),
    r"ruff check|ruff format --check|mypy|\.ci/run": (".ci/run", "ruff format --check"),
    r"\.ci/run (page|studies)": (".github/workflows/nightly.yml", "studies"),
    r"python -m pytest .*": (".ci/run", "-m pytest -n auto"),
    r"npm (run (build(:exercises)?|lint|types)|test)": ("tests/labs/test_lab_base.py", '"build:exercises"'),
    r"npm run record": ("percept_obs/labs/front/tests/drawn.test.js", "npm run record"),
    r"python -m percept_obs\.labs\.printing": ("tests/labs/test_lab_printing.py", "printing.changed"),
    r"python tests/support/readme\.py.*": ("tests/package/test_readme.py", "with_owner"),
    r"python tests/support/utias_cut\.py": ("tests/recording/test_datasets.py", "from utias_cut"),
    r"python tests/support/course_class\.py 05": ("tests/exercises/test_course.py", "from course_class"),
    r"python tests/support/in_browser\.py SITE": ("tests/support/in_browser.py", "percept-obs site SITE --python"),
    r"python tests/benchmarks/bench_ensemble\.py .*": (".ci/run", "tests/benchmarks/bench_*.py"),
    r"(nbgrader|otter) .*": ("tests/exercises/test_graders.py", '"generate_assignment"'),
}
"""Command lines of other programs, and who runs them: a file, and what stands in it."""

RUN = [line.strip() for day in DAYS.values() for line in day.strip().splitlines()]
RUN += [*SERVED, *ELSEWHERE, WITHOUT_RUNNING]


def test_every_command_that_a_text_names_is_run():
    ours = {command for command in NAMED if command.startswith("percept-obs ")}
    assert len(ours) > 15
    assert {THE_SAME.get(command, command) for command in ours} <= {*RUN}
    assert THE_SAME.keys() <= ours
    assert {*THE_SAME.values()} <= {*RUN}
    for command in NAMED.keys() - ours:
        assert any(re.fullmatch(known, command) for known in BY_OTHERS), f"who runs {command} of {NAMED[command]}?"
    for known, (file, there) in BY_OTHERS.items():
        assert any(re.fullmatch(known, command) for command in NAMED), known
        assert there in (ROOT / file).read_text("utf-8"), (file, there)
    for line, file in ELSEWHERE.items():
        words = [word.strip("{}") if word[0] == "{" else f'"{word}"' for word in line.split()[1:]]
        assert f"cli.main([{', '.join(words)}" in (ROOT / file).read_text("utf-8"), (line, file)


def test_every_option_is_run(capsys):
    def help_of(*command):
        with pytest.raises(SystemExit) as stop:
            cli.main([*command, "--help"])
        assert stop.value.code == 0
        return capsys.readouterr().out

    words = {word for line in RUN for word in product([line.split()[1]], shlex.split(line)[2:])}
    subcommands = re.findall(r"^    (\w+) +\S", help_of(), re.MULTILINE)
    assert {name for name, _ in words} <= {*subcommands}
    options = {(name, option) for name in subcommands for option in re.findall(r" (--[\w-]+)", help_of(name))}
    assert len(options) > 20
    assert options - {(name, "--help") for name in subcommands} - words == set()


# The runs.


@pytest.mark.slow
@pytest.mark.parametrize("promised", DAYS, ids=lambda promised: promised.__name__)
def test_it_is_run_to_its_end(promised, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    if promised is of_a_class:
        Path("roster.csv").write_bytes(ROSTER)
    if promised is of_a_film:
        shutil.copy(example_film(), "film.mp4")
    for line in DAYS[promised].strip().splitlines():
        assert cli.main(shlex.split(line)[1:]) == 0, capsys.readouterr().err
    printed = capsys.readouterr()
    assert printed.err.rpartition("\r")[2] == "", "more than bars of progress"
    promised(printed.out)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")  # the generator's own
def test_all_pages_are_written_without_running(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert cli.main(shlex.split(WITHOUT_RUNNING)[1:]) == 0
    for name in notebooks():
        assert NOT_RUN in Path("DIR/notebooks", name).with_suffix(".html").read_text("utf-8")
    assert "recorded, not computed here" in Path("DIR/ledger/ma2005/38.html").read_text("utf-8")
    assert Path("DIR/index.html").exists()


def started(line, folder, **settings):
    """A process of a command line, with a group of its own."""
    command = [sys.executable, "-m", "percept_obs.cli", *shlex.split(line)[1:]]
    return subprocess.Popen(command, cwd=folder, text=True, start_new_session=True, **settings)


signals = pytest.mark.skipif(sys.platform == "win32", reason="has no groups of processes, and no such signals")


@pytest.mark.slow
@signals
@pytest.mark.parametrize("line", SERVED)
def test_jupyterlab_answers_and_asks_before_control_c_ends_it(line, tmp_path):
    folder, log = tmp_path / "empty", tmp_path / "log"
    folder.mkdir()
    home = os.environ | {"HOME": str(tmp_path), "BROWSER": "echo shown %s"}
    with log.open("w") as file:
        process = started(line, folder, env=home, stdin=subprocess.PIPE, stdout=file, stderr=file)
    try:
        address = re.compile(r"http://\S+/lab/tree/00_start\.ipynb\?token=\w+")
        wait_until(lambda: address.search(log.read_text("utf-8")) or process.poll() is not None, "an address")
        wait_until(lambda: is_up(address.search(log.read_text("utf-8"))[0], process, log), "JupyterLab")
        assert ("shown" in log.read_text("utf-8")) is ("--no-browser" not in line)
        assert has_notebooks(folder / SERVED[line], "gain = 8" if "teachers" in line else "gain = ...")
        os.killpg(process.pid, signal.SIGINT)
        process.communicate("y\n", timeout=60)
        assert process.returncode == 0
    finally:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()


def at_work(process):
    """Processes of a process that compute, without those that keep order."""
    children = process.children(recursive=True)
    ends = [each for each in children if not each.children() and "resource_tracker" not in " ".join(each.cmdline())]
    return [each for each in ends if each.cpu_times().user > 0.1]


BEGUN = {
    "percept-obs film film.mp4": lambda process: process.cpu_times().user > 0.2,  # while it is imported
    "percept-obs compare --seeds 150": lambda process: process.cpu_times().user > 4,
    "percept-obs check": lambda process: len(at_work(process)) > 1 or os.cpu_count() == 1,
}
"""Command lines, and when they are stopped."""


def stopped(line, folder, stop):
    """The exit code of a command line that is stopped, and what it says then."""
    process = started(line, folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    seen = psutil.Process(process.pid)
    wait_until(lambda: process.poll() is not None or BEGUN[line](seen), "it to begin")
    assert process.poll() is None, process.communicate()[1]
    others = seen.children(recursive=True)
    stop(seen)
    said = process.communicate(timeout=60)[1]
    assert psutil.wait_procs(others, 60)[1] == [], "it leaves processes behind"
    assert "Traceback" not in said
    return process.returncode, said.splitlines()[-1]


@pytest.mark.slow
@signals
@pytest.mark.parametrize("line", BEGUN)
def test_control_c_is_answered_by_a_sentence(line, tmp_path):
    shutil.copy(example_film(), tmp_path / "film.mp4")
    found = stopped(line, tmp_path, lambda process: os.killpg(process.pid, signal.SIGINT))
    assert found == (130, "percept-obs: interrupted")
    assert [path.name for path in tmp_path.iterdir()] == ["film.mp4"]


@pytest.mark.slow
@signals
@pytest.mark.skipif(os.cpu_count() == 1, reason="one processor has no further processes")
def test_an_end_of_one_of_its_processes_is_told_by_a_sentence(tmp_path):
    code, said = stopped("percept-obs check", tmp_path, lambda process: at_work(process)[0].kill())
    assert code == 1
    assert said.startswith("percept-obs: the system ended a process of this command")
