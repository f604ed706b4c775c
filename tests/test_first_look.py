"""The first look draws at every end of every control, says what it cannot draw, and hides no error."""

import re

import ipywidgets as widgets
import pytest
from jupyter_harness import ERROR_CLASS

from percept_obs import BehindCamera
from percept_obs.labs import first_look as module
from percept_obs.labs.first_look import Settings, draw, first_look, follow


class Lab:
    """A lab's parts by what they are called."""

    def __init__(self):
        self.box = first_look()
        self.panel, self.words, self.picture = self.box.children
        inside = [part for column in self.panel.children for part in column.children]
        self.controls = {part.description: part for part in inside}

    @property
    def said(self):
        return re.sub(r"<[^>]*>", "", self.words.value)

    @property
    def shows(self):
        return self.picture.value if self.picture.layout.visibility == "visible" else None

    @property
    def settled(self):
        return float(re.search(r"after ([\d.]+) s", self.said).group(1))


@pytest.fixture
def lab():
    return Lab()


def test_it_opens_with_a_picture_its_text_and_the_verdict(lab):
    assert isinstance(lab.box, widgets.VBox)
    assert re.search(r'<img alt="[^"]{80,}"', lab.shows)
    assert "converged: the error of y3 stays within 0.05 after 1.44 s" in lab.said


def test_every_control_says_in_words_what_it_does(lab):
    for control in lab.controls.values():
        assert control.description
        assert control.tooltip


@pytest.mark.slow
def test_every_control_draws_at_both_ends_or_says_why_not(lab):
    for name, control in lab.controls.items():
        if isinstance(control, widgets.FloatSlider):
            for end in (control.min, control.max):
                control.value = end
                assert lab.shows or "No picture" in lab.said, name
            lab.controls["Reset"].click()


def test_without_y2_it_takes_longer_and_reset_leads_back(lab):
    before = lab.shows
    lab.controls["y2 is measured"].value = False
    assert lab.settled == 13.3
    assert lab.shows != before

    lab.controls["Gain G"].value = 5
    lab.controls["Reset"].click()
    assert lab.settled == 1.44
    assert lab.shows == before


@pytest.mark.parametrize(("scenario", "b1"), [("(35)", 0.1), ("(36)", 0.8)])
def test_a_point_behind_the_camera_is_told_in_words(lab, scenario, b1):
    lab.controls["Motion"].value = scenario
    lab.controls["b1 (m/s)"].value = b1
    assert lab.shows is None
    assert "No picture: in the scenario" in lab.said
    assert "Traceback" not in lab.said
    assert ERROR_CLASS not in lab.words._dom_classes

    lab.controls["b1 (m/s)"].value = 0.5
    assert lab.shows
    assert "No picture" not in lab.said


def test_any_other_error_is_shown_and_raised(lab, monkeypatch):
    def broken(settings):
        raise ArithmeticError("a slip <of the pen>")

    with monkeypatch.context() as patch:
        patch.setattr(module, "follow", broken)
        with pytest.raises(ArithmeticError):
            lab.controls["Gain G"].value = 12
    assert "a slip &lt;of the pen&gt;" in lab.said
    assert ERROR_CLASS in lab.words._dom_classes
    assert lab.shows is None

    lab.controls["Gain G"].value = 10
    assert ERROR_CLASS not in lab.words._dom_classes
    assert lab.shows


def test_moving_compiles_nothing():
    from percept_obs import compile

    follow(Settings())
    compiled = compile._kernel.cache_info().misses
    follow(Settings("(36)", gain=12.0, noise=0.02, b1=0.45, b2=0.3, b3=0.35))
    assert compile._kernel.cache_info().misses == compiled


def test_a_focus_of_expansion_at_infinity_is_drawn():
    assert draw(follow(Settings(b3=0.0))).text


@pytest.mark.parametrize(
    ("settings", "seconds"),
    [
        # The answers in 00_start.
        (Settings(gain=2.0), 4.4),
        (Settings(gain=30.0, noise=0.0), 0.65),
        (Settings(y2=False), 13.3),
        (Settings("(36)"), 2.19),
        (Settings("(36)", b1=0.1), 7.28),
    ],
)
def test_what_the_first_notebook_answers_is_so(settings, seconds):
    assert follow(settings).settling_time() == pytest.approx(seconds, abs=0.05)


def test_the_motion_of_question_4_ends_behind_the_camera():
    with pytest.raises(BehindCamera, match=r"at 8\.5 s"):
        follow(Settings(b1=0.1))
