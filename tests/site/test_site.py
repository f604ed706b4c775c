"""The course as a site: every page opens from a disk without a request, labs draw, links lead somewhere."""

import json
import re
import subprocess
from functools import cache
from html import unescape
from html.parser import HTMLParser
from os.path import normpath
from pathlib import Path
from urllib.parse import unquote, urldefrag

import matplotlib.figure
import nbformat
import pytest
from front_ends import TRIALS, Shown
from lab_alone import DRAWN
from lab_settings import FRONT
from needs import missing
from places import NOTEBOOKS, SUPPORT
from whole_site import ADDRESS, NOTEBOOK, of_each_kind, written
from widths import assert_fits

import percept_obs
from percept_obs import PerspectiveSystem, affine, cli, ibo, pinhole, site
from percept_obs.exercises.models import notebooks
from percept_obs.figures.base import Figure
from percept_obs.labs.shared.saved import place_of
from percept_obs.papers import NAMED
from percept_obs.site.exercises import OF_A_NOTEBOOK
from percept_obs.site.extension import _let_keys_scroll, displayed, mathml
from percept_obs.site.front_ends import TRIED
from percept_obs.site.named import named
from percept_obs.site.notebooks import NOT_RUN, drawing, not_run
from percept_obs.site.pages import ledger_addresses, reference
from percept_obs.site.slides import NEXT, slides_of

PARTS = 12
"""Tests that share the pages of each kind."""
CLOSELY = ("00_start", "05_structure_and_motion")
"""Notebooks whose pages axe looks at: all are made the same way, and these have all that others have."""


class Links(HTMLParser):
    """Where a page leads to, what it loads, and its places."""

    def __init__(self, path):
        super().__init__()
        self.targets, self.places = [], set()
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attrs):
        attributes = dict(attrs)
        self.places |= {attributes["id"]} if "id" in attributes else set()
        self.targets += [attributes[name] for name in ("href", "src") if attributes.get(name)]


@pytest.mark.slow
def test_the_whole_site_is_made(pages):
    assert (pages / "index.html").exists()


@pytest.mark.slow
def test_every_link_leads_somewhere(pages):
    found = {path: Links(path) for path in written(pages)}
    assert (
        {path.stem for path in found if path.parent.name == "slides"}
        == {path.stem for path in found if path.parent.name == "notebooks"}
        == {"index", *(path.stem for path in NOTEBOOKS.glob("*.ipynb"))}
    )
    assert len(found) > sum(len(ledger.entries) for ledger in NAMED.values())
    assert (
        f"../lite/lab/index.html?path={NOTEBOOK}"
        in found[(pages / "notebooks" / NOTEBOOK).with_suffix(".html")].targets
    )
    there = cache(Path.exists)  # pages of a folder share most links
    for path, links in found.items():
        for target in links.targets:
            address, place = urldefrag(target)
            if re.match(r"[a-z]+:", target):
                assert not re.search(r"\.(js|css|png|svg|woff2?)$", address), f"{path} loads {target}"
                continue
            to = Path(normpath(path.parent / unquote(address).split("?")[0])) if address else path
            assert there(to), f"{path} leads to {target}"
            if place and to in found:
                assert unquote(place) in found[to].places, f"{path} leads to {target}"


def complaints_of(page):
    """A list of what a page will complain about, and of the addresses that it will ask for."""
    found = []
    page.on("pageerror", lambda error: found.append(str(error)))
    page.on("console", lambda message: found.append(message.text) if message.type in ("error", "warning") else None)
    page.on("request", lambda request: found.append(request.url) if request.url.startswith("http") else None)
    return found


@pytest.mark.slow
@pytest.mark.browser
@pytest.mark.parametrize("part", range(PARTS))
def test_a_page_opens_without_an_error_or_a_request_and_fits_every_window(pages, browser, part):
    axe = (FRONT / "node_modules/axe-core/axe.min.js").read_text("utf-8")
    page = browser.new_page(offline=True, viewport={"width": 1280, "height": 800})
    complaints, looked = complaints_of(page), 0
    for path in of_each_kind(pages)[part::PARTS]:
        page.goto(path.as_uri())
        page.wait_for_function("() => tests.allDrawn()")
        if path.parent.name != "notebooks" or path.stem in CLOSELY:
            page.evaluate(axe)
            options = "{ exclude: ['.percept-lab'] }, { preload: false, resultTypes: ['violations'] }"
            found = page.evaluate(f"axe.run({options})")["violations"]
            assert [one["id"] for one in found if one["impact"] in ("serious", "critical")] == [], path
        looked += assert_fits(page, path, drawers=False)  # a lab's own tests look into its drawer
        assert complaints == [], path
    print(f"part {part}: {looked} controls reached")
    assert looked
    page.close()


