"""Base class of the labs: bundle and texts of the page, state in traitlets, errors that show, one lab a cell.

To add a lab: a folder with a subclass of `Lab`, a `Schema` of its settings, and the texts that ``printing.py`` prints
for its page.  Beside it a folder in ``front/src/labs`` with a subclass of ``Lab``, named in ``front/src/main.js``.
"""

from __future__ import annotations

import warnings
import weakref
from collections.abc import Callable, Mapping
from dataclasses import astuple
from inspect import cleandoc
from os import PathLike
from types import MappingProxyType
from typing import Any

import anywidget
import numpy as np
import traitlets
from IPython.display import display
from IPython.utils.capture import capture_output

from percept_obs.compile import Array
from percept_obs.labs.shared.printed import FRONT, file_of
from percept_obs.labs.shared.saved import ended, page_of
from percept_obs.labs.shared.schema import Schema, Settings
from percept_obs.labs.shared.typed_motion import Blocks, read_motion
from percept_obs.labs.shared.view import read_view
from percept_obs.recording import Camera, Gaussian, Recording, Scenario, Uniform, record
from percept_obs.system.surfaces import BehindCamera
from percept_obs.system.view import DISTANCE
from percept_obs.tracking.verdict import REMEDY, for_the_page
from percept_obs.validation import checked, to_write, write_whole

BUNDLE = FRONT / "lab.js"
"""The page's side of all labs, built from ``front/src`` by ``npm run build``."""

REFUSES = """

Raises
------
ValueError
    If a setting is unknown or makes no sense."""
"""The end of every lab's docstring."""

TYPED = ("motion", "P", "P0")
"""The settings that are expressions of time."""

LEAVES = "the point leaves the half-space in front of the camera at once"
"""Reason why a point that is seen in one sample only is refused, here and in the page."""

OF_ONE_POINT = {**for_the_page(), "judged": DISTANCE, "remedy": REMEDY, "leaves": LEAVES}
"""Sentences and numbers of verdicts for the pages of one point."""

NOISES: dict[str, Any] = {"uniform": Uniform, "gaussian": Gaussian}


def record_while_seen(scenario: Scenario, camera: Camera, seed: int) -> Recording:
    """Recording until the point leaves the half-space in front of the camera; BehindCamera if it leaves at once."""
    try:
        return record(scenario, camera=camera, seed=seed)
    except BehindCamera:  # not asked for beforehand, for that takes as long as recording
        times = camera.times(scenario.duration)
    count = int(np.argmin(scenario.in_front(times)))
    if count < 2:
        raise BehindCamera(f"{LEAVES}; move it or turn the motion")
    return record(scenario, times[count - 1], camera, seed)


def refuse_observers(settings: Settings, refused: Mapping[str, str]) -> None:
    """Raise a ValueError if an observer of the settings is among those that are refused, with the reason."""
    for name in settings["observers"]:
        if name in refused:
            raise ValueError(f"{name} cannot be used here: {refused[name]}; choose another observer")


class BadSettings(traitlets.TraitError, ValueError):
    """Settings that are refused; a TraitError, so that traitlets takes back what came with them."""


class Fixed(dict[str, Any]):
    """Settings that are replaced as a whole, for of a change within them nobody would hear."""

    def _refuse(self, *_: Any, **__: Any) -> Any:
        raise TypeError('settings change as a whole: lab.settings = {**lab.settings, "duration": 5.0}')

    __setitem__ = __delitem__ = __ior__ = update = pop = popitem = clear = setdefault = _refuse

    def __reduce__(self) -> Any:  # a copy is a plain one
        return dict, (dict(self),)


class _Checked(traitlets.TraitType[Settings, Settings]):
    """Settings, or a view, that the lab checks, also those that equal the present ones, as True equals 1."""

    def validate(self, lab: Any, value: Any) -> Settings:
        try:
            if self.name == "view":
                return read_view(lab.looks, value)
            checked = dict(lab.check(value))
        except ValueError as error:
            raise BadSettings(str(error)) from None
        lab.write_down(checked)
        return Fixed(checked)


