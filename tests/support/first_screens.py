"""Labs in pages of their own: opening them, asking a question, and reading what pictures say."""

from contextlib import contextmanager

from lab_alone import DRAWN, opened
from lab_browser import control

SIZES = {"cell": (830, 600), "wide": (1240, 680), "phone": (390, 760)}

READY = "() => [...(window.perceptObsLabs ?? [])].some((lab) => lab.screen?.scene)"
WATCHED = """() => { const [{ screen, late }] = window.perceptObsLabs;
    return !late && !screen.clock.playing && !screen.clock.waiting && screen.questions.telling; }"""
END = "() => { const [{ screen }] = window.perceptObsLabs; screen.clock.begun = true; screen.clock.finish(); }"
STILL = """() => new Promise((done) => { const [lab] = window.perceptObsLabs; let [calm, tries] = [0, 0];
    const look = () => { calm = lab.pending || lab.late ? 0 : calm + 1;
        return calm > 2 || ++tries > 300 ? done(true) : requestAnimationFrame(look); };
    look(); })"""
"""Wait until no view is on its way."""

TEXTS = """() => {
    const [lab] = window.perceptObsLabs;
    const seen = lab.figures.filter(({ figure }) => figure.checkVisibility());
    const pen = CanvasRenderingContext2D.prototype;
    const { fillText } = pen;
    const drawn = [];
    pen.fillText = function (text, x, y) {
        drawn.push([this.canvas, text, x, y]);
        fillText.call(this, text, x, y);
    };
    lab.screen.draw(lab.shown, lab.ghost, lab.theme);
    pen.fillText = fillText;
    return seen.map(({ canvas, figure, width, height, texts }) => {
        const told = ([, text, x, y]) => texts.some(({ text: other, box }) => text === other
            && box[0] <= x && x <= box[2] && box[1] <= y && y <= box[3]);
        const own = drawn.filter(([where]) => where === canvas);
        const { left, top } = figure.getBoundingClientRect();
        const range = document.createRange();
        const above = [...figure.querySelectorAll("button, p, figcaption, text")].filter((node) =>
            node.checkVisibility({ visibilityProperty: true }) && node.textContent.trim()).map((node) => {
            if (node.tagName === "BUTTON") range.selectNode(node);
            else range.selectNodeContents(node);
            const box = range.getBoundingClientRect();
            const sides = [box.left - left, box.top - top, box.right - left, box.bottom - top];
            return { text: node.textContent, box: sides };
        });
        const unknown = above.filter(({ text }) => !texts.some((each) => each.text === text));
        return { width, height, texts: [...texts, ...unknown], secret: own.filter((each) => !told(each))
            .map(([, text]) => text) };
    });
}"""
"""Texts of all pictures in sight, on the canvas and above it, and those that a painter wrote without reporting them."""

COUNTS = """() => {
    const [{ screen }] = window.perceptObsLabs;
    const words = (text) => text.split(/[^\\p{L}\\p{N}.]+/u).filter((word) => /[\\p{L}]/u.test(word)).length;
    const nodes = [...screen.body.querySelectorAll("[data-control]")].filter((node) => node.checkVisibility());
    const said = [...screen.body.querySelectorAll("*")].filter((node) => node.checkVisibility() && !node.children.length
        && !node.closest(".unseen, .handle, canvas, svg")).map((node) => node.textContent);
    const own = [...screen.body.querySelectorAll("label, .sliding > span")].flatMap((node) =>
        [...node.childNodes].filter((child) => child.nodeType === 3).map((child) => child.textContent));
    const drawn = screen.views.flatMap(({ texts }) => texts.map(({ text }) => text));
    const { width, height } = screen.body.getBoundingClientRect();
    const area = screen.views.reduce((sum, { figure }) => {
        const box = figure.getBoundingClientRect(); return sum + box.width * box.height; }, 0);
    const counted = words([...said, ...own, ...drawn].join(" "));
    return { controls: nodes.length, words: counted, share: area / (width * height) };
}"""


@contextmanager
def first_screen(browser, lab, size=SIZES["cell"], **options):
    """A page with a lab that has drawn; no error of the page is left unseen."""
    wrong = []
    moving = {"reduced_motion": "no-preference", **options}
    page = opened(browser, lab, viewport=dict(zip(("width", "height"), size, strict=True)), **moving)
    page.on("pageerror", lambda error: wrong.append(str(error)))
    page.set_default_timeout(15_000)
    page.wait_for_function(READY)
    yield page
    assert wrong == []
    page.close()


def at_the_end(page):
    """Show the end of the run at once, as if it had been played."""
    page.evaluate(END)
    page.wait_for_function(DRAWN)
    page.evaluate(STILL)


def asked(page, name, answer=0):
    """Ask a question, answer it, and show the end of the run."""
    page.evaluate("(name) => [...window.perceptObsLabs][0].screen.questions.ask(name)", name)
    page.click(control(f"answer {answer}"))
    page.wait_for_function(DRAWN)
    at_the_end(page)
    page.wait_for_function(WATCHED)


def overlaps(page):
    """Texts of the pictures that are cut or not reported, and pairs that cover each other."""
    found = []
    for view in page.evaluate(TEXTS):
        found += [("not reported", text) for text in view["secret"]]
        boxes = [(each["text"], each["box"]) for each in view["texts"]]
        found += [
            text
            for text, (left, top, right, bottom) in boxes
            if left < 0 or top < 0 or right > view["width"] or bottom > view["height"]
        ]
        for k, (text, one) in enumerate(boxes):
            for other_text, other in boxes[k + 1 :]:
                if one[0] < other[2] and one[2] > other[0] and one[1] < other[3] and one[3] > other[1]:
                    found.append((text, other_text))
    return found