@pytest.mark.slow
def test_no_page_says_what_only_a_notebook_can_keep(pages):
    for path in written(pages):
        text = re.sub(r"<(script|style).*?</\1>", "", path.read_text("utf-8"), flags=re.DOTALL)
        text = text.partition('role="main"')[2] or text  # the menu names modules
        words = unescape(re.sub(r"<(?!/?kbd)[^>]*>", "", text))
        if path.relative_to(pages).parts[0] not in ("reference", "genindex.html"):  # they are of Python
            assert not OF_A_NOTEBOOK.findall(words), path
        if path.parent.name == "notebooks":
            assert not re.search(r"percept_obs\.exercises|\b(tally|needs|derive|choose|reach)\(", words), path


@pytest.mark.slow
def test_every_notebook_was_run_and_has_a_title_and_slides(pages):
    for path in (pages / "notebooks").glob("[0-9]*.html"):
        text = path.read_text("utf-8")
        assert NOT_RUN not in text
        slides = (pages / "slides" / path.name).read_text("utf-8")
        title = re.search(r"<h1>(.*?)<a", text)[1]
        assert f"<h1>{title}" in slides
        assert slides.count("<section") > 5


@pytest.mark.slow
@pytest.mark.browser
def test_a_word_is_found_from_a_disk(pages, browser):
    page = browser.new_page(offline=True)
    complaints = complaints_of(page)
    page.goto((pages / "tour.html").as_uri())
    page.locator(".sidebar-search").fill("excitation")
    page.keyboard.press("Enter")
    page.get_by_text("Search finished").wait_for()
    found = page.locator("#search-results li a")
    assert found.count() > 5
    found.first.click()
    page.locator("#percept_obs\\.figures\\.excitation").wait_for()
    assert complaints == []
    page.close()


@pytest.mark.slow
def test_the_reference_shows_what_is_taken_and_raised_and_links_to_the_like(pages):
    for path in (pages / "reference").glob("percept-obs*.html"):
        text = path.read_text(encoding="utf-8")
        assert not re.search(r'<ol class="\w*alpha', text), f"an initial such as R. begins a list in {path}"
        assert not re.search(r"<em>[a-z]+</em></a>", text), f"a word is taken for a name in {path}"
        for beside in re.findall(r'admonition seealso">(.*?)</div>', text, re.DOTALL):
            assert beside.count("xref py py-obj") == beside.count('<a class="reference internal"'), (path, beside)
    whole = (pages / "reference" / "percept-obs.html").read_text(encoding="utf-8")
    track = re.search(r'<dt class="sig[^>]* id="percept_obs.track">.*?</section>', whole, re.DOTALL)[0]
    assert all(f"{title}<span" in track for title in ("Parameters", "Returns", "Raises"))
    assert 'href="#percept_obs.DoesNotFit"' in track


@pytest.mark.slow
@pytest.mark.browser
def test_the_first_lab_draws_within_a_second_and_a_half_of_computing(pages, browser):
    page = browser.new_page(offline=True, viewport={"width": 1280, "height": 800})
    session = page.context.new_cdp_session(page)
    session.send("Performance.enable", {"timeDomain": "threadTicks"})
    page.goto((pages / "notebooks" / NOTEBOOK).with_suffix(".html").as_uri(), wait_until="commit")
    page.wait_for_function(DRAWN)
    metrics = {metric["name"]: metric["value"] for metric in session.send("Performance.getMetrics")["metrics"]}
    print(f"first lab: {metrics['ProcessTime']:.2f} s of computing, {page.evaluate('performance.now()') / 1000:.2f} s")
    assert metrics["ProcessTime"] < 1.5
    page.close()


