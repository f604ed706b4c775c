// What holds of a page at the width of its window: nothing is wider, and whatever can be pressed can be reached.
// A function of whether the drawers of labs are looked into; it returns { looked, wrong }: how many controls it looked at, and a sentence for each that fails.
window.tests.fits = async (within = true) => {
  const PRESSED = 'a[href], button, input, select, summary, textarea, label[for], [role="button"], [tabindex="0"]';
  const RAND = 1; // px that a browser rounds
  const root = document.documentElement;
  const wrong = [];
  let looked = 0;
  const still = document.head.appendChild(document.createElement("style"));
  still.textContent = "* { transition: none !important; animation: none !important; }";

  const painted = () => new Promise((done) => requestAnimationFrame(() => setTimeout(done)));
  const named = (node) => {
    const words = node.getAttribute("aria-label") || node.dataset.control || node.textContent.trim() || node.id;
    return `${node.tagName.toLowerCase()}.${[...node.classList].join(".")} "${words.slice(0, 40)}"`;
  };
  /** The largest part of a control: a link may stand in two lines. */
  const boxOf = (node) =>
    [...node.getClientRects()].reduce((a, b) => (a && a.width * a.height >= b.width * b.height ? a : b), null);
  const isOpen = (node) =>
    !node.disabled &&
    !node.closest("[inert]") &&
    node.checkVisibility({ visibilityProperty: true, opacityProperty: true, contentVisibilityAuto: true });

  /** What stands in the way of a press on the middle of what is seen of a control; null if nothing does. */
  const obstacle = (node) => {
    const box = boxOf(node);
    if (!box || box.width * box.height === 0) return "has no size";
    const [left, right] = [Math.max(box.left, 0), Math.min(box.right, root.clientWidth)];
    const [top, bottom] = [Math.max(box.top, 0), Math.min(box.bottom, root.clientHeight)];
    if (left >= right || top >= bottom) return `is outside of the window: ${Math.round(box.left)}, ${Math.round(box.top)}`;
    if (box.right - box.left <= root.clientWidth && (box.left < -RAND || box.right > root.clientWidth + RAND)) {
      return `is cut by the window: ${Math.round(box.left)} to ${Math.round(box.right)}`;
    }
    const found = document.elementFromPoint((left + right) / 2, (top + bottom) / 2);
    const own = found && (node.contains(found) || (found.contains(node) && found.closest("a, button, label, summary")));
    const label = found?.closest("label");
    return own || label?.control === node || label?.htmlFor === node.id ? null : `is covered by ${found && named(found)}`;
  };
  /** A box that was moved to show a control, though nobody but a script can scroll it. */
  const hiding = (node) => {
    for (let box = node.parentElement; box; box = box.parentElement) {
      const { overflowX, overflowY } = getComputedStyle(box);
      if ((overflowX === "hidden" && box.scrollLeft) || (overflowY === "hidden" && box.scrollTop)) return box;
    }
    return null;
  };
  const look = (within) => {
    for (const node of within.querySelectorAll(PRESSED)) {
      if (!isOpen(node)) continue;
      looked += 1;
      if (obstacle(node) === null) continue;
      node.focus({ preventScroll: true }); // a link that skips to the content comes with the focus
      node.scrollIntoView({ block: "center", inline: "center", behavior: "instant" });
      const box = hiding(node);
      box?.scrollTo(0, 0);
      const way = obstacle(node) && box ? `is cut by ${named(box)}` : obstacle(node);
      if (way !== null) wrong.push(`${named(node)} ${way}`);
      node.blur();
    }
  };
  /** Boxes that reach out of the window and that no box around them scrolls. */
  const measure = () => {
    if (root.scrollWidth <= root.clientWidth) return;
    const wide = [...document.body.querySelectorAll("*")].filter((node) => {
      if (!node.checkVisibility() || node.getBoundingClientRect().right <= root.clientWidth + RAND) return false;
      for (let box = node.parentElement; box !== document.body; box = box.parentElement) {
        if (getComputedStyle(box).overflowX !== "visible") return false;
      }
      return ![...node.children].some((child) => child.getBoundingClientRect().right > root.clientWidth + RAND);
    });
    wrong.push(`the page is ${root.scrollWidth} wide; there reach out ${wide.slice(0, 3).map(named).join(", ")}`);
  };

  /** Drawers of the theme: they are looked into where they are open, or can be opened by a control that is there. */
  const drawers = [...document.querySelectorAll(".sidebar-drawer, .toc-drawer")];
  const away = (node) => {
    const box = node.getBoundingClientRect();
    return box.width === 0 || box.right <= RAND || box.left >= root.clientWidth - RAND;
  };
  const closed = drawers.filter((drawer) => drawer.checkVisibility() && away(drawer));
  for (const drawer of closed) drawer.inert = true;
  measure();

  const stages = [...document.querySelectorAll(".percept-lab")];
  const slides = window.Reveal?.getSlides() ?? [];
  if (slides.length) window.Reveal.configure({ transition: "none", backgroundTransition: "none" });
  for (const slide of slides) {
    const { h, v } = window.Reveal.getIndices(slide);
    window.Reveal.slide(h, v);
    await painted();
    look(slide);
  }
  await painted();
  look(document);
  // The drawer of a lab, each of its groups in turn.
  for (const lab of within ? stages : []) {
    const more = lab.querySelector('[data-control="more"]');
    if (!more || !isOpen(more)) continue;
    more.click();
    await painted();
    for (const group of lab.querySelectorAll(".drawer summary")) {
      if (!group.parentElement.open) group.click();
      await painted();
      look(lab.querySelector(".drawer"));
      measure();
    }
    more.click();
    await painted();
  }

  for (const drawer of closed) {
    drawer.inert = false;
    const toggle = document.getElementById(drawer.matches(".toc-drawer") ? "__toc" : "__navigation");
    const opener = [...document.querySelectorAll(`label[for="${toggle.id}"]`)].find(isOpen);
    if (!drawer.querySelector("a") || drawer.matches(".no-toc")) continue;
    if (!opener) {
      wrong.push(`nothing opens ${named(drawer)}`);
      continue;
    }
    toggle.click();
    await painted();
    if (away(drawer)) wrong.push(`${named(drawer)} does not open`);
    else look(drawer);
    toggle.click();
  }
  still.remove();
  window.scrollTo({ top: 0, behavior: "instant" });
  return { looked, wrong };
};
