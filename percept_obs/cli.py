"""The command line: notebooks, pages, verdicts on equations, comparisons, and boards to print.

The package is imported where it is used: while it is, `main` already answers Ctrl-C.
"""

import argparse
import json
import os
import subprocess
import sys
from collections.abc import Callable, Sequence
from concurrent.futures import BrokenExecutor
from importlib import util
from pathlib import Path
from time import perf_counter
from typing import Any

FIRST_NOTEBOOK = "00_start.ipynb"


def copy_notebooks(directory: str | Path, readers: str = "students", student: str | None = None) -> None:
    """Copy the notebooks for their readers into a directory, which may be new, and leave whatever is there as it is."""
    from percept_obs.exercises import COPIES, GRADERS, individual
    from percept_obs.exercises.models import notebooks
    from percept_obs.validation import write_whole

    if readers not in {**COPIES, **GRADERS}:
        raise ValueError(f"readers is {readers!r}; there are {', '.join((*COPIES, *GRADERS))}")
    shipped = {name: each if student is None else individual(each, student) for name, each in notebooks().items()}
    Path(directory).mkdir(parents=True, exist_ok=True)
    for name, notebook in shipped.items():
        target = Path(directory) / name
        if target.exists():
            print(f"kept    {target}")
        else:
            copy = json.dumps({**COPIES, **GRADERS}[readers](notebook), indent=1, ensure_ascii=False)
            write_whole(target, f"{copy}\n".encode())
            print(f"copied  {target}")


def lab(options: argparse.Namespace) -> int:
    """Copy the notebooks and open the first one in JupyterLab."""
    directory: Path = options.directory
    _refuse_a_file(directory)
    if not options.copy_only and util.find_spec("jupyterlab") is None:
        raise _Mistake(f'JupyterLab is missing; get it with: {sys.executable} -m pip install "percept-obs[course]"', 1)
    copy_notebooks(directory, options.readers, options.student)
    if options.copy_only:
        return 0

    # As an address rather than a file: so the link that JupyterLab prints leads to the notebook as well.
    address = f"--LabApp.default_url=/lab/tree/{FIRST_NOTEBOOK}"
    command = [sys.executable, "-m", "jupyterlab", "--ServerApp.root_dir=.", address]
    if options.no_browser:
        command.append("--no-browser")
    # In a container everyone is root, and JupyterLab refuses root unless told.
    if getattr(os, "geteuid", lambda: None)() == 0:
        command.append("--allow-root")
    with subprocess.Popen(command, cwd=directory) as server:
        while True:
            try:
                return server.wait()
            except KeyboardInterrupt:  # reaches JupyterLab too, which asks before it stops
                continue


def collect(options: argparse.Namespace) -> int:
    """Mark the notebooks of a class in one table; nothing that a student wrote is run, unless --run says so."""
    import pandas as pd

    from percept_obs.exercises.collecting import collect, filled_in
    from percept_obs.validation import to_write, write_whole

    earlier: Any = None
    if to_write(options.output, ".csv", ".txt").exists():
        earlier = pd.read_csv(options.output, dtype=str, keep_default_na=False, encoding="utf-8-sig")
        if "student" not in earlier:
            raise _Mistake(f"{options.output} is no earlier table, for it has no column student; name another file")
    table = collect(options.directory, options.roster, options.run_code)
    table = table if earlier is None else filled_in(table, earlier)
    write_whole(options.output, table.to_csv(index=False).encode("utf-8-sig"))
    states = table["handed in"].str.split(" by").str[0].value_counts()
    print(f"{', '.join(f'{count} {state}' for state, count in states.items())}: see {options.output}")
    return 0


def exam(options: argparse.Namespace) -> int:
    """Write a version of the exam with other numbers, and its solutions for teachers, which are computed anew."""
    from percept_obs.site.exam import exam
    from percept_obs.validation import write_whole

    if not options.seed.isalnum():
        raise _Mistake(f"{options.seed!r} cannot be part of a file's name; name a version with letters and digits")
    _refuse_a_file(options.directory)
    options.directory.mkdir(parents=True, exist_ok=True)
    for name, text in zip(("questions", "solutions"), exam(options.seed), strict=True):
        target = options.directory / f"exam_{options.seed}_{name}.md"
        write_whole(target, text.encode())
        print(f"wrote   {target}")
    return 0