@pytest.mark.slow
@pytest.mark.browser
def test_a_lab_on_a_slide_is_alive_and_its_keys_turn_no_slide(pages, browser):
    page = browser.new_page(offline=True, viewport={"width": 1280, "height": 800})
    complaints = complaints_of(page)
    page.goto((pages / "slides" / NOTEBOOK).with_suffix(".html").as_uri())
    page.wait_for_function(DRAWN)
    for _ in range(2):  # the title, the goals, the lab
        page.keyboard.press("Space")
    lab = page.locator("section.present .percept-lab").first
    lab.locator(".screen .views canvas").first.wait_for()
    assert lab.locator(".screen .views canvas").first.bounding_box()["height"] > 200
    gain = lab.locator(".screen input[type=range]").first
    before = gain.input_value()
    gain.press("ArrowRight")
    assert gain.input_value() != before
    assert lab.is_visible()
    page.evaluate("document.activeElement.blur()")
    page.keyboard.press("Space")
    page.get_by_text("Exercise 1: derive.").wait_for()
    assert complaints == []
    page.close()


def test_what_was_not_run_says_so_below_its_title():
    title, said, *rest = not_run(notebooks()[NOTEBOOK]).cells
    assert (title.id, [cell.id for cell in rest][:2]) == ("title", ["goals", "lab"])
    assert NOT_RUN in said.source


def test_slides_are_the_cells_with_their_tag_and_the_exercises():
    notebook = nbformat.reads((NOTEBOOKS / NOTEBOOK).read_text("utf-8"), as_version=4)
    made = slides_of(notebook)
    chosen = [cell for cell in made.cells if cell.source != NEXT]
    assert [cell.id for cell in chosen][:3] == ["title", "goals", "lab"]
    assert {tag for cell in chosen for tag in cell.metadata["tags"]} == {"slide", "exercise", "remove-input"}
    assert not any("solution" in cell.metadata["tags"] for cell in chosen)


@pytest.mark.slow
@pytest.mark.browser
def test_a_printed_page_is_cut_nowhere_and_shows_no_menu(pages, browser):
    page = browser.new_page(offline=True, viewport={"width": 720, "height": 1000})  # A4 within its margins
    page.goto((pages / "notebooks" / NOTEBOOK).with_suffix(".html").as_uri())
    page.wait_for_function(DRAWN)
    page.emulate_media(media="print")
    assert not page.locator(".skip-to-content, .sidebar-drawer, .toc-drawer").filter(visible=True).count()
    cut = "[...document.querySelectorAll('pre, div.math')].filter((it) => it.scrollWidth > it.clientWidth + 1).length"
    assert page.locator("pre").count() > 3
    assert page.evaluate(cut) == 0
    page.close()


@pytest.fixture(scope="module")
def shown(pages, browser):
    """Two labs in a page of the site, without a network."""
    page = browser.new_page(offline=True, viewport={"width": 1280, "height": 800})
    page.goto((pages / "notebooks" / NOTEBOOK).with_suffix(".html").as_uri())
    page.wait_for_function("(count) => tests.settled(count)", arg=2)
    yield Shown(page, 2)
    page.close()


@pytest.mark.slow
@pytest.mark.browser
@pytest.mark.parametrize("what", TRIED)
def test_a_lab_of_the_site_is_alive(shown, what):
    TRIALS[what](shown)


@pytest.mark.slow
@pytest.mark.browser
@pytest.mark.node
def test_lighthouse_finds_every_page_open_to_all(pages, chromium, node):
    modules = FRONT / "node_modules"
    if not (modules / "lighthouse").exists():
        missing("lighthouse", f"Lighthouse is missing; get it with: npm install --no-save lighthouse@12, in {FRONT}")
    names = [path.relative_to(pages).as_posix() for path in of_each_kind(pages)]
    command = [node, SUPPORT / "lighthouse.mjs", modules, chromium, pages, *names]
    lines = subprocess.run(command, check=True, capture_output=True, encoding="utf-8").stdout.splitlines()
    found = [json.loads(line) for line in lines]
    least = min(found, key=lambda page: page["mark"])
    print(f"{len(found)} pages; the least mark is {least}")
    assert least["mark"] >= 95, least


@pytest.mark.slow
def test_a_signature_names_a_long_default(pages):
    text = (pages / "reference" / "percept-obs-papers.html").read_text(encoding="utf-8")
    assert "LEDGERS</span>" in text
    assert "Entry(place=" not in text


