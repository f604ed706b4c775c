"""Fixtures of all tests: Node.js, a browser, matplotlib without windows, and the same examples in every CI run."""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # read by numpy; threads only wait for each other in small matrices

import gc
import math
import shutil
import signal
import sys
from collections import Counter
from functools import cache, partial

import browsers
import costs
import hypothesis
import platformdirs
import pytest
from needs import found_chromium, missing
from sample_sizes import sampled

sys.modules.setdefault("rfc3987_syntax", None)  # jsonschema does without its grammar, which takes 5 s of each process
signal.signal(
    signal.SIGINT, signal.default_int_handler
)  # in the background it is ignored, and by programs started here
gc.disable()  # until all is collected, or what the tests' modules make is looked through again and again
os.environ["MPLBACKEND"] = "Agg"
# Kernels and servers with a home of their own take loops in machine code from here too.
os.environ.setdefault("NUMBA_CACHE_DIR", str(platformdirs.user_cache_path("percept_obs")))

IN_BROWSER = set()
"""Files of which a test wants a browser."""
EXAMPLES = sampled(25, 100)
hypothesis.settings.register_profile("here", deadline=None, max_examples=EXAMPLES)
hypothesis.settings.register_profile("ci", deadline=None, max_examples=EXAMPLES, derandomize=True, database=None)
hypothesis.settings.load_profile("ci" if os.environ.get("CI") == "true" else "here")


def pytest_configure(config):
    """Count what tests cost, in the processes that run them."""
    if counting := costs.plugin():
        config.pluginmanager.register(counting)


def pytest_itemcollected(item):
    """A test of a page that waited too long is tried once more, and what takes the night is left to it.

    The processor may have been busy elsewhere.  What is wrong, or an exception, is never tried again.
    """
    if item.get_closest_marker("browser"):
        item.add_marker(pytest.mark.flaky(reruns=1, only_rerun=["^TimeoutError"]))
    if item.get_closest_marker("night") and not sampled(False, True):
        item.add_marker(pytest.mark.skip(reason="takes the night: run it with ALL_SAMPLES=1"))


APART = (
    "test_it_runs_with_what_it_asks_for_and_every_control_moves",
    "test_the_whole_site_is_made",
    "test_a_page_opens_without_an_error_or_a_request_and_fits_every_window",
)
"""Tests that take long and share nothing: each of their cases goes to whichever process is free, in this order."""


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_auto_num_workers(config):
    """One process more than processors, for tests of pages wait for their browser, which computes while it is asked."""
    return (os.cpu_count() or 1) + 1


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config, log):
    """Give a file's tests to one process, in which its labs open once, but spread what is `APART`."""
    from xdist.scheduler import LoadFileScheduling

    class Rooms(LoadFileScheduling):
        def _split_scope(self, nodeid):
            name = nodeid.partition("::")[2].partition("[")[0]
            return nodeid if name in APART else super()._split_scope(nodeid)

    return Rooms(config, log)


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup(item):
    """Close the browser that tests share before one of another room, or one that wants none."""
    browsers.enter(item.path.parent if item.path in IN_BROWSER else None)


def pytest_sessionfinish():
    browsers.close()


def pytest_collection_modifyitems(items):
    """Let come first what others wait for, the notebooks and the site, then files that take long; the site's own last.

    By then the site is there, and its pages, which share nothing, fill what time the other processes have left.
    """
    tests = Counter(item.path for item in items)
    slow = Counter(item.path for item in items if item.get_closest_marker("slow"))
    IN_BROWSER.update(item.path for item in items if item.get_closest_marker("browser"))
    late = {item.path for item in items if "pages" in item.fixturenames}

    def rank(item):
        path, name = item.path, item.originalname
        order = APART.index(name) if name in APART[:2] else 2 + (path in late)
        return order, path not in IN_BROWSER, -slow[path], -tests[path]

    items.sort(key=rank)


def pytest_collection_finish():
    """Modules, tests and expressions stay to the end, so they are not looked through for garbage."""
    gc.freeze()
    gc.enable()


@pytest.fixture(scope="session")
def node():
    """The path of Node.js."""
    return shutil.which("node") or missing(
        "node",
        "Node.js is missing. Debian: sudo apt-get install nodejs. macOS: brew install node. "
        "Windows: winget install OpenJS.NodeJS.",
    )


@pytest.fixture(scope="session")
def xr():
    """The module xarray, which takes a while to load."""
    import xarray

    return xarray


@pytest.fixture(scope="session")
def base(tmp_path_factory):
    """A folder that all processes of this run share."""
    own = tmp_path_factory.getbasetemp()
    return own.parent if "PYTEST_XDIST_WORKER" in os.environ else own


@pytest.fixture(scope="session")
def ran(base):
    """Takes the run of a notebook that any test began, in this process or in another one, or begins it."""
    from notebook_runs import shared_run

    return cache(partial(shared_run, base))


@pytest.fixture(scope="session")
def pages(base, ran):
    """The folder of the whole site, which one process makes from the runs of the notebooks."""
    from whole_site import shared_site

    return shared_site(base, ran)


@pytest.fixture(scope="module")
def always_compiled():
    """Many short runs of many points, which pay for compiling their loop together."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("percept_obs.points.kernel.STATE_WORK", math.inf)
        yield


@pytest.fixture(scope="session")
def chromium():
    """The path of Chromium or Chrome: the system's, or the one that Playwright keeps."""
    return found_chromium() or missing(
        "chromium",
        "Chromium is missing. Debian: sudo apt-get install chromium-headless-shell. "
        "macOS and Windows: python -m playwright install chromium.",
    )


@pytest.fixture(scope="module")
def browser(chromium):
    """The browser of this process, without JupyterLab, whose pages know `window.tests`."""
    return browsers.shared(chromium)


@pytest.fixture
def show(browser):
    """Opens labs in pages of their own, which have drawn when they are returned and close after the test."""
    from lab_alone import DRAWN, opened

    pages = []

    def show_in_page(lab, *arguments, **options):
        pages.append(opened(browser, lab, *arguments, **{"viewport": {"width": 1280, "height": 800}, **options}))
        pages[-1].wait_for_function(DRAWN)
        pages[-1].set_default_timeout(15_000)
        return pages[-1]

    yield show_in_page
    for page in pages:
        page.close()


@pytest.fixture(scope="module")
def lab(browser, python):
    """A page with one lab that the tests of a module share; Python's lab, `python`, answers it."""
    from lab_alone import answered

    with answered(browser, python) as page:
        yield page


@pytest.fixture
def fresh(lab):
    """The shared lab in its opening state."""
    from lab_browser import rested

    lab.evaluate("tests.reset()")
    rested(lab)
    lab.locator(".views").scroll_into_view_if_needed()
    return lab
