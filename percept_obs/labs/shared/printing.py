"""Texts for the page, printed once by a process of its own and then kept, so that no cell waits for sympy."""

from __future__ import annotations

import atexit
import hashlib
import json
import os
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from importlib import import_module, metadata
from pathlib import Path
from typing import Any

Texts = dict[str, Any]
Take = Callable[[str, Texts], None]
Complain = Callable[[str], None]


class Printing:
    """What has been printed so far, and who waits for the rest.

    Parameters
    ----------
    module : str
        Name of a module whose ``texts_of(key)`` gives the texts of a part of the page's model, by its name.
    """

    def __init__(self, module: str) -> None:
        self.module = module
        self.texts: dict[str, Texts] = {}
        self._waiting: list[tuple[Take, Complain]] = []
        self._lock = threading.Lock()
        self._thread: threading.Thread | None = None

    def ask(self, keys: Sequence[str], take: Take, complain: Complain) -> None:
        """Hand over what is there, and the rest from another thread as soon as it is printed, in this order.

        Parameters
        ----------
        keys : sequence of str
            The same names for every lab.
        take : function of a key and its texts
        complain : function of a text
            Called if printing fails.
        """
        with self._lock:
            there = {key: self.texts[key] for key in keys if key in self.texts}
            left = [key for key in keys if key not in there]
            if left:
                self._waiting.append((take, complain))
            if left and self._thread is None:
                self._thread = threading.Thread(target=self._read, args=(left,), daemon=True)
                self._thread.start()
        for key, texts in there.items():
            take(key, texts)

    def _read(self, keys: Sequence[str]) -> None:
        try:
            for key, texts in _printed_beside(self.module, keys):
                with self._lock:
                    self.texts[key] = texts
                    waiting = list(self._waiting)
                for take, _ in waiting:
                    take(key, texts)
        except (OSError, RuntimeError) as error:
            for _, complain in self._waiting:
                complain(f"the equations could not be printed: {error}")
        finally:
            with self._lock:
                self._waiting, self._thread = [], None


def _printed_beside(module: str, keys: Sequence[str]) -> Iterator[tuple[str, Texts]]:
    """Texts by their keys, from a process that does not hear the interrupts that a cell is stopped with."""
    process = subprocess.Popen(
        [sys.executable, "-m", __name__, module, *keys],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        encoding="utf-8",
        env=os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, sys.path)), "PYTHONIOENCODING": "utf-8"},
        start_new_session=True,
    )
    atexit.register(process.kill)
    with process:
        assert process.stdout is not None
        assert process.stderr is not None
        yield from map(json.loads, process.stdout)
        complaint = process.stderr.read()
    atexit.unregister(process.kill)
    if process.returncode:
        raise RuntimeError(complaint.strip().rpartition("\n")[2])


def main(module: str, *keys: str) -> None:
    """Print a line of JSON for each key: the key and its texts, which are kept for the next time."""
    folder = kept_in(module)
    for key in keys:
        file = folder / f"{key}.json"
        try:
            text = file.read_text(encoding="utf-8")
            json.loads(text)
        except (OSError, ValueError):
            text = json.dumps(import_module(module).texts_of(key))
            with suppress(OSError):
                _write(file, text)
        print(f"[{json.dumps(key)}, {text}]", flush=True)


def kept_in(module: str) -> Path:
    """The folder of the texts that this very package prints: where a line of it differs, the folder does."""
    import pooch

    package = Path(__file__).parents[1]
    digest = hashlib.sha256(metadata.version("sympy").encode())
    for path in sorted(package.rglob("*.py")):
        digest.update(path.read_bytes())
    return Path(pooch.os_cache("percept_obs")) / "labs" / f"{module} {digest.hexdigest()[:16]}"


def _write(file: Path, text: str) -> None:
    """Write a file at once, since another lab may read it meanwhile."""
    file.parent.mkdir(parents=True, exist_ok=True)
    new = file.with_suffix(f".{os.getpid()}")
    new.write_text(text, encoding="utf-8")
    new.replace(file)


if __name__ == "__main__":
    if hasattr(os, "nice"):
        os.nice(10)
    main(*sys.argv[1:])
