"""A heavy picture never blocks the hand: labs compute in a worker, or in the page where a policy allows none."""

import json
import re

import pytest
from lab_alone import DRAWN, opened, stated_policy
from lab_browser import assert_equals_python, control, rested, state

from percept_obs.labs import derivation_desk, observer_lab, points_lab, structure_lab

pytestmark = [pytest.mark.browser, pytest.mark.slow]

HANDLES = [(observer_lab, "foe", 0.01), (structure_lab, "camera", 0.25), (points_lab, "mark 1", 0.01)]
"""A handle of each lab, and how far a key moves it."""

FOUR = {"observers": ["identifier_based", "sliding_mode", "extended_kalman", "de_luca"], "duration": 20.0}
MOVES, SECONDS = 1000, 600


def answered(told):
    return {"analysis": {"serial": told["summary"]["serial"]}}


def with_worker(show, lab, **options):
    """A page with a lab that computes in a worker."""
    page = show(lab, answers=answered, **options)
    rested(page)
    page.evaluate("tests.touch()")
    page.wait_for_function("() => tests.beside()")
    rested(page)
    return page


def memory_of(page):
    """A function that says how many MB the page and its worker use, once garbage is gone."""
    session = page.context.new_cdp_session(page)
    workers, heard = [], []

    def hear(message):
        if "id" in message:
            heard.append(message)

    session.on("Target.attachedToTarget", lambda event: workers.append(event["sessionId"]))
    session.on("Target.receivedMessageFromTarget", lambda event: hear(json.loads(event["message"])))
    session.send("Target.setAutoAttach", {"autoAttach": True, "waitForDebuggerOnStart": False, "flatten": False})
    (worker,) = workers

    def asked_of_worker(method):
        message = json.dumps({"id": 1, "method": method})
        session.send("Target.sendMessageToTarget", {"sessionId": worker, "message": message})
        while not heard:
            page.wait_for_timeout(10)
        return heard.pop()["result"]

    def used():
        usage = []
        for ask in (session.send, asked_of_worker):
            ask("HeapProfiler.collectGarbage")
            usage.append(ask("Runtime.getHeapUsage"))
        return sum(one["usedSize"] + one.get("backingStorageSize", 0) for one in usage) / 1e6

    return used


def test_under_the_stated_policy_a_worker_computes_what_python_computes(show):
    page = with_worker(show, observer_lab(observers=["identifier_based", "extended_kalman"], duration=10.0))
    page.evaluate("tests.countRuns()")
    page.evaluate("tests.unfold()")
    page.fill(control("duration number"), "8")
    page.check(control("observer de_luca"))
    page.check(control("chart error"))
    page.click(control("keep"))
    rested(page)
    shown = state(page)
    assert page.evaluate("[window.runs, window.refused.length]") == [0, 0]
    assert list(shown["runs"]) == ["identifier_based", "extended_kalman", "de_luca"]
    assert any(line["name"].startswith("kept") for line in shown["drawn"]["error"])
    assert_equals_python(shown)


def test_a_host_that_gives_no_bundle_has_a_worker_of_the_module_that_it_imported(show):
    page = show(observer_lab(duration=10.0), f"{stated_policy()}; worker-src 'self'", answered)
    page.wait_for_function(DRAWN)
    page.evaluate("""() => {
        const [{ widget }] = window.perceptObsLabs;
        const get = widget.get;
        widget.get = (name) => (name === "_esm" ? undefined : get(name));  // as in marimo
    }""")
    page.evaluate("tests.touch()")
    page.wait_for_function("() => tests.beside()")
    rested(page)
    assert [worker.url for worker in page.workers] == ["http://lab.test/lab.js"]
    assert_equals_python(state(page))


