"""First look: one point, one observer, and a slider for everything that matters."""

from __future__ import annotations

import html
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import ipywidgets as widgets
import matplotlib.figure
import numpy as np

from percept_obs import scenarios
from percept_obs.figures import Figure, image_plane, signals
from percept_obs.motion import Signal, affine
from percept_obs.observers import Observer, ibo
from percept_obs.perspective import PerspectiveSystem
from percept_obs.recording import Camera, Uniform, record
from percept_obs.surfaces import BehindCamera, pinhole
from percept_obs.tracking import Run, track

SCENARIOS = {"(35)": scenarios.ma2005_eq35, "(36)": scenarios.ma2005_eq36}
DURATION = 40.0  # seconds: past the nearest approach to the focus of expansion in (35)
BOUND = 50.0  # the printed 10 is reached by the true image of some motions that b can make
SEED = 1
LABELS, WIDE, BESIDE = {"description_width": "5em"}, {"width": "26em"}, {"margin": "2px 2px 2px 6em"}

ERROR_CLASS = "percept-obs-error"
"""DOM class of the lab's words while they tell an error that should not have happened."""


@dataclass(frozen=True)
class Settings:
    """What the lab lets one move.

    Parameters
    ----------
    scenario : str
        One of `SCENARIOS`: matrix A and start of the point.
    y2 : bool
        Whether y2 is measured beside y1.
    gain : float
        G of the identifier-based observer.
    noise : float
        Bound of the uniform noise on every sample.
    b1, b2, b3 : float
        Translation in m/s.
    """

    scenario: str = "(35)"
    y2: bool = True
    gain: float = 10.0
    noise: float = 0.01
    b1: float = 0.5
    b2: float = 0.25
    b3: float = 0.3


def follow(settings: Settings) -> Run:
    """Record the point and let the observer follow it.

    Raises
    ------
    BehindCamera
        If the point does not stay in front of the camera.
    """
    scenario = SCENARIOS[settings.scenario]()
    *matrix, _, _, _ = scenario.motion.values.values()
    motion = replace(scenario.motion, signal=Signal(np.array([*matrix, settings.b1, settings.b2, settings.b3])))
    camera = Camera(noise=Uniform(settings.noise))
    recording = record(replace(scenario, motion=motion), DURATION, camera, SEED)
    return track(recording, _observer(settings.y2).with_gains(gain=settings.gain))


def draw(run: Run) -> Figure:
    """Signals over time and, beside them, the image: one picture with one text."""
    figure = matplotlib.figure.Figure(figsize=(9.2, 5.2))
    # Places by hand: a layout fitted to each picture would jump while a slider moves, and takes half of the time.
    over_time = {"left": 0.08, "right": 0.6, "top": 0.94, "bottom": 0.1, "hspace": 0.4}
    in_the_image = {"left": 0.68, "right": 0.99, "top": 0.82, "bottom": 0.1}
    rows = figure.subplots(4, sharex=True, height_ratios=(1, 1, 1, 1.5), gridspec_kw=over_time)
    plane = figure.subplots(gridspec_kw=in_the_image)
    parts = [signals(run, rows), image_plane(run, ax=plane)]
    plane.legend(loc="lower left", bbox_to_anchor=(-0.05, 1), ncols=2, frameon=False)  # it is a narrow picture
    figure.align_ylabels(rows)
    return Figure(figure, tuple(ax for part in parts for ax in part.axes), " ".join(part.text for part in parts))


