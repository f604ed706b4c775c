"""Marks by the shipped checks: an answer is a literal, and what a student wrote runs only if a teacher asks for it."""

from __future__ import annotations

import ast
import contextlib
import io
import json
import os
import signal
import subprocess
import sys
import tempfile
import warnings
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from percept_obs.exercises.copies import CHECK

LONGEST = 4000
"""Largest number of characters of an answer."""

LIMITS = {"RLIMIT_CPU": 120, "RLIMIT_AS": 8 << 30, "RLIMIT_FSIZE": 1 << 24, "RLIMIT_NOFILE": 256}
"""Seconds of processor, bytes of memory and of a file, and open files of a student's program."""
SECONDS = 600
"""Longest time that a student's program may run, whether it computes or waits."""

CHILD = """
import ctypes, json, resource, sys
given = json.load(sys.stdin)
for limit, most in given["limits"].items():
    resource.setrlimit(getattr(resource, limit), (most, most))
if sys.platform == "linux":
    ctypes.CDLL(None).unshare(0x50000000)  # user and network of its own, where the machine allows it: no network
names = {"__name__": "lesson"}
for program in given["programs"]:
    exec(compile(program, "answer", "exec"), names)
answer = names[given["name"]]
with open("answer", "w") as file:
    file.write(repr(answer.tolist() if hasattr(answer, "tolist") else answer))
"""


def programs(notebook: Mapping[str, Any]) -> Iterator[tuple[str, str, str]]:
    """Yield the code of a notebook without solutions: a task or "", what comes before its check, and the check."""
    for cell in (each for each in notebook["cells"] if each["cell_type"] == "code"):
        tags, text = cell["metadata"].get("tags", ()), "".join(cell["source"])
        if "exercise" in tags and cell.get("id", "").endswith(CHECK):
            lines, last = text.splitlines(keepends=True), ast.parse(text).body[-1]
            yield cell["id"].removesuffix(CHECK), "".join(lines[: last.lineno - 1]), ast.unparse(last)
        elif "solution" not in tags:
            yield "", text, ""


def answered(check: str) -> tuple[str, str]:
    """Return the function of a check and the name of the answer that it is about."""
    call = ast.parse(check, mode="eval").body
    assert isinstance(call, ast.Call)
    return ast.unparse(call.func), ast.unparse(call.args[0])


def lesson(notebook: Mapping[str, Any]) -> dict[str, Any]:
    """Return the names after the cells of a notebook that belong to no exercise."""
    names: dict[str, Any] = {"__name__": "lesson"}
    with _aside():
        for program in (before for task, before, _ in programs(notebook) if not task):
            exec(compile(program, "lesson", "exec"), names)
    return names


def marks(
    notebook: Mapping[str, Any], names: Mapping[str, Any], answers: Mapping[str, Any]
) -> Iterator[tuple[str, bool | None, str]]:
    """Yield for each answer, after a lesson, its task, whether it is right, and what the check replied."""
    own = dict(names)
    for task, before, check in (part for part in programs(notebook) if part[0]):
        own[answered(check)[1]] = answers.get(task, ...)
        try:
            with _aside():
                exec(compile(before, task, "exec"), own)
                reply = eval(compile(check, task, "eval"), own)
                mark = reply.right, str(reply)
        except Exception as error:  # whatever an answer makes a check raise, it has no mark
            mark = None, f"the check cannot run: {error}"
        if task in answers:
            yield task, *mark


@contextlib.contextmanager
def _aside() -> Iterator[None]:
    """Run shipped code in a folder of its own, without its pictures, prints and warnings."""
    import matplotlib as mpl

    mpl.use("agg")
    with tempfile.TemporaryDirectory() as place, contextlib.chdir(place), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
            yield


def run(source: str, notebook: Mapping[str, Any], task: str) -> str:
    """Run a student's cell after the shipped ones, with limits, and return the answer's text; it is not evaluated.

    A ValueError says if there is none.
    """
    if sys.platform == "win32":
        raise ValueError("--run needs limits that Windows does not have; run it on Linux or macOS")
    parts = list(programs(notebook))
    here = next(k for k, part in enumerate(parts) if part[0] == task)
    given = {"limits": LIMITS, "programs": [*(part[1] for part in parts[:here]), source]}
    kept = {key: os.environ[key] for key in ("PATH", "PYTHONPATH", "LANG") if key in os.environ}
    with tempfile.TemporaryDirectory() as place:
        child = subprocess.Popen(
            [sys.executable, "-c", CHILD],
            cwd=place,
            env={**kept, "HOME": place, "MPLBACKEND": "agg"},
            stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
            text=True,
        )
        try:
            with contextlib.suppress(subprocess.TimeoutExpired, BrokenPipeError):
                child.communicate(json.dumps({**given, "name": answered(parts[here][2])[1]}), timeout=SECONDS)
        finally:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(child.pid, signal.SIGKILL)  # and what it has started
        answer = Path(place, "answer")
        if child.wait() or answer.is_symlink() or not answer.is_file():
            raise ValueError("its cell did not come to an end")
        with open(answer, encoding="utf-8", errors="replace") as file:
            return file.read(LONGEST)
