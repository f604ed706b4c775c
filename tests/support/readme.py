"""README.md's and the site's parts that come from the package, and the repository's name.

`python tests/support/readme.py` writes them. It draws the pictures anew if the word `pictures` follows, for they
differ a little from machine to machine.
`--owner NAME` writes the repository's address into ``pyproject.toml``, the one place from which the links of
README.md, CITATION.cff and paper.md are made; without an address they have none that leads nowhere.
"""

import argparse
import io
import re
import tomllib

import matplotlib
import numpy as np
from PIL import Image
from places import ROOT

from percept_obs import (
    Camera,
    Gaussian,
    PerspectiveSystem,
    affine,
    bound_map,
    cramer_rao,
    ekf,
    figures,
    ibo,
    pinhole,
    record,
    scenarios,
    sphere,
    track,
    unified,
)
from percept_obs.labs import observer_lab, points_lab, structure_lab
from percept_obs.observers import OBSERVERS
from percept_obs.studies.fields import field_bound

PROJECT, README, CITATION, PAPER = (ROOT / n for n in ("pyproject.toml", "README.md", "CITATION.cff", "paper.md"))
TEXTS = ROOT / "percept_obs/site/texts"
GALLERY, OBSERVER_TABLE, PICTURES = TEXTS / "gallery.md", TEXTS / "observers.md", TEXTS / "pictures"
MOVING = ROOT / ".github/observer_lab.gif"

COLOURS = 64  # in a picture: curves and letters need no more, and the file is a quarter as large
SCREEN = (1100, 570)
MOVING_SCREEN = (1100, 500)
FRAMES = 41  # of the moving picture, ten a second


def observers_at_their_limit():
    """Two observers and the bound that no observer beats."""
    form = PerspectiveSystem(affine(), pinhole()).measure("y1", "y2")
    seen = record(scenarios.ma2005_eq35(), 20, Camera(0.05, Gaussian(0.01)), seed=1)
    runs = [track(seen, ekf(form, noise_variance=1e-4)), track(seen, ibo(form))]
    return figures.runs_over_time(runs, bound=cramer_rao(seen, form))


def map_of_the_bound():
    """How well the distance can be had at each place of the image."""
    moving = PerspectiveSystem(scenarios.ma2005_eq35().motion, pinhole())
    return figures.bound_map(bound_map(moving, 2.0, 5.0, resolution=80, y1=(-0.5, 2.5), y2=(-0.5, 1.8)))


def three_surfaces():
    """The same for three cameras with equal pixels that move sideways, in all directions that they see."""
    sideways = affine(np.zeros((3, 3)), [0.5, 0, 0])
    seen = [field_bound(surface, sideways, np.radians(150)) for surface in (pinhole(), unified(0.8), sphere())]
    return figures.fields(seen)


FIGURES = {make.__name__: make for make in (observers_at_their_limit, map_of_the_bound, three_surfaces)}
"""Figures of the gallery; each brings its text equivalent."""

LABS = {
    "observer_lab": (
        observer_lab,
        "The lab of one point. On the left what the camera sees: the point, how it moves, how its estimate expects it "
        "to move, and the focus of expansion in a hatched circle. On the right the world from above, with the point "
        "and its estimate on one ray. Below, the two distances over 4 s, which agree within 10 % from 2.3 s on. One "
        "sentence and three questions stand above.",
    ),
    "structure_lab": (
        structure_lab,
        "The lab of structure and motion. On the left three films of a car, of half, the true and twice the size, "
        "which look the same. On the right the three from above, on one ray, each with its camera. Below, ticks of "
        "what is known; with a resting car alone the size cannot be told.",
    ),
    "points_lab": (
        points_lab,
        "The lab of many points. On the left three marks of a body and its estimate in the image, on the right both "
        "from above, and the way of the camera around them. Below, the error of the estimate, which falls over 10 "
        "s.",
    ),
}
"""Labs of the gallery, with what their pictures show."""

CAPTIONS = {
    "observer_lab": "The ring is what the observer believes; once it is right both arrows agree (notebook 00).",
    "structure_lab": "Three cars of three sizes make one film: no image tells them apart (notebook 05).",
    "points_lab": "Three marks of a body, and a camera that goes around it (notebook 06).",
    "observers_at_their_limit": "Two observers, and the grey line that no unbiased one stays below (notebook 12).",
    "map_of_the_bound": "Yellow is where distance is had best, far from the focus of expansion (notebook 12).",
    "three_surfaces": "A plane, a lens and a sphere with equal pixels: which tells more? (notebook 10)",
}
"""Captions of the pictures of the gallery: where to look."""

