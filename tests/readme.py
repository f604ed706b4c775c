"""README.md's parts that come from the package, its pictures and the repository's name: `python tests/readme.py`.

It draws the pictures anew if the word `pictures` follows, for they differ a little from machine to machine.
The name of the repository stands in ``pyproject.toml``, under ``[project.urls]``, and nowhere else by hand.
"""

import io
import re
import sys
import tomllib
from pathlib import Path

import matplotlib
import numpy as np
from PIL import Image

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
from percept_obs.studies.fields import PixelNoise, field_bound

ROOT = Path(__file__).parents[1]
README = ROOT / "README.md"
PICTURES = ROOT / ".github/pictures"
NAMES_THE_REPOSITORY = (README, ROOT / "CITATION.cff")

COLOURS = 64  # in a picture: curves and letters need no more, and the file is a quarter as large
SCREEN = (1100, 570)


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
    sideways, noise = affine(np.zeros((3, 3)), [0.5, 0, 0]), PixelNoise(sigma=0.5, across=640)
    seen = [field_bound(surface, sideways, noise, np.radians(150)) for surface in (pinhole(), unified(0.8), sphere())]
    return figures.fields(seen)


FIGURES = {make.__name__: make for make in (observers_at_their_limit, map_of_the_bound, three_surfaces)}
"""Figures of the gallery; each brings its text equivalent."""

LABS = {
    "observer_lab": (
        observer_lab,
        "The lab of one point. On the left what the camera sees: the point, how it moves and how its estimate "
        "expects it to, and the focus of expansion in a hatched circle. On the right the world from above, with the "
        "point and its estimate on one ray. Below, the two distances over 4 s, which agree within 10 % from 2.3 s "
        "on. One sentence and three questions stand above.",
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


def repository():
    """Address of the repository, as the package's metadata has it."""
    return tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["urls"]["Repository"]


def with_repository(text):
    """A text with the repository's owner and name in its links to GitHub and Binder."""
    name = repository().removeprefix("https://github.com/")
    return re.sub(r"(https://(?:github\.com|mybinder\.org/v2/gh)/)[^/\s]+/[^/\s\")]+", rf"\g<1>{name}", text)


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
    return "\n\n".join(f"![{text}]({(PICTURES / name).relative_to(ROOT)}.png)" for name, text in texts.items())


def with_part(text, name, part):
    """Replace a part of a text between comments."""
    start, end = f"<!-- {name} -->\n", "\n<!-- end -->"
    before, rest = text.split(start)
    return f"{before}{start}{part}{rest[rest.index(end) :]}"


def picture(figure):
    """A figure as an image."""
    written = io.BytesIO()
    with matplotlib.rc_context({"savefig.dpi": 110}):
        figure.figure.savefig(written, format="png")
    return few_colours(written.getvalue())


def pictures_of_labs(chromium):
    """All labs of the gallery."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=["--no-sandbox", "--disable-gpu"])
        images = {name: picture_of_lab(browser, make) for name, (make, _) in LABS.items()}
        browser.close()
    return images


def picture_of_lab(browser, make):
    """A lab's first screen once it has played, as an image."""
    from first_screens import at_the_end, first_screen

    with first_screen(browser, make(), SCREEN, color_scheme="light") as page:
        at_the_end(page)
        return few_colours(page.screenshot())


def few_colours(png):
    return (
        Image.open(io.BytesIO(png))
        .convert("RGB")
        .quantize(COLOURS, Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE)
    )


def write_pictures():
    """Draw all pictures anew, and describe them."""
    from conftest import found_chromium

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
    README.write_text(with_part(README.read_text("utf-8"), "gallery", gallery(texts)), "utf-8")


def main(pictures):
    """Write the table and the links, and the pictures if asked for."""
    README.write_text(with_part(README.read_text("utf-8"), "observers", observer_table()), "utf-8")
    if pictures:
        write_pictures()
    for path in NAMES_THE_REPOSITORY:
        path.write_text(with_repository(path.read_text("utf-8")), "utf-8")


if __name__ == "__main__":
    main("pictures" in sys.argv[1:])
