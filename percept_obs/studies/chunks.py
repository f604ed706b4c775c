"""Runs of an ensemble, chunk by chunk: on the threads of this machine or on a cluster, kept in a store on the way."""

from __future__ import annotations

import copy
import os
from collections.abc import Generator, Sequence
from concurrent.futures import Executor, Future, ThreadPoolExecutor, as_completed
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Any

from percept_obs.compile import Array
from percept_obs.compile.batch import compiled
from percept_obs.studies.plan import NOT_RUN, Plan
from percept_obs.validation import bar, warn, workers


class Unfinished(UserWarning):
    """An ensemble was interrupted; the runs that are missing have the status "not_run"."""


@contextmanager
def open_store(
    path: str | os.PathLike[str] | None, fingerprint: str, shape: tuple[int, int], chunk: int
) -> Generator[Any]:
    """Open the array of statistics in a Zarr store, shape (number of runs, number of statistics), None without a path.

    The store is this ensemble's alone until it is left; ValueError if it is another's, or something else.
    """
    if path is None:
        yield None
        return
    import sqlite3

    import zarr

    store = Path(path)
    taken = any(store.iterdir()) if store.is_dir() else store.exists()
    if not os.fspath(path) or (taken and not (store / "zarr.json").exists()):
        raise ValueError(f"the store {os.fspath(path)!r} is no Zarr store; name a new folder, such as ensemble.zarr")
    store.parent.mkdir(parents=True, exist_ok=True)
    # The system gives a lock of a database back when its process ends, however it ends.
    try:
        lock = sqlite3.connect(f"{store}.lock", timeout=0, check_same_thread=False)
        lock.execute("BEGIN EXCLUSIVE")
    except sqlite3.OperationalError as error:
        raise ValueError(
            f"the store {store} is not free ({error}): another ensemble writes to it now, or its folder cannot be "
            "written to; wait, or name a new one"
        ) from None
    try:
        group: Any = zarr.open_group(store, mode="a")
        stored = group.attrs.get("fingerprint")
        if stored not in (None, fingerprint) or (stored is None and len(list(group))):
            raise ValueError(
                f"the store {store} holds something else than this ensemble; name a new one, or call with the "
                "settings that it was begun with"
            )
        if stored is None:
            group.create_array("progress/runs", shape=shape, chunks=(min(chunk, shape[0]), shape[1]), dtype=float)
            group.attrs["fingerprint"] = fingerprint
        yield group["progress/runs"]
    finally:
        lock.close()
        Path(f"{store}.lock").unlink(missing_ok=True)


def run_missing(plan: Plan, results: Array, chunk: int, client: Any = None, stored: Any = None) -> None:
    """Compute the runs that have no results yet, in chunks, and keep them in a store; warn if interrupted.

    With a client Dask gives another worker what a worker that dies had begun.
    """
    missing = results[:, 0] == NOT_RUN
    chunks = [slice(begin, min(begin + chunk, len(results))) for begin in range(0, len(results), chunk)]
    todo = [each for each in chunks if missing[each].any()]
    if client is None:
        compiled(plan.loop, plan.language)  # here and now, where numba may set warning filters
    if client or workers() > 1:
        computed = _concurrent(plan, todo, client)
    else:
        computed = ((each, plan.compute(each)) for each in todo)
    with closing(computed), bar(None, "runs", len(results), initial=int((~missing).sum()), unit="run") as progress:
        try:
            for each, found in computed:
                results[each] = found
                if stored is not None:
                    stored[each] = found
                progress.update(len(found))
        except KeyboardInterrupt:
            missing = results[:, 0] == NOT_RUN
            warn(Unfinished(f"interrupted: {int(missing.sum())} of {len(results)} runs are missing"))


def _concurrent(plan: Plan, todo: Sequence[slice], client: Any) -> Generator[tuple[slice, Array]]:
    """Yield chunks as they are done, on the threads of this machine or on a cluster."""
    executor: Executor = client.get_executor() if client else ThreadPoolExecutor(workers())
    # a task's result, unlike scattered data, is made again when the worker that holds it dies
    there = client.submit(copy.copy, plan, pure=False) if client else plan
    begun: dict[Future[Array], slice] = {}
    try:
        begun |= {executor.submit(Plan.compute, there, each): each for each in todo}
        for future in as_completed(begun):
            yield begun.pop(future), future.result()
    finally:
        for future in begun:
            future.cancel()
        executor.shutdown()
