"""A link is a state: settings go into a page's address and back unchanged, and no address does anything else."""

import json

import numpy as np
import pytest
from hostile_messages import messages
from javascript import run_script
from lab_alone import DRAWN
from lab_browser import control
from lab_settings import FRONT, random_settings, whole_model
from points_settings import random_settings as random_points
from sample_sizes import sampled
from structure_settings import CASES as STRUCTURE_CASES

from percept_obs import affine, rigid
from percept_obs.labs import observer_lab, points_lab, structure_lab
from percept_obs.labs.shared.saved import STARTER, library_of, page_of, place_of
from percept_obs.points import independent_points

LABS = {"observer": observer_lab, "points": points_lab, "structure": lambda: structure_lab(duration=3.0)}
B = "b=0.4,0.3,0.3"
LONG = "9" * 400


def in_node(node, models, settings=(), addresses=()):
    """What the page makes of settings and of addresses, each with the name of its lab."""
    task = {"models": models, "settings": settings, "addresses": addresses}
    return run_script(node, FRONT / "tests/run_address.js", task)


@pytest.fixture(scope="module")
def models():
    return {name: whole_model(make()) for name, make in LABS.items()}


def random_states(name, count):
    """A lab, and settings of it, at random: those of its other tests, and any that it takes, with kept ones."""
    lab = LABS[name]()
    known = {
        "observer": lambda seed: random_settings(lab, seed),
        "points": random_points,
        "structure": lambda seed: list(STRUCTURE_CASES.values())[seed % len(STRUCTURE_CASES)],
    }[name]
    found = [lab.check({**lab.settings, **known(seed)}) for seed in range(max(1, count // 10))]
    for message in messages(lab, 20 * count, 3, with_summary=0):
        if len(found) == count:
            break
        given = message["settings"] if isinstance(message["settings"], dict) else {}
        changes = {name: value for name, value in given.items() if value != lab.settings.get(name)}
        kept = found[len(found) // 2] if len(found) % 3 == 0 else None
        try:
            found.append(lab.check({**found[-1], **changes, "kept": kept}))
        except ValueError:
            continue
    assert len(found) == count
    return lab, found


@pytest.mark.slow
@pytest.mark.node
def test_random_settings_go_into_an_address_and_back_unchanged(node):
    models, states = {}, []
    for name in LABS:
        lab, found = random_states(name, sampled(8, 334))
        models[name] = whole_model(lab)
        states += [(name, settings) for settings in found]
    assert len({json.dumps(state) for state in states}) > 0.8 * len(states)
    assert sum(settings["kept"] is not None for _, settings in states) > 0.2 * len(states)
    rng = np.random.default_rng(5)
    seen = {"side": [True, False], "sight": [None, [0.5, 1.25]], "more": ["", "charts"], "chosen": ["", "sliding_mode"]}
    looked = [{key: values[rng.integers(2)] for key, values in seen.items()} for _ in states]
    tasks = [(*state, look) for state, look in zip(states, looked, strict=True)]
    rounds = in_node(node, models, tasks)["rounds"]
    for (name, settings), told in zip(states, rounds, strict=True):
        assert told["back"] == settings, (name, told["text"])
        assert told["seen"] == told["view"], (name, told["text"])
        assert len(told["text"]) < 10_000


words = str.split
PLACES = [
    *words("__proto__ constructor constructor.prototype toString __proto__.polluted hasOwnProperty kept.__proto__"),
    *words(
        "gains.__proto__.polluted gains.constructor.prototype.polluted noise.__proto__.size kept.kept kept.kept.seed"
    ),
    *words(". .. b. .b b.0 b.__proto__ noise gains noise.size.x nothing B %62 seed.seed"),
    *("", "b ", "a" * 5000, "kept." * 4000 + "seed", "gains." * 3000 + "x"),
]
NUMBERS = [
    *words("- --1 NaN nan Infinity -Infinity 1e999 -1e999 1e e5 0x10 0b1 1_000 1,000 +1 1n ١ 1e+5 null true [1] {} 1;"),
    *words("1/2 -1 4294967296 0.5 1e10 %31% % %zz %ff %c0%af alert(1) `1` Math.PI undefined"),
    *("", " 1", "1 ", LONG),
]
ROWS = ["", *words("1 1,2 1,2,3,4 1,2,x 1,,3 1,2,NaN 1,2,1e999 1001,0,0 1/2/3 [1,2,3] 1;2;3 -")]
SCRIPTS = [
    *words(
        "<script>alert(1)</script> %3Cscript%3Ealert(1)%3C/script%3E javascript:alert(1) ');alert(1);// ${alert(1)}"
    ),
    *words("\"onload=alert(1) __import__('os').mkdir('x') ../../etc/passwd \u202e \x00 \ud83d"),
]
NAMES = ["", *words("pinhole y9 y1,y1 y1,y9 y1, , y2,y1 y1%2Cy9 %ff constructor __proto__ length")]
VERSIONS = ["", "0", "2", "01", "1.0", "one", "__proto__", "1 ", LONG]
OF_OBSERVER = [
    *(f"{place}=1" for place in PLACES),
    *(f"seed={value}" for value in NUMBERS),
    *(f"{name}={value}" for name in ("b", "A") for value in ROWS),
    *(f"A={value}" for value in ("1,2,3/1,2,3", "1,2,3/1,2,3/1,2", "1,2,3/1,2,3/1,2,3/1,2,3")),
    *(f"outputs={value}" for value in [*NAMES, *SCRIPTS]),
    *(f"surface={value}" for value in [*SCRIPTS, "toString", "Pinhole", "pinhole,plane", "-"]),
    *(f"motion={value}" for value in [*SCRIPTS, "b1%20=%20t", "b1%20%3D%20sin%28t%29", "b" * 401, "(" * 19_000]),
    *("", ";", "seed", "=3", f"{B};{B}", "noise=uniform,0.1", "noise.kind=pink", "normal=0,1,0", "period=0"),
    *("look.charts=everything", "look.more=" + "x" * 41, "look.side=yes", "look.sight=1", "look.sight=a,b", "look=1"),
    *("believed.b=1,2,3", "believed=1", "believed=-;believed.b=1,2,3", "kept=1", "kept.seed=x", "kept.outputs="),
    *("gains.extended_kalman.noise_variance=-1", "gains.identifier_based.reset_ratio=0.5", "gains.identifier_based=1"),
    *("gains.nobody.gain=1", "gains.identifier_based.gain=x", "switches.sliding_mode=soft", "scenario=my_recording"),
    *("b=" + "1," * 500_000, "seed=" + "3" * 1_000_000, ";" * 10_000, "b=" + "[" * 15_000 + "]" * 4_000),
]
OF_POINTS = [
    *(f"points={value}" for value in ["", "/", "1,2,3/", "1,2/3,4", "1,2,3/x", "-", "0,0,1/" * 200 + "0,0,1", "0,0,1"]),
    *(f"hidden={value}" for value in ("", "-/-", "5,2/-/-", "-1,2/-/-")),
    *("weight=typed;P=exp(t)", "state=own", "P=" + "x" * 2001),
]
OF_STRUCTURE = [
    *("unknown=v_p1,d_s", "unknown=v_p1,v_p1", "duration=100;step=1e-5", "kept.duration=100;kept.step=1e-5"),
    *("earlier=1", "earlier=True", "unknown=v_p1,v_p2,v_p3,v_c1;observers=layer", "ybar=0,0,0", "tolerance=0"),
]
FROM_ELSEWHERE = [
    *(f"observer={version};{B}" for version in VERSIONS),
    *(f"points=1;{B}", "points=1", "desk=1;student=x", "observer-2=1;seed=3", "Observer=1;seed=3", "=", "=1", "x=&y="),
    *("observer=", "observer=;", "observer=1;" * 100_000, "=" + "%" * 1_000_000),
]
HOSTILE = [
    *(("observer", f"#{address}") for address in FROM_ELSEWHERE),
    *(("observer", f"#observer=1;{part}") for part in OF_OBSERVER),
    *(("points", f"#points=1;{part}") for part in OF_POINTS),
    *(("structure", f"#structure=1;{part}") for part in OF_STRUCTURE),
]


@pytest.mark.node
def test_a_hostile_address_leaves_a_lab_as_it_is_with_a_sentence(node, models):
    assert len(HOSTILE) > 200
    answer = in_node(
        node, models, addresses=[(name, text.encode("utf-8", "replace").decode()) for name, text in HOSTILE]
    )
    for (name, text), told in zip(HOSTILE, answer["followed"], strict=True):
        assert told["visited"] is None, (name, text[:80])
        assert told["notice"].startswith("The link in this page's address is not followed: "), (name, text[:80], told)
        assert len(told["notice"]) < 600, (name, text[:80])
        assert "failed" not in told, (name, text[:80], told)
    assert answer["polluted"] == []


@pytest.mark.node
def test_a_link_is_short_and_readable_and_an_anchor_of_the_page_is_none(node, models):
    lab = observer_lab("ma2005_eq35")
    settings = lab.check({"outputs": ["y1"], "b": [0.4, 0.3, 0.3], "noise": {"kind": "uniform", "size": 0.01}})
    link = "1;b=0.4,0.3,0.3;outputs=y1;noise.size=0.01"
    addresses = [("observer", each) for each in ("", "#", "#the-camera", "#percept_obs.labs", f"#x=1&observer={link}")]
    answer = in_node(node, models, [("observer", settings)], addresses)
    assert answer["rounds"][0]["text"] == link
    *anchors, last = answer["followed"]
    assert anchors == [{"notice": "", "visited": None}] * 4
    assert last == {"notice": "", "visited": settings, "view": lab.looks.opening}


SETTINGS = "(which) => tests.settings(which)"


@pytest.fixture
def page(browser, tmp_path):
    """Shows pages of labs from the disk, without a network."""
    page = browser.new_page(offline=True, viewport={"width": 1280, "height": 800})
    page.set_default_timeout(30_000)  # three labs on a busy machine
    complaints = []
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.on("console", lambda said: complaints.append(said.text) if said.type in ("error", "warning") else None)

    def shown(text, link=""):
        (tmp_path / "lab.html").write_text(text, "utf-8")
        page.goto("about:blank")
        page.goto((tmp_path / "lab.html").as_uri() + link)
        page.wait_for_function(DRAWN)
        page.evaluate("tests.unfold()")
        return page

    yield shown
    assert complaints == []
    page.close()


def of_one(lab):
    return page_of(lab.get_state(), "A lab")


def rested_at(page, which, place, value):
    """Wait until a lab shows a setting."""
    page.wait_for_function(
        "([which, place, value]) => JSON.stringify(tests.settings(which)[place]) === value",
        arg=[which, place, json.dumps(value, separators=(",", ":"))],
    )
    page.wait_for_function(DRAWN)


@pytest.mark.browser
@pytest.mark.slow
def test_a_link_opens_the_lab_as_it_was_and_a_drag_leaves_no_history(page):
    text = of_one(observer_lab(outputs=["y1"]))
    shown = page(text)
    assert "#" not in shown.url
    before = shown.evaluate("history.length")
    for key in ("b1", "b2"):
        for _ in range(5):
            shown.locator(control(key)).press("ArrowRight")
    shown.check(control("observer extended_kalman"))
    shown.wait_for_function("() => location.hash.includes('extended_kalman')")
    assert shown.evaluate("history.length") == before
    settings = shown.evaluate(SETTINGS, 0)
    shown.click(control("copy link"))
    link = shown.inner_text(".code")
    assert link == shown.url
    shown = page(text, "#" + link.partition("#")[2])
    rested_at(shown, 0, "b", settings["b"])
    assert shown.evaluate(SETTINGS, 0) == settings
    shown.click(control("undo"))
    rested_at(shown, 0, "observers", ["identifier_based"])
    assert shown.evaluate(SETTINGS, 0)["outputs"] == ["y1"]


@pytest.mark.browser
@pytest.mark.slow
def test_velocities_in_samples_are_saved_chosen_linked_and_undone(page):
    times = np.linspace(0, 2, 21)
    v_c = np.column_stack([-0.2 - 0.1 * np.sin(times), -0.2 + 0 * times, 0 * times])
    lab = structure_lab(rigid(camera_velocity=v_c, times=times))
    text = of_one(lab)
    shown = page(text)
    slider, source, duration = (shown.locator(control(name)) for name in ("v_c1", "velocities", "duration number"))
    assert slider.is_hidden()
    curve = "() => Array.from(tests.first().shown.truth)"
    measured = shown.evaluate(curve)
    np.testing.assert_allclose(measured, np.ravel(next(iter(lab.run().values())).truth), rtol=1e-9, atol=1e-9)
    duration.fill("2.5")
    assert duration.get_attribute("aria-invalid") == "true"
    source.select_option("set")
    rested_at(shown, 0, "velocities", "set")
    assert slider.is_visible()
    assert shown.evaluate(curve) != measured
    duration.fill("2.5")
    rested_at(shown, 0, "duration", 2.5)
    source.select_option("samples")
    rested_at(shown, 0, "duration", 2)
    assert shown.evaluate(curve) == measured
    shown.wait_for_function("() => location.hash.includes('velocities=samples')")
    link = shown.url.partition("#")[2]
    for velocities in ("set", "set", "samples"):
        shown.click(control("undo"))
        rested_at(shown, 0, "velocities", velocities)
    shown.click(control("corollary 1"))
    rested_at(shown, 0, "velocities", "set")
    shown.evaluate("tests.reset()")
    rested_at(shown, 0, "velocities", "samples")
    assert shown.evaluate(SETTINGS, 0) == lab.settings
    rested_at(page(text, "#" + link), 0, "velocities", "samples")
    for there, told, reason in (
        (text, "velocities=samples;duration=3", "The velocities are sampled up to 2 s only"),
        (text, "velocities=samples;motion=t", "The velocities are those of your samples, and none can be given"),
        (of_one(structure_lab()), link.partition(";")[2], 'is "samples"; it must be one of set'),
    ):
        shown = page(there, f"#structure=1;{told}")
        shown.wait_for_function("() => document.querySelector('.notice').textContent")
        assert reason in shown.inner_text(".notice")


@pytest.mark.browser
@pytest.mark.slow
def test_of_points_a_run_ends_with_the_samples_of_its_own_motion(page):
    times = np.linspace(0, 4, 21)
    b = np.column_stack([np.cos(times), np.sin(times), 0 * times])
    shown = page(of_one(points_lab(independent_points(affine(np.zeros((3, 3)), b, times), 2))))
    duration = shown.locator(control("duration number"))
    duration.fill("5")
    assert duration.get_attribute("aria-invalid") == "true"
    shown.select_option(control("state"), "independent")
    rested_at(shown, 0, "state", "independent")
    duration.fill("5")
    rested_at(shown, 0, "duration", 5)
    shown.select_option(control("state"), "own")
    rested_at(shown, 0, "duration", 4)
    assert shown.inner_text(".notice") == "The samples of your motion end at 4 s."


WRITTEN_MEANWHILE = """() => {
    const [, , { kernels }] = window.perceptObsLabs;
    const prepare = kernels.prepare.bind(kernels);
    kernels.prepare = (settings) => {
        history.replaceState(null, "", location.hash.replace("seed=7", "seed=8"));
        return prepare(settings);
    };
}"""
"""Let the part of another lab change while the third one makes ready for its own."""


@pytest.mark.browser
@pytest.mark.slow
def test_two_labs_of_a_page_each_read_their_own_part(page):
    states = [lab.get_state() for lab in (observer_lab("ma2005_eq35"), observer_lab(outputs=["y1"]), points_lab())]
    starter = STARTER.read_text("utf-8")
    places = "".join(place_of(state) for state in states)
    text = f"<!doctype html><body>{places}<script>{library_of(states)}</script><script>{starter}</script>"
    shown = page(text, "#observer-2=1;seed=7&points=1;spin=0.5")
    rested_at(shown, 1, "seed", 7)
    rested_at(shown, 2, "spin", 0.5)
    assert shown.evaluate(SETTINGS, 0) == states[0]["settings"]
    assert shown.evaluate(SETTINGS, 1)["outputs"] == ["y1", "y2"]
    assert shown.evaluate("scrollY") > 100
    shown.evaluate(WRITTEN_MEANWHILE)
    shown.evaluate("() => (location.hash = location.hash.replace('spin=0.5', 'spin=0.6'))")
    rested_at(shown, 2, "spin", 0.6)
    shown.evaluate("() => tests.first().change({ seed: 3 }, true)")
    shown.wait_for_function(  # what of them was unfolded, and which was first, is of no matter
        "(parts) => location.hash.slice(1).replace(/;look[^&]*/g, '').split('&').sort().join() === parts",
        arg="observer-2=1;seed=7,observer=1;seed=3,points=1;spin=0.6",
    )