@pytest.mark.slow
def test_every_page_says_what_it_is_and_where(pages):
    found = [path for path in written(pages) if not {"_static", "slides"} & {*path.relative_to(pages).parts}]
    sitemap = (pages / "sitemap.xml").read_text(encoding="utf-8")
    assert sitemap.count("<loc>") == len(found)
    descriptions = set()
    for path in found:
        text, address = path.read_text(encoding="utf-8"), f"{ADDRESS}/{path.relative_to(pages).as_posix()}"
        assert f"<loc>{address}</loc>" in sitemap
        (description,) = re.findall(r'<meta name="description" content="([^"]+)"', text)
        assert len(description) <= 160 * 1.1  # as HTML writes it
        descriptions.add(description)
        assert f'<meta property="og:url" content="{address}"' in text
        assert f'<link rel="canonical" href="{address}"' in text
        assert f'<p class="version">percept_obs {percept_obs.__version__}' in text
    assert len(descriptions) > 0.5 * len(found)
    assert (pages / "_static" / "card.png").read_bytes().startswith(b"\x89PNG")


def test_only_teachers_get_the_exam():
    for exam in (True, False):
        names = [name for name, _ in site._texts(exam)]
        assert ("exam.md" in names) is exam
        assert ("exam.md" in named([], exam)["exam"]) is exam
    assert "<summary>Solution" not in "".join(text for _, text in site._texts(False))


def test_an_address_of_its_own_for_every_equation():
    for ledger in NAMED.values():
        names = ledger_addresses(ledger)
        assert len(set(names.values())) == len(ledger.entries)


def test_every_public_name_has_a_place_in_the_reference():
    text = "".join(text for _, text in reference())
    titles = {name for title in re.findall(r"\n(.*)\n---", text) for name in re.findall(r"\w+", title)}
    assert set(percept_obs.__all__) - titles == {"scenarios"}, "which is a module, and has a page"


def test_a_drawing_brings_no_rules_into_the_page():
    whole = matplotlib.figure.Figure()
    text = drawing(Figure(whole, (whole.subplots(),), 'a "curve" <falls>'))
    assert "<style" not in text
    assert "#000000" not in text
    assert 'aria-label="a &quot;curve&quot; &lt;falls&gt;"' in text


def test_a_text_in_the_settings_cannot_end_the_script():
    state = {"kind": "desk_lab", "model": {}, "settings": {"student": "</script><script>alert(1)"}, "texts": b""}
    assert "</script><script>" not in place_of(state)


@pytest.mark.parametrize(
    "wide",
    [
        "<pre",
        '<table class="ledger"',
        '<table class="entry"',
        '<table border="1" class="dataframe"',
        '<div class="table-wrapper docutils"',
    ],
)
def test_what_may_be_wider_than_the_page_is_scrolled_by_keys(wide):
    context = {"body": f"{wide}>"}
    _let_keys_scroll(None, "", "", context, None)
    assert context["body"] == f'{wide} tabindex="0">'


def test_a_formula_is_written_for_the_browser():
    pytest.importorskip("latex2mathml", reason='get it with: python -m pip install "percept-obs[site]"')
    assert mathml(r"$\displaystyle \frac{1}{y_3}$", "block").startswith("<math")
    equations = displayed(ibo(PerspectiveSystem(affine(), pinhole()))._repr_latex_())
    assert "<mtable" in equations
    assert "<mi>&</mi>" not in equations, "the rows of several equations stand in one"


def test_what_is_missing_is_named_with_the_command_that_gets_it(monkeypatch, capsys, tmp_path):
    monkeypatch.setattr(
        "percept_obs.validation.environment.find_spec", lambda module: None if module == "furo" else object()
    )
    assert cli.main(["site", str(tmp_path / "new")]) == 1
    assert 'furo is missing; get it with: python -m pip install "percept-obs[site]"' in capsys.readouterr().err
    monkeypatch.setattr("percept_obs.validation.environment.find_spec", lambda module: "lite" not in module or None)
    assert cli.main(["site", str(tmp_path / "new"), "--python"]) == 1
    assert "jupyterlite_core, jupyterlite_pyodide_kernel are missing; get them with" in capsys.readouterr().err
    assert not Path(tmp_path / "new").exists()