def site(options: argparse.Namespace) -> int:
    """Write the course as pages that need neither Python nor a network, with live labs, equations and reference."""
    from percept_obs.exercises.models import notebooks
    from percept_obs.site import SiteFault, build

    _refuse_a_file(options.directory)
    try:
        exam, run = options.readers == "teachers", () if options.without_running else None
        build(options.directory, notebooks(), exam=exam, address=options.address, python=options.python, run=run)
    except (SiteFault, OSError, ModuleNotFoundError) as error:
        raise _Mistake(str(error), 1) from None
    return 0


def check(options: argparse.Namespace) -> int:
    """Print a verdict on each of the papers' equations, or on some, and how it is known."""
    from percept_obs.papers import find, judge, page, report
    from percept_obs.validation import to_write, write_whole

    ledgers = find(options.places, options.paper)
    if options.html:
        to_write(options.html, ".html", ".htm")
    began = perf_counter()
    held = judge(ledgers)
    if options.places:
        print("\n\n".join(f"{ledger.paper}, {entry}" for ledger in ledgers for entry in ledger.entries))
    else:
        print(report(ledgers))
    count = sum(len(ledger.entries) for ledger in ledgers)
    print(f"\n{count} judged in {perf_counter() - began:.1f} s")
    if options.html:
        write_whole(options.html, page(ledgers).encode())
    return 0 if held else 1


def compare(options: argparse.Namespace) -> int:
    """Run every observer on the same noisy recordings of Ma's examples, from a start of zero, and print a table."""
    from percept_obs.observers import OBSERVERS
    from percept_obs.recording import Camera, Uniform, record
    from percept_obs.recording.scenarios import ma2005_eq35, ma2005_eq36
    from percept_obs.studies.comparison import compare
    from percept_obs.system.motion import affine
    from percept_obs.system.perspective import PerspectiveSystem
    from percept_obs.system.surfaces import pinhole
    from percept_obs.validation import limit

    scenario = {"35": ma2005_eq35, "36": ma2005_eq36}[options.example]()
    form = PerspectiveSystem(affine(), pinhole()).measure(*options.outputs.split("+"))
    refusals = {make: make.refusal(form) for make in OBSERVERS}
    observers = [make(form) for make, refusal in refusals.items() if not refusal]
    camera = Camera(noise=Uniform(options.noise))
    samples = options.seeds * options.duration / camera.period
    limit(samples * len(observers), "samples to follow", "take fewer --seeds or a shorter --duration")
    recordings = [record(scenario, options.duration, camera, seed) for seed in range(options.seeds)]
    found = compare(recordings, observers, (0.0, 0.0, 0.0), 0.05, after=options.duration / 4, coordinates=["y3"])
    print(
        f"{scenario.name}, {options.outputs}, {options.seeds} seeds, uniform noise of +-{options.noise:g}, "
        f"{options.duration:g} s at 100 Hz, held; errors of 1/Z from {options.duration / 4:g} s on; "
        "medians with the 16 % and 84 % quantiles; a run fails if its error does not stay below 0.05"
    )
    print(found)
    print("\n".join(filter(None, refusals.values())))
    return 0


def film(options: argparse.Namespace) -> int:
    """Read a film of a board; write it with distances drawn in, a live lab, tables, and a page that shows them."""
    from percept_obs.film import Board, read_film
    from percept_obs.film.page import page
    from percept_obs.labs import observer_lab
    from percept_obs.studies.all_observers import all_observers
    from percept_obs.validation import write_whole

    board = (Board.from_json(options.board) if options.board else Board()).printed(options.ruler)
    directory = options.directory or options.file.with_name(f"{options.file.stem}_distances")
    _refuse_a_file(directory)
    found = read_film(options.file, board)
    directory.mkdir(parents=True, exist_ok=True)
    print(found.sentence)
    table = all_observers(found, max_tracks=options.tracks)
    print(table)
    found.overlay(directory / "film.mp4")
    observer_lab(found).save(directory / "lab.html")
    points = found.distances()
    write_whole(directory / "distances.csv", points.to_csv(index=False).encode())
    write_whole(directory / "index.html", page(found, points, table, "film.mp4", "lab.html").encode())
    print(f"open {directory / 'index.html'}")
    return 0