PLAYS = LABS["observer_lab"][1].replace(" and three questions stand", " stands")
PLAYS += " The picture plays these 4 s again and again."
WITHOUT_CONTROLS = ".percept-lab button { visibility: hidden } .percept-lab :is(.handy, .strip) { display: none }"
"""A picture cannot be pressed, so it shows nothing to press."""
ENDS = 0.99
"""Share of the time with which the picture ends: at the whole the lab asks for a hand."""
REST = 3000
"""Milliseconds that the last of the images stays."""

SHOW = """(share) => {
    const [{ screen: { clock } }] = window.perceptObsLabs;
    clock.begun = true;
    if (share < 1) clock.put(clock.start + share * (clock.end - clock.start));
    else clock.finish();
}"""
"""Show a lab's first screen at a share of its time."""


def repository():
    """Address of the repository, as the package's metadata has it; empty until it is set."""
    return tomllib.loads(PROJECT.read_text("utf-8"))["project"]["urls"].get("Repository", "")


def with_owner(project, name):
    """The text of pyproject.toml with the repository of an owner on GitHub."""
    if not re.fullmatch(r"[A-Za-z0-9](-?[A-Za-z0-9])*", name):
        raise SystemExit(f"{name!r} is no name of a user on GitHub: letters, digits, and single hyphens between them")
    line = f'Repository = "https://github.com/{name}/percept_obs"\n'
    return re.sub(r"(\[project\.urls\].*\n)(Repository = .*\n)?", rf"\g<1>{line}", project)


def links(address):
    """The line of links in README.md; none without an address."""
    if not address:
        return ""
    shown = f"[Open the course in a browser, on Binder]({binder(address)})", f"[Report a mistake]({address}/issues)"
    return " · ".join(shown)


def binder(address):
    """Where Binder opens the first notebook."""
    name = address.removeprefix("https://github.com/")
    return f"https://mybinder.org/v2/gh/{name}/HEAD?urlpath=lab/tree/percept_obs_notebooks/00_start.ipynb"


def with_addresses(text, address):
    """A text whose links to files of the repository are absolute, as a registry needs them; relative without one."""

    def to(found):
        raw = address.replace("github.com", "raw.githubusercontent.com") + "/HEAD/"
        before = address and (raw if found["picture"] else f"{address}/blob/HEAD/")
        return f"{found['picture']}[{found['text']}]({before}{found['path']})"

    absolute = r"(?:https://(?:raw\.githubusercontent|github)\.com/[^/]+/percept_obs/(?:blob/)?HEAD/)?"
    return re.sub(rf"(?P<picture>!?)\[(?P<text>[^]]*)\]\({absolute}(?P<path>(?!https?:)[^)]+)\)", to, text)


def readme(text, address):
    """README.md with its links and its moving picture."""
    text = with_part(text, "links", links(address))
    text = with_part(text, "moving picture", f"![{PLAYS}]({MOVING.relative_to(ROOT).as_posix()})")
    return with_addresses(text, address)


def citation(text, address):
    """CITATION.cff with the repository's address, if it has one."""
    text = re.sub(r"^repository-code: .*\n", "", text, flags=re.MULTILINE)
    return text + f'repository-code: "{address}"\n' * bool(address)


def paper(text, address):
    """paper.md with a sentence that says where the repository is, if it is somewhere."""
    said = f"The repository is <{address}>; [Binder]({binder(address)}) opens the notebooks in a browser."
    return with_part(text, "repository", said * bool(address))


MADE = {README: readme, CITATION: citation, PAPER: paper}
"""Files that name the repository, and what writes them."""


def observer_table():
    """The rows of the table of observers."""
    rows = []
    for make in OBSERVERS:
        cells = make.about.title, f"`{make.key}`", make.about.source, make.about.needs, make.about.claim
        rows.append(f"| {' | '.join(cells)} |".replace("|w|", "\\|w\\|"))
    head = ["observer", "function", "source", "needs", "what is claimed"]
    return "\n".join([f"| {' | '.join(head)} |", "|---" * len(head) + "|", *rows])


