"""What every lab shares: the page's bundle, state in traitlets, errors that show, one lab a cell.

To add a lab: a subclass of `Lab` in a file of its own, with the settings that define what is shown, `check`, `analyse`,
and a model of what the page needs to open; larger parts follow from a `Printing` of the lab's own.  Beside it a folder
in ``front/src`` with a subclass of ``Live``, named in ``front/src/main.js``.
"""

from __future__ import annotations

import weakref
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import anywidget
import traitlets

from percept_obs.labs.shared.printing import Printing

BUNDLE = Path(__file__).parents[1] / "front" / "lab.js"
"""The page's side of all labs, built from ``front/src`` by ``npm run build``."""

Settings = dict[str, Any]


class BadSettings(traitlets.TraitError, ValueError):
    """Settings that make no sense; as a TraitError, so that traitlets takes back what came with them."""


class Lab(anywidget.AnyWidget):
    """A widget whose page computes by itself from a model that it is handed once.

    What the model leaves out follows in parts, each a state under its own name, once it is printed.  The page sends
    `settings` and `summary` together when the hand rests; Python answers with `analysis`.  Nothing is sent as a message
    of its own, so that a busy kernel skips to the latest state.

    Parameters
    ----------
    kind : str
        Which of the bundle's labs the page is to show.
    model : dict
        What the page needs to open, handed over once.
    settings : dict
        Everything that defines what is shown.
    printing : Printing, optional
        Where the parts come from.
    parts : sequence of str
        Their names, in the order in which they are likely to be needed.
    """

    _esm = BUNDLE
    kind = traitlets.Unicode().tag(sync=True)
    model = traitlets.Dict().tag(sync=True)
    settings = traitlets.Dict().tag(sync=True)
    summary = traitlets.Dict(help="What the page found: verdicts, numbers at some times.").tag(sync=True)
    analysis = traitlets.Dict(help="What Python adds to it when the hand rests.").tag(sync=True)
    error = traitlets.Unicode(help="What went wrong in Python; the page shows it.").tag(sync=True)
    parts = traitlets.List(traitlets.Unicode(), help="Names of the parts that follow.").tag(sync=True)
    missed = traitlets.Bool(help="Whether the page has found that parts are missing.").tag(sync=True)
    unprinted = traitlets.Unicode(help="Why parts will not come, if so.").tag(sync=True)

    def __init__(
        self,
        kind: str,
        model: Settings,
        settings: Settings,
        printing: Printing | None = None,
        parts: Sequence[str] = (),
    ) -> None:
        self.add_traits(**{name: traitlets.Dict().tag(sync=True) for name in parts})
        there = {name: printing.texts[name] for name in parts if name in printing.texts} if printing else {}
        super().__init__(kind=kind, model=model, settings=settings, parts=list(parts), **there)
        self._printing = printing
        _, run = _running_cell()
        _close_those_of_an_earlier_run(self)
        if run:
            self._ask_for_parts()

    def check(self, settings: Settings) -> Settings:
        """Complete settings, or a ValueError that says what is wrong; a lab overrides it."""
        return settings

    def analyse(self, summary: Settings) -> Settings:
        """Look deeper at the settings that the page has come to rest on; a lab overrides it."""
        return {}

    @traitlets.observe("missed")
    def _ask_for_parts(self, _: object = None) -> None:
        """Have the missing parts printed; a lab that is gone when they come gets none."""
        printing, self._printing = self._printing, None
        if printing is None:
            return
        reference = weakref.ref(self)

        def put(name: str, value: object) -> None:
            lab = reference()
            if lab is not None:
                setattr(lab, name, value)

        printing.ask(self.parts, put, lambda reason: put("unprinted", reason))

    def set_state(self, sync_data: dict[str, Any]) -> None:
        """Take the page's state; what goes wrong is shown in the lab and raised for the log."""
        try:
            super().set_state(sync_data)
        except Exception as error:
            self.error = f"{type(error).__name__}: {error}"
            raise
        if self.error and "summary" in sync_data:
            self.error = ""

    @traitlets.validate("settings")
    def _complete(self, proposal: Mapping[str, Any]) -> Settings:
        try:
            return self.check(proposal["value"])
        except ValueError as error:
            raise BadSettings(str(error)) from None

    @traitlets.observe("summary")
    def _deepen(self, change: Mapping[str, Any]) -> None:
        if change["new"]:
            self.analysis = {"of": change["new"].get("serial"), **self.analyse(change["new"])}


_open: dict[str, tuple[str, list[weakref.ref[Lab]]]] = {}


def _close_those_of_an_earlier_run(lab: Lab) -> None:
    """Close the labs that the same cell made when it ran before; several of one run stay."""
    cell, run = _running_cell()
    if not cell:
        return
    last, labs = _open.get(cell, (run, []))
    if last != run:
        for earlier in filter(None, (reference() for reference in labs)):
            earlier.close()
        labs = []
    _open[cell] = (run, [*labs, weakref.ref(lab)])


def _running_cell() -> tuple[str, str]:
    """Names of the cell that is running and of this run of it; empty outside a notebook."""
    from IPython import get_ipython

    shell = get_ipython()
    parent = shell.get_parent() if hasattr(shell, "get_parent") else {}
    return parent.get("metadata", {}).get("cellId", ""), parent.get("header", {}).get("msg_id", "")
