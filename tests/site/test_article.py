"""The article is right by the package's own kernels, and its page asks, runs and answers without a request."""

import re
import shutil
from functools import cache

import numpy as np
import pytest
from jinja2 import Environment
from lab_settings import FRONT

from percept_obs import PerspectiveSystem, cramer_rao, pinhole
from percept_obs.exercises.models import notebooks
from percept_obs.labs import observer_lab
from percept_obs.labs.shared.saved import STARTER, library_of
from percept_obs.site import TEXTS
from percept_obs.site.article import ARTICLE, WORDS, settings_of
from percept_obs.site.front import PLAYER, front

SCENES = {scene["name"]: scene for scene in ARTICLE["scene"]}
SIZES = {"desk": (1280, 800), "narrow": (1024, 800), "phone": (390, 844)}


def words_of(scene):
    """The words of a scene that are read without unfolding anything."""
    parts = [scene[name] for name in WORDS]
    whole = " ".join(part if isinstance(part, str) else " ".join(part) for part in parts)
    return re.sub("<[^>]*>", "", whole).split()


@pytest.mark.parametrize("name", SCENES)
def test_a_scene_has_at_most_seventy_words_and_three_answers(name):
    scene = SCENES[name]
    print(f"{name}: {len(words_of(scene))} words")
    assert len(words_of(scene)) <= 70
    assert len(scene["answers"]) == 3
    assert scene["right"] in range(3)


# What is said of runs.


@cache
def lab():
    return observer_lab()


def settings(name, **changes):
    return settings_of(lab(), {**SCENES[name]["settings"], **changes})


def run_of(name, **changes):
    lab().settings = settings(name, **changes)
    (run,) = lab().run().values()
    return run


def after(name):
    return run_of(name, **SCENES[name]["after"])


def distances(rows):
    return np.linalg.norm(np.column_stack([rows[:, :2], np.ones(len(rows))]), axis=1) / rows[:, 2]


def lengths(run):
    """Distances of the truth and of the estimate, in m."""
    return distances(run.truth), distances(run.estimate)


def holds_directions():
    near, far = run_of("directions"), after("directions")
    ratio = distances(far.truth) / distances(near.truth)
    return np.allclose(ratio, 2) and np.allclose(near.truth[:, :2], far.truth[:, :2]) and np.ptp(near.truth) > 0


def holds_near():
    def speed(share):
        run = run_of("near", X0=(share * np.array(SCENES["near"]["settings"]["X0"])).tolist())
        return np.linalg.norm(np.diff(run.truth[:2, :2], axis=0))

    return speed(0.5) / speed(1) == pytest.approx(2, rel=0.01)


def holds_observer():
    true, found = lengths(after("observer"))
    return found[0] / true[0] == pytest.approx(2, rel=0.02) and abs(found[-1] / true[-1] - 1) < 0.01


def holds_blind():
    run = after("blind")
    true, found = lengths(run)
    stands = np.ptp(run.truth[:, :2], axis=0).max() < 1e-9
    beside = np.divide(*lengths(run_of("blind")))[-1]
    return stands and np.ptp(true - found) < 1e-6 and true[-1] < true[0] and abs(beside - 1) < 0.01


def holds_one():
    column, row = (np.divide(*lengths(run_of("one", outputs=[name])))[-1] for name in ("y1", "y2"))
    above = np.ptp(run_of("one").truth[:, 0]) < 1e-9
    return above and abs(row - 1) < 0.01 and column > 2


def holds_noise():
    def seen(run):
        true, found = lengths(run)
        error = abs(found / true - 1)
        return np.argmax(error < 0.1), np.sqrt(np.mean(error[-100:] ** 2))

    (first, calm), (sooner, shaking) = seen(run_of("noise")), seen(after("noise"))
    return sooner < first / 3 and shaking > 3 * calm


def holds_told():
    true, found = lengths(after("told"))
    truly = np.divide(*lengths(run_of("told")))[-1]
    return found[-1] / true[-1] == pytest.approx(1.5, abs=0.01) and abs(truly - 1) < 0.01


def limit(**changes):
    """The limit in parts of the distance and in m, with the relative errors of the run."""
    run = run_of("limit", **changes)
    bound = cramer_rao(run.recording, PerspectiveSystem(run.recording.motion, pinhole()))
    parts = np.sqrt(bound.covariance[:, 2, 2]) / run.truth[:, 2]
    true, found = lengths(run)
    return parts, parts * true, abs(found / true - 1)


def holds_limit():
    (turned, metres, error), (beside, beside_in_metres, _) = limit(turn=1), limit()
    last = [f"{100 * each[-1] / each[-101]:.0f} %" for each in (metres, beside_in_metres)]
    assert re.findall(r"\d+ %", SCENES["limit"]["meaning"]) == last
    begins_above = (error > turned)[turned < 1][:20].all()
    stops = turned[100:].max() < 1.5 * turned[100:].min()
    return stops and beside[-1] < beside[100] / 5 and turned[-1] > turned[-101] and begins_above


@pytest.mark.parametrize("name", SCENES)
def test_what_a_scene_says_is_so(name):
    assert globals()[f"holds_{name}"]()


# The page.