STEPS = """1. Print board.pdf at 100 %, not "fit to page".
2. Measure the ruler below the board: it must be 100 mm. If it is 97.5 mm, say --ruler 97.5 when you read the film.
3. Lay the board flat, put things around it, and film for 20 s while you move the telephone slowly past them."""


def board(options: argparse.Namespace) -> int:
    """Write a chessboard with markers to print and to film: board.pdf to true size, and its numbers, board.json."""
    from percept_obs.film import Board, board_pdf
    from percept_obs.film.printing import SHARE, largest_square
    from percept_obs.validation import write_whole

    directory: Path = options.directory
    _refuse_a_file(directory)
    square = options.square or largest_square(options.columns, options.rows)
    marker = options.marker or SHARE * square
    made = Board(options.columns, options.rows, square / 1000, marker / 1000)
    files = {
        directory / "board.pdf": board_pdf(made, options.paper),
        directory / "board.json": made.text.encode(),
    }
    for target, content in files.items():
        if target.exists() and target.read_bytes() != content:
            raise _Mistake(f"{target} is there and holds something else; name another folder, or delete it")
    directory.mkdir(parents=True, exist_ok=True)
    for target, content in files.items():
        write_whole(target, content)
        print(f"wrote   {target}")
    print(f"{made.name}\n{STEPS}")
    return 0