class Lab(anywidget.AnyWidget):
    """A widget whose page computes by itself, from texts that are printed for it and a model from Python.

    The page sends `settings` and `summary` together when the hand rests; Python answers with `analysis`, which carries
    the summary's serial.  Nothing is sent as a message of its own, so that a busy kernel skips to the latest state.

    A lab of its own has a `schema`, says in `looks` what can be looked at, and more in `refuse` and `analyse`.  It is
    made with its `kind`, the user's settings and what is looked at, complete settings to open with, standard ones,
    printed texts where they are not those of the package, and other data.
    """

    _esm = BUNDLE.read_text(encoding="utf-8")  # given a path, anywidget would keep every lab for ever
    schema: Schema
    title = "A lab"
    blocks: Blocks = MappingProxyType({})
    """Vectors and matrices that may vary over time, by their letters."""
    idle: Mapping[str, Callable[[Settings], str]] = MappingProxyType({})
    """Why settings do nothing with others, or empty; those are refused where they are written `by_hand`."""
    looks: Schema = Schema()
    """Schema of the view, which no run depends on: the drawer's open group, charts, the part of the time."""
    from_the_page: tuple[str, ...] = ("view", "settings", "summary")
    """Traits that the page may set."""
    view: Any = _Checked({}, help="What of it is looked at.").tag(sync=True)
    kind = traitlets.Unicode(help="Which of the bundle's labs the page is to show.").tag(sync=True)
    texts = traitlets.Bytes(help="Printed texts of the page, compressed.").tag(sync=True)
    model = traitlets.Dict(help="Data of the page besides its texts.").tag(sync=True)
    settings: Any = _Checked({}, help="Everything that defines what is shown.").tag(sync=True)
    summary = traitlets.Dict(help="Results of the page: verdicts, numbers at some times.").tag(sync=True)
    analysis = traitlets.Dict(help="Analysis by Python when the hand rests.").tag(sync=True)
    written = traitlets.Dict(help="Motions over time, each as a function for the page, or why it cannot be read.").tag(
        sync=True
    )
    error = traitlets.Unicode(help="Error in Python, which the page shows.").tag(sync=True)

    def __init__(
        self, kind: str, settings: Settings, opening: Settings, standard: Settings, texts: bytes = b"", **model: Any
    ) -> None:
        self._shown_in: frozenset[str] = frozenset()
        view = read_view(self.looks, {name: value for name, value in settings.items() if name in self.looks})
        settings = {name: value for name, value in settings.items() if name not in self.looks}
        self._opening = opening
        self._opening = self.check(settings)
        running = self._opening.get("observers", [])
        if view.get("chosen") and view["chosen"] not in running:
            raise ValueError(f"chosen is {view['chosen']!r}; choose one of the observers that run: {running}")
        sight, lasts = view.get("sight"), self._opening.get("duration")
        if sight and self.by_hand(settings) and not (sight[0] < lasts and sight[1] > 0):
            raise ValueError(f"sight is {sight}; the run is from 0 to {lasts:g} s")
        model |= {"opening": self._opening, "standard": self.check(standard), "schema": self.schema.for_the_page()}
        model |= {"view": {"schema": self.looks.for_the_page(), "standard": self.looks.opening}}
        super().__init__(
            kind=kind, texts=texts or file_of(kind).read_bytes(), model=model, settings=self._opening, view=view
        )
        _close_those_of_an_earlier_run(self)

    def __setattr__(self, name: str, value: Any) -> None:
        if name in type(self).schema and not self.has_trait(name):
            raise AttributeError(f"{name} is a setting: write lab.settings = lab.settings | {{{name!r}: ...}}")
        super().__setattr__(name, value)

    def __init_subclass__(cls) -> None:
        """Let the docstring list the settings."""
        super().__init_subclass__()
        if "{settings}" in (cls.__doc__ or ""):  # anywidget makes subclasses without one
            cls.__doc__ = cleandoc(str(cls.__doc__)).replace(
                "{settings}", f"{cls.schema.listed()}\n{cls.looks.listed()}{REFUSES}"
            )

    def by_hand(self, settings: Settings) -> bool:
        """Return True for settings that somebody wrote: what is read back, from a lab or an address, has them all."""
        return not self.schema.keys() <= settings.keys()

    def check(self, settings: Settings) -> Settings:
        """Complete settings, or a ValueError that says what is wrong."""
        for kind, make in NOISES.items():
            if isinstance(settings, Mapping) and type(settings.get("noise")) is make:
                settings = {**settings, "noise": {"kind": kind, "size": astuple(settings["noise"])[0]}}
        whole = self.schema.read(settings, self._opening)
        self.refuse(whole)
        for name, reason in self.idle.items():
            if self.by_hand(settings) and name in settings and whole[name] and (why := reason(whole)):
                raise ValueError(f"{name} is {settings[name]!r}, but {why}; change one of the two, or leave {name} out")
        if whole.get("kept") is not None:
            whole["kept"] = self.check({**whole["kept"], "kept": None})
        return whole

    def refuse(self, settings: Settings) -> None:
        """Raise a ValueError for settings that do not go together."""

    def refuse_poles(self, settings: Settings, numbers: Callable[[Array], Array]) -> None:
        """Raise a ValueError for a motion over time that cannot be read, or is not finite; see `Typed.refuse_poles`."""
        try:
            typed = read_motion(settings["motion"], self.blocks)
        except ValueError as error:
            raise ValueError(f"motion: it must be expressions of t, but {error}") from None
        typed.refuse_poles(settings["duration"], numbers)

    def typed_for_the_page(self, text: str) -> Settings:
        """Texts of a motion over time; a ValueError if it cannot be read."""
        if not self.blocks:
            raise ValueError("this lab takes no motion over time")
        return read_motion(text, self.blocks).for_the_page()

    def write_down(self, settings: Settings) -> None:
        """Print the motions over time of settings for the page."""
        kept = settings.get("kept") or {}
        for text in (each.get(name, "") for each in (settings, kept) for name in TYPED):
            if not text.strip() or text in self.written:
                continue
            try:
                answer = self.typed_for_the_page(text)
            except ValueError as error:  # of a P that no kind of P uses now
                answer = {"refusal": str(error)}
            self.written = {**self.written, text: answer}

    def run(self) -> Any:
        """Runs of the present settings in Python, by the observers' names; of many points the run of all of them."""
        return self.runs(self.settings)

    def runs(self, settings: Settings) -> Any:
        """Runs of settings, as `run` gives them."""
        raise NotImplementedError

    def analyse(self) -> Settings:
        """Analysis of the present settings, which the page shows when the hand rests."""
        return {}

    @checked
    def save(self, file: str | PathLike[str]) -> None:
        """Write the lab into a page of its own, which opens without Python, without a server and without a network.

        The page opens with the present settings.  It holds the printed equations of every choice, so that all controls
        work; the analysis by Python is left out.

        Parameters
        ----------
        file : path
            Where the page is to stand, such as ``"lab.html"``; a file there is replaced.

        Raises
        ------
        ValueError
            If the file is a folder, its folder does not exist, or its ending is another one.

        Examples
        --------
        >>> import tempfile
        >>> from pathlib import Path
        >>> from percept_obs.labs import observer_lab
        >>> page = Path(tempfile.mkdtemp()) / "lab.html"
        >>> observer_lab(outputs=["y1"]).save(page)
        >>> page.read_text("utf-8")[:15]
        '<!doctype html>'
        """
        target = to_write(file, ".html", ".htm")
        write_whole(target, page_of(self.get_state(), self.title).encode())

    def set_state(self, sync_data: dict[str, Any]) -> None:
        """Take the page's state; an error is shown in the lab and raised for the log."""
        try:
            with capture_output():  # progress bars have no cell to stand in, and would fill the log
                super().set_state({name: sync_data[name] for name in self.from_the_page if name in sync_data})
        except Exception as error:
            self.error = f"{type(error).__name__}: {error}"
            raise
        if self.error and "summary" in sync_data:
            self.error = ""

    def _repr_mimebundle_(self, **options: Any) -> Any:
        """Output of a cell; the lab remembers in which cells it is shown."""
        cell, _ = _running_cell()
        self._shown_in |= {cell}
        return super()._repr_mimebundle_(**options)

    def _ipython_display_(self) -> None:
        """Show the lab, and a hint for when its kernel has ended."""
        data, metadata = self._repr_mimebundle_()
        display(data | {"text/plain": self.title}, metadata=metadata, raw=True)
        display({"text/html": ended(self.title), "text/plain": ""}, raw=True)

    @traitlets.observe("summary")
    def _deepen(self, change: Mapping[str, Any]) -> None:
        if change["new"]:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", UserWarning)  # a lab says in its own place what is to be said
                self.analysis = {**self.analyse(), "serial": change["new"].get("serial")}


_open: dict[str, tuple[str, list[weakref.ref[Lab]]]] = {}
"""By the name of a cell: the name of its last run, and the labs that are shown by it."""


def _close_those_of_an_earlier_run(lab: Lab) -> None:
    """Close the labs that the same cell made in an earlier run, unless they stand in another cell as well."""
    cell, run = _running_cell()
    if not cell:
        return
    last, labs = _open.get(cell, (run, []))
    if last != run:
        there = [lab for lab in (reference() for reference in labs) if lab is not None]
        elsewhere = [lab for lab in there if lab._shown_in - {cell}]
        for earlier in there:
            if earlier not in elsewhere:
                earlier.layout.close()
                earlier.close()
        labs = [weakref.ref(lab) for lab in elsewhere]
    _open[cell] = (run, [*labs, weakref.ref(lab)])


def _running_cell() -> tuple[str, str]:
    """Names of the cell that is running and of this run of it; empty outside a notebook."""
    from IPython import get_ipython

    shell = get_ipython()
    parent = shell.get_parent() if hasattr(shell, "get_parent") else {}
    return parent.get("metadata", {}).get("cellId", ""), parent.get("header", {}).get("msg_id", "")