def first_look(settings: Settings | None = None) -> widgets.VBox:
    """A lab to move: one point, the identifier-based observer, what it sees and what it makes of it.

    The picture follows while a slider is being dragged.  The page sends the next value of a slider only when the
    kernel has drawn the last one, and skips those between, so that a slow kernel does not fall behind.

    Parameters
    ----------
    settings : Settings, optional
        Where the lab starts, and where its Reset button leads back to.

    Returns
    -------
    ipywidgets.VBox
    """
    start = settings or Settings()
    controls = _controls(start)
    reset = widgets.Button(description="Reset", tooltip="Put every control back to where it started", layout=BESIDE)
    words, picture = widgets.HTML(), widgets.HTML()

    def look(_change: object = None) -> None:
        try:
            run = follow(_settings(controls))
            picture.value = draw(run)._repr_html_()
        except BehindCamera as error:
            _say(words, f"<b>No picture:</b> {html.escape(str(error))}. Move b back, or press Reset.")
            picture.layout.visibility = "hidden"
        except Exception as error:
            _say(words, f"<b>This should not have happened.</b> {html.escape(repr(error))}", error=True)
            picture.layout.visibility = "hidden"
            raise
        else:
            _say(words, f"<b>The observer</b> {html.escape(run.verdict())}.")
            picture.layout.visibility = "visible"

    def go_back(_button: widgets.Button) -> None:
        for name, control in controls.items():
            control.unobserve(look, "value")
            control.value = getattr(start, name)
            control.observe(look, "value")
        look()

    for control in controls.values():
        control.observe(look, "value")
    reset.on_click(go_back)
    look()
    return widgets.VBox([_panel(controls, reset), words, picture])


@lru_cache
def _observer(y2: bool) -> Observer:
    """Derived once for each choice of outputs; gains and motion are only numbers."""
    names = ("y1", "y2") if y2 else ("y1",)
    return ibo(PerspectiveSystem(affine(), pinhole()).measure(*names), bound=BOUND)


def _controls(start: Settings) -> dict[str, widgets.ValueWidget]:
    return {
        "scenario": widgets.Dropdown(
            options=[("(35): it keeps turning", "(35)"), ("(36): it runs away", "(36)")],
            value=start.scenario,
            description="Motion",
            tooltip="Which of two motions moves the point",
            style=LABELS,
            layout=WIDE,
        ),
        "y2": widgets.Checkbox(
            value=start.y2,
            description="y2 is measured",
            tooltip="Whether the observer is given the second image coordinate",
            style=LABELS,
            layout=WIDE,
        ),
        "gain": _slider(start.gain, 1, 30, 0.5, "Gain G", "How strongly the observer corrects itself"),
        "noise": _slider(start.noise, 0, 0.05, 0.001, "Noise", "Largest error of each sample of y1 and y2", ".3f"),
        "b1": _slider(start.b1, 0, 1, 0.05, "b1 (m/s)", "Translation along X, across the image"),
        "b2": _slider(start.b2, -0.25, 0.75, 0.05, "b2 (m/s)", "Translation along Y, across the image"),
        "b3": _slider(start.b3, -0.2, 0.8, 0.05, "b3 (m/s)", "Translation along Z, away from the camera"),
    }


def _slider(
    value: float, low: float, high: float, step: float, description: str, tooltip: str, digits: str = ".2f"
) -> widgets.FloatSlider:
    return widgets.FloatSlider(
        value=value,
        min=low,
        max=high,
        step=step,
        description=description,
        tooltip=tooltip,
        readout_format=digits,
        style=LABELS,
        layout=WIDE,
    )


def _panel(controls: Mapping[str, widgets.Widget], reset: widgets.Button) -> widgets.HBox:
    """The observer and its camera on the left, the translation on the right."""
    left = widgets.VBox([controls[name] for name in ("scenario", "y2", "gain", "noise")])
    right = widgets.VBox([*(controls[name] for name in ("b1", "b2", "b3")), reset])
    return widgets.HBox([left, right], layout={"flex_flow": "row wrap"})


def _say(words: widgets.HTML, message: str, error: bool = False) -> None:
    if error:
        words.add_class(ERROR_CLASS)
    else:
        words.remove_class(ERROR_CLASS)
    colour = "color: var(--jp-error-color1, #b00020)" if error else ""
    words.value = (
        f'<p role="status" style="margin: 0.5em 0 0; min-height: 3.9em; line-height: 1.3; {colour}">{message}</p>'
    )


def _settings(controls: Mapping[str, widgets.ValueWidget]) -> Settings:
    return Settings(**{name: _rounded(control.value) for name, control in controls.items()})


def _rounded(value: Any) -> Any:
    """A slider's value without what adding up its steps leaves behind."""
    return round(value, 6) if isinstance(value, float) else value