def gallery(texts):
    """Pictures by their names, with what they show."""
    shown = (f"![{text}]({PICTURES.name}/{name}.png)\n\n*{CAPTIONS[name]}*" for name, text in texts.items())
    return "\n\n".join(shown)


def with_part(text, name, part):
    """Replace a part of a text between comments."""
    start, end = f"<!-- {name} -->\n", "<!-- end -->"
    before, rest = text.split(start)
    return f"{before}{start}{part}{chr(10) * bool(part)}{rest[rest.index(end) :]}"


def picture(figure):
    """A figure as an image."""
    written = io.BytesIO()
    with matplotlib.rc_context({"savefig.dpi": 110}):
        figure.figure.savefig(written, format="png")
    return few_colours(written.getvalue())


def pictures_of_labs(chromium):
    """All labs of the gallery; the first one also moves."""
    import browsers

    browser = browsers.shared(chromium)
    images = {name: picture_of_lab(browser, make) for name, (make, _) in LABS.items()}
    save_moving(MOVING, moving_picture(browser))
    browsers.close()
    return images


def moving_picture(browser, count=FRAMES):
    """Images of the lab of one point while it plays, at equal steps of its time."""
    from first_screens import first_screen
    from lab_alone import DRAWN

    images = []
    with first_screen(browser, observer_lab(), MOVING_SCREEN, color_scheme="light") as page:
        page.add_style_tag(content=WITHOUT_CONTROLS)
        for k in range(count):
            page.evaluate(SHOW, ENDS * k / (count - 1))
            page.wait_for_function(DRAWN)
            page.evaluate("tests.still()")
            images.append(Image.open(io.BytesIO(page.screenshot())).convert("RGB"))
    return images


def save_moving(path, images):
    """Write images as one that plays again and again, and rests at its end each time."""
    colours = few(Image.fromarray(np.vstack([images[0], images[-1]])))  # the same in all, or what rests would flicker
    first, *rest = (image.quantize(palette=colours, dither=Image.Dither.NONE) for image in images)
    durations = [100] * len(rest) + [REST]
    first.save(path, save_all=True, append_images=rest, duration=durations, loop=0, optimize=True)


def picture_of_lab(browser, make):
    """A lab's first screen once it has played, as an image."""
    from first_screens import at_the_end, first_screen

    with first_screen(browser, make(), SCREEN, color_scheme="light") as page:
        at_the_end(page)
        return few_colours(page.screenshot())


def few_colours(png):
    return few(Image.open(io.BytesIO(png)).convert("RGB"))


def few(image):
    return image.quantize(COLOURS, Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE)


def write_pictures():
    """Draw all pictures anew, and describe them."""
    from needs import found_chromium

    PICTURES.mkdir(exist_ok=True)
    drawn = {name: make() for name, make in FIGURES.items()}
    images = {name: picture(figure) for name, figure in drawn.items()}
    if chromium := found_chromium():
        images |= pictures_of_labs(chromium)
    else:
        print("the pictures of labs stay as they are, for Chromium is missing")
    for name, image in images.items():
        image.save(PICTURES / f"{name}.png", optimize=True)
    texts = {name: text for name, (_, text) in LABS.items()} | {name: figure.text for name, figure in drawn.items()}
    rewrite(GALLERY, lambda text: with_part(text, "gallery", gallery(texts)))


def rewrite(path, change):
    """Change a text file, with the ends of lines that the repository keeps on every system."""
    path.write_text(change(path.read_text("utf-8")), "utf-8", newline="\n")


def main(arguments=None):
    """Write the table and the links, and the pictures if asked for."""
    parser = argparse.ArgumentParser(description=__doc__.partition(":")[0])
    parser.add_argument("pictures", nargs="?", choices=["pictures"], help="draw the pictures anew")
    parser.add_argument("--owner", metavar="NAME", help="the user or organisation on GitHub that has the repository")
    options = parser.parse_args(arguments)
    if options.owner:
        rewrite(PROJECT, lambda text: with_owner(text, options.owner))
    rewrite(OBSERVER_TABLE, lambda text: with_part(text, "observers", observer_table()))
    if options.pictures:
        write_pictures()
    for path, make in MADE.items():
        rewrite(path, lambda text, make=make: make(text, repository()))


if __name__ == "__main__":
    main()