@pytest.fixture(scope="module")
def page_of(tmp_path_factory):
    """Address of the article's page, without the rest of the site."""
    folder = tmp_path_factory.mktemp("article")
    article, opened = front(notebooks())
    template = Environment(autoescape=False).from_string((TEXTS / "article.html").read_text("utf-8"))
    (folder / "index.html").write_text(template.render(article=article, language="en", metatags=""), "utf-8")
    (folder / "_static").mkdir()
    (folder / "_static" / "article.css").write_text((TEXTS / "article.css").read_text("utf-8"), "utf-8")
    (folder / "_static" / "first.js").write_text(library_of([opened.get_state()]), "utf-8")
    for script in (STARTER, PLAYER):
        shutil.copy(script, folder / "_static")
    return (folder / "index.html").as_uri()


@pytest.fixture
def read(browser, page_of):
    """Opens the page in a window of a size; no complaint of it, and no request, is left unseen."""
    pages, complaints = [], []

    def opened(size="desk", **options):
        width, height = SIZES[size]
        page = browser.new_page(offline=True, viewport={"width": width, "height": height}, **options)
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.on("console", lambda message: complaints.append(message.text) if message.type == "error" else None)
        page.on("request", lambda request: complaints.append(request.url) if "file:" not in request.url[:5] else None)
        page.goto(page_of)
        page.wait_for_selector(".alive", state="attached")
        pages.append(page)
        return page

    yield opened
    for page in pages:
        page.close()
    assert [each for each in complaints if not each.startswith(("blob:", "data:"))] == []


def rounded(value):
    """Settings without the last digits of their numbers."""
    if isinstance(value, dict):
        return {name: rounded(each) for name, each in value.items()}
    if isinstance(value, list | tuple):
        return [rounded(each) for each in value]
    return round(value, 9) if isinstance(value, int | float) else value


STAND = "(name) => document.getElementById(name).scrollIntoView({ block: 'start', behavior: 'instant' })"


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.browser
@pytest.mark.slow
def test_each_scene_sets_the_lab_and_answers_by_keys(read, size):
    page = read(size, reduced_motion="reduce")
    for name, scene in SCENES.items():
        page.evaluate(STAND, name)
        page.wait_for_function("(name) => document.body.dataset.scene === name", arg=name)
        assert page.locator(f"#{name} .told").is_hidden()
        page.locator(f"#{name} fieldset button").nth(scene["right"]).focus()
        page.keyboard.press("Enter")
        page.locator(f"#{name}.answered .told").wait_for()
        page.wait_for_function("() => tests.drawn()")
        assert page.inner_text(f"#{name} .right") == scene["answers"][scene["right"]]
        shown = page.evaluate("tests.first().settings")
        assert rounded({**shown, "kept": None}) == rounded(settings(name, **scene["after"]))
        assert bool(shown["kept"]) == ("kept" in scene)
        assert page.locator(".problem:not([hidden])").count() == 0


@pytest.mark.browser
@pytest.mark.slow
def test_an_answer_is_told_when_its_run_was_watched_or_is_left(read):
    page = read(reduced_motion="no-preference")
    page.evaluate(STAND, "observer")
    page.locator("#observer fieldset button").first.click()
    page.wait_for_function("() => tests.first().screen.clock.playing")
    assert page.locator("#observer .told").is_hidden()
    page.evaluate(STAND, "noise")
    page.locator("#observer.answered").wait_for(state="attached")
    page.locator("#noise-hand").focus()
    page.keyboard.press("ArrowRight")
    page.wait_for_function("() => tests.first().settings.gains.identifier_based.gain === 12")


@pytest.mark.browser
@pytest.mark.slow
def test_a_bar_leads_the_keys_to_the_lab_s_own_handle(read):
    page = read(reduced_motion="reduce")
    page.evaluate(STAND, "blind")
    page.locator("#blind .grab").press("Enter")
    before = page.evaluate("tests.first().settings.b")
    page.keyboard.press("ArrowRight")
    page.wait_for_function("(b) => tests.first().settings.b[0] !== b[0]", arg=before)


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("size", ["desk", "phone"])
@pytest.mark.browser
@pytest.mark.slow
def test_axe_finds_nothing(read, size, scheme):
    page = read(size, color_scheme=scheme, reduced_motion="reduce")
    page.evaluate("document.querySelectorAll('details').forEach((each) => (each.open = true))")
    page.evaluate((FRONT / "node_modules/axe-core/axe.min.js").read_text("utf-8"))
    found = page.evaluate("axe.run({ preload: false, resultTypes: ['violations'] })")["violations"]
    assert [(one["id"], [node["html"][:120] for node in one["nodes"]]) for one in found] == []


@pytest.mark.browser
@pytest.mark.slow
def test_on_paper_each_scene_has_its_picture_and_its_answer(read):
    page = read(reduced_motion="reduce", color_scheme="dark")
    page.wait_for_function(f"() => document.querySelectorAll('.still[src]').length === {len(SCENES)}")
    stills = page.eval_on_selector_all(".still", "(images) => images.map(({ src }) => src)")
    assert len({*stills}) == len(SCENES)
    assert min(map(len, stills)) > 20_000
    page.emulate_media(media="print", color_scheme="light")
    assert all(page.locator(f"#{name} .still").is_visible() for name in SCENES)
    assert all(page.locator(f"#{name} .told").is_visible() for name in SCENES)
    assert page.locator(".stage").is_hidden()