class _Mistake(ValueError):
    """Raised with a message and an exit code."""

    def __init__(self, message: str, code: int = 2) -> None:
        super().__init__(message)
        self.code = code


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return its exit code: 0, 1 for a failure, 2 for a wrong request, 130 after Ctrl-C."""
    if hasattr(sys.stdout, "reconfigure"):
        sys.stdout.reconfigure(errors="backslashreplace")  # a name may have letters that the terminal has not
    try:
        options = _asked(arguments)
        return options.run(options)
    except (ValueError, ModuleNotFoundError) as error:
        print(f"percept-obs: {error}", file=sys.stderr)
        return getattr(error, "code", 2)
    except OSError as error:
        said = f"cannot use {error.filename}: {error.strerror}" if error.strerror else error
        print(f"percept-obs: {said}", file=sys.stderr)
        return 2
    except BrokenExecutor:
        print("percept-obs: the system ended a process of this command, perhaps for want of memory", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("\npercept-obs: interrupted", file=sys.stderr)
        return 130


def _asked(arguments: Sequence[str] | None) -> argparse.Namespace:
    """Return what a command line asks for; argparse ends the program where it is none."""
    from percept_obs.exercises import COPIES, GRADERS

    parser = argparse.ArgumentParser(prog="percept-obs", description="Observers for perspective dynamic systems.")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")

    def command(run: Callable[[argparse.Namespace], int], purpose: str) -> Callable[..., argparse.Action]:
        added = commands.add_parser(run.__name__, help=purpose, description=run.__doc__)
        added.set_defaults(run=run)
        return added.add_argument

    readers: dict[str, Any] = {
        "dest": "readers",
        "choices": tuple(COPIES),
        "default": "students",
        "help": "students' copies hold the exercises and no solution, teachers' hold all (default: %(default)s)",
    }
    add = command(lab, "open the notebooks in JupyterLab")
    copies = "where your copies live (default: ./%(default)s); nothing is overwritten"
    add("directory", nargs="?", type=Path, default=Path("percept_obs_notebooks"), metavar="DIR", help=copies)
    tools = f"{readers['help']}; nbgrader and otter get the sources of their assignments"
    add("--for", **readers | {"choices": (*COPIES, *GRADERS), "help": tools})
    add("--student", metavar="NAME", help="make the exercises a student's own: numbers follow from the name")
    add("--copy-only", action="store_true", help="copy the notebooks, do not open them")
    add("--no-browser", action="store_true", help="start JupyterLab without a browser")

    add = command(collect, "mark a class's notebooks")
    add("directory", type=Path, metavar="DIR", help="holds a folder a student, with the notebooks handed in")
    add("-o", "--output", type=Path, default=Path("marks.csv"), metavar="FILE", help="the table (default: %(default)s)")
    add("--roster", type=Path, metavar="FILE", help="CSV file with columns student and, if need be, folder and due")
    limits = "also run the cells of answers that are no plain text or number, with limits, but as you: see the site"
    add("--run", dest="run_code", action="store_true", help=limits)

    add = command(exam, "write a version of the exam")
    add(
        "seed",
        metavar="SEED",
        help="name or number of the version, such as 2026A; it gives the same numbers everywhere",
    )
    add("directory", nargs="?", type=Path, default=Path("."), metavar="DIR", help="folder of the files (default: here)")

    add = command(site, "write the course as pages")
    add("directory", type=Path, metavar="DIR", help="folder of the pages")
    add("--for", **readers)
    stand = "where the pages will stand, for links to themselves and a sitemap"
    add("--address", default="", metavar="URL", help=stand)
    add(
        "--python", action="store_true", help="add JupyterLite, in which a reader runs the notebooks without installing"
    )
    fast = "run no notebook and judge no equation: all pages, without results, within a minute"
    add("--without-running", action="store_true", help=fast)

    add = command(check, "judge the papers' equations")
    add("places", nargs="*", metavar="PLACE", help='such as "(38)", 38 or "figure 3" (default: all)')
    add("--paper", default="", metavar="NAME", help="part of a name, such as Ma (default: all)")
    add("--html", type=Path, metavar="FILE", help="also write a page with the formulas")

    add = command(compare, "run all observers")
    add("--example", choices=("35", "36"), default="35", help="(35) or (36)")
    add("--outputs", choices=("y1", "y2", "y1+y2"), default="y1", help="measured outputs")
    add("--seeds", type=_positive(int), default=50, help="number of recordings")
    add("--noise", type=_positive(float), default=0.01, help="bound of the noise")
    add("--duration", type=_positive(float), default=80.0, help="seconds")

    add = command(film, "find how far things are in a film of a board")
    add("file", type=Path, metavar="FILE", help="a film, such as film.mp4")
    add("directory", nargs="?", type=Path, metavar="DIR", help="folder for the results (default: beside the film)")
    add("--board", type=Path, metavar="FILE", help="board.json of the printed board (default: the default board)")
    ruler = "length that the printed ruler of 100 mm has on paper"
    add("--ruler", type=_positive(float), default=100.0, metavar="MM", help=f"{ruler} (default: %(default)g)")
    add(
        "--tracks", type=_positive(int), default=40, help="most tracks in the table of observers (default: %(default)s)"
    )

    add = command(board, "write a board to print and film")
    add("directory", nargs="?", type=Path, default=Path("."), metavar="DIR", help="folder of the files (default: here)")
    add("--paper", choices=("A4", "letter"), default="A4", help="(default: %(default)s)")
    add("--columns", type=_positive(int), default=7, help="number of squares in a row (default: %(default)s)")
    add("--rows", type=_positive(int), default=5, help="number of rows (default: %(default)s)")
    add("--square", type=_positive(float), metavar="MM", help="side of a square (default: what fits on both papers)")
    add("--marker", type=_positive(float), metavar="MM", help="side of a marker (default: 3/4 of the square's)")

    return parser.parse_args(arguments)


def _refuse_a_file(directory: Path) -> None:
    if directory.exists() and not directory.is_dir():
        raise _Mistake(f"{directory} is a file; name a folder, or a new one")


def _positive(number: type[int] | type[float]) -> Callable[[str], int | float]:
    def read(text: str) -> int | float:
        try:
            value = number(text)
        except ValueError:
            value = 0
        if not 0 < value < float("inf"):
            raise argparse.ArgumentTypeError(f"{text} is not a positive number{', whole' * (number is int)}")
        return value

    return read


if __name__ == "__main__":
    sys.exit(main())