def test_where_a_policy_forbids_workers_the_page_computes(show):
    page = show(observer_lab(duration=10.0), f"{stated_policy()}; worker-src 'none'", answered)
    page.wait_for_function(DRAWN)
    page.evaluate("tests.countRuns()")
    page.evaluate("tests.touch()")
    rested(page)
    page.wait_for_function("() => window.refused.length")
    page.evaluate("tests.unfold()")
    page.fill(control("duration number"), "8")
    rested(page)
    assert not page.evaluate("tests.beside()")
    assert page.evaluate("window.runs") > 0
    assert page.locator(".problem:not([hidden])").count() == 0
    assert_equals_python(state(page))


def test_while_a_heavy_picture_is_computed_the_page_goes_on(show):
    """A long task of the page would block pointer and keys as long."""
    page = with_worker(show, points_lab(weight="riccati", size=0.01, duration=30.0))
    found = page.evaluate("(changes) => tests.blocked(changes)", {"period": 0.005, "step": 0.002, "duration": 90.0})
    assert found["took"] > 300, found
    assert found["longest"] < found["took"] / 2, found
    assert found["turns"] > 20, found


@pytest.mark.parametrize(("make", "name", "step"), HANDLES)
def test_keys_lose_no_step_where_pictures_are_late(show, make, name, step):
    page = with_worker(show, make())
    before = page.evaluate("(name) => tests.place(name)", name)
    page.evaluate("(name) => tests.keysFasterThanPictures(name)", name)
    rested(page)
    moved = [b - a for a, b in zip(before, page.evaluate("(name) => tests.place(name)", name), strict=True)]
    assert moved == pytest.approx([2 * step, step], rel=0.005)  # a speed has three digits


@pytest.mark.night
def test_play_runs_at_the_rate_of_the_screen_and_neither_moves_nor_play_fill_the_memory(show):
    """It takes the night to play ten minutes.

    The estimates of four runs are 192 kB here; kept at every move they would fill several times the bound.
    """
    page = with_worker(show, observer_lab(**FOUR), reduced_motion="no-preference")
    used = memory_of(page)
    page.evaluate("tests.steer(100)")
    page.evaluate("tests.play(1)")
    rested(page)
    before = used()
    page.evaluate(f"tests.steer({MOVES})")
    found = page.evaluate(f"tests.play({SECONDS})")
    rested(page)
    assert used() - before < 10, (before, used())
    assert found["pictures"] > 0.9 * found["frames"], found


def test_the_policy_that_readme_states_says_nothing_of_workers():
    """They come under `script-src` then, which has blob:."""
    assert "worker-src" not in stated_policy()
    assert re.search(r"script-src [^;]*blob:", stated_policy())


@pytest.mark.parametrize("make", [observer_lab, structure_lab, points_lab, derivation_desk])
def test_a_lab_works_under_the_policy_that_readme_states(browser, make):
    page = opened(browser, make())
    page.wait_for_function(DRAWN)
    assert page.locator("canvas, .percept-lab input").count() > 2
    assert page.evaluate("window.refused") == []
    page.close()


def test_a_saved_lab_that_may_run_no_script_says_so(browser, tmp_path):
    observer_lab(duration=1.0).save(tmp_path / "lab.html")
    page = browser.new_page(offline=True)
    text, policy = (tmp_path / "lab.html").read_text("utf-8"), {"Content-Security-Policy": "script-src 'self'"}
    page.route("http://lab.test/", lambda route: route.fulfill(body=text, content_type="text/html", headers=policy))
    page.goto("http://lab.test/")
    assert "content security policy forbids scripts" in page.inner_text("[data-percept-obs]")
    page.close()


def test_a_policy_that_forbids_blobs_is_named_in_the_lab(browser):
    page = opened(browser, observer_lab(), stated_policy().replace(" blob:", ""))
    page.wait_for_function("() => window.refused.length")
    page.locator(".problem:not([hidden])").first.wait_for()
    assert "must allow scripts from blob:" in page.locator(".problem:not([hidden])").first.inner_text()
    page.close()
