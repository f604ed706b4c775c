"""An ensemble, part by part: on the threads of this machine or on a cluster, kept in a store while it goes on."""

from __future__ import annotations

import os
from collections.abc import Generator, Sequence
from concurrent.futures import Executor, Future, ThreadPoolExecutor, as_completed
from contextlib import closing
from typing import TYPE_CHECKING, Any

import numpy as np

from percept_obs.compile import Array
from percept_obs.studies.part import NOT_RUN, Plan
from percept_obs.studies.varying import Grid
from percept_obs.validation import bar, warn, workers

if TYPE_CHECKING:
    import xarray as xr


class Unfinished(UserWarning):
    """An ensemble was interrupted; the runs that are missing have the status "not_run"."""


class Store:
    """A Zarr store in which an ensemble is kept as far as it is done.

    Parameters
    ----------
    path : path
    said : mapping
        Settings of the ensemble.
    kept : array of shape (number of runs, number of statistics)
        Gets what a store that was left behind holds.
    chunk : int
        Runs that are written together.

    Raises
    ------
    ValueError
        If the store holds something else.
    """

    def __init__(self, path: str | os.PathLike[str], said: dict[str, Any], kept: Array, chunk: int) -> None:
        import zarr

        self.path = path
        group: Any = zarr.open_group(os.fspath(path), mode="a")
        known = group.attrs.get("fingerprint")
        if known not in (None, said["fingerprint"]) or (known is None and len(list(group))):
            raise ValueError(
                f"the store {os.fspath(path)} holds something else than this ensemble; name a new one, or call with "
                "the settings that it was begun with"
            )
        if known is None:
            group.create_array("progress/runs", shape=kept.shape, chunks=(chunk, kept.shape[1]), dtype=float)
            group.attrs["fingerprint"] = said["fingerprint"]
        self.runs: Any = group["progress/runs"]
        kept[:] = self.runs[:]

    def keep(self, part: slice, found: Array) -> None:
        """Write what is known of some runs that follow each other."""
        self.runs[part] = found

    def finish(self, found: xr.Dataset) -> None:
        """Write the whole."""
        found.to_zarr(os.fspath(self.path), mode="a", consolidated=False)


def fill(plan: Plan, grid: Grid, kept: Array, chunk: int, client: Any = None, store: Store | None = None) -> None:
    """Compute the runs that are not kept yet.

    Parameters
    ----------
    plan : Plan
    grid : Grid
    kept : array of shape (number of runs, number of statistics)
    chunk : int
        Runs of a part.
    client : distributed.Client, optional
        Whose workers compute; what a worker that dies had begun, Dask gives to another one.
    store : Store, optional

    Warns
    -----
    Unfinished
        If it was interrupted.
    """
    left = kept[:, 0] == NOT_RUN
    parts = [slice(begin, min(begin + chunk, len(kept))) for begin in range(0, len(kept), chunk)]
    todo = [part for part in parts if left[part].any()]
    if client is None:
        plan.prepare(grid.columns)
    work = plan, grid
    computed = _beside(work, todo, client) if client or workers() > 1 else _one_by_one(work, todo)
    with closing(computed), bar(None, "runs", len(kept), initial=int((~left).sum()), unit="run") as progress:
        try:
            for part, found in computed:
                kept[part] = found
                if store:
                    store.keep(part, found)
                progress.update(len(found))
        except KeyboardInterrupt:
            warn(Unfinished(f"interrupted: {int((kept[:, 0] == NOT_RUN).sum())} of {len(kept)} runs are missing"))


Work = tuple[Plan, Grid]
"""What runs have in common, and what each of them takes."""

Computed = Generator[tuple[slice, Array]]
"""A part, and what its runs gave."""


def _one_by_one(work: Work, todo: Sequence[slice]) -> Computed:
    for part in todo:
        yield part, _part(work, part)


def _beside(work: Work, todo: Sequence[slice], client: Any) -> Computed:
    """Parts as they are done on the threads of this machine or on a cluster; what is not wanted any more is left."""
    executor: Executor = client.get_executor() if client else ThreadPoolExecutor(workers())
    # a task's result goes to each worker once, and is found again when a worker dies
    there = client.submit(_itself, work, pure=False) if client else work
    begun: dict[Future[Array], slice] = {}
    try:
        begun |= {executor.submit(_part, there, part): part for part in todo}
        for future in as_completed(begun):
            yield begun.pop(future), future.result()
    finally:
        for future in begun:
            future.cancel()
        executor.shutdown()


def _itself(work: Work) -> Work:
    return work


def _part(work: Work, part: slice) -> Array:
    """Some runs, whose values are laid out where they are computed."""
    plan, grid = work
    return plan.compute(grid.part(np.arange(part.start, part.stop)))
