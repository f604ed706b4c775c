// A numeric witness: the image's motion at a point, as the typed lines have it and as it is.

import { readable } from "../../common/model/scales.js";
import { element, setText } from "../../common/page/dom.js";
import { squareAround } from "../../common/page/image_frame.js";
import { FramedImage } from "../../common/page/image_plane.js";
import { swatch } from "../../common/page/line_styles.js";
import { DASHES, SOLID } from "../../common/page/looks.js";
import { arrowMark, pointMark } from "../../common/page/marks.js";

const SQUARE = squareAround([[-0.8, 0.8], [-0.8, 0.8]]);
/** Length of the longer arrow, in units of the image. */
const LENGTH = 0.55;
const HEAD = 9;
const MINE = 1;

export class Witness extends FramedImage {
  constructor(lab) {
    super(lab, [
      {
        ...{ name: "point", label: "Point of the image: drag it, or use the arrow keys", className: "diamond" },
        onMove: (place) => this.move(place),
        onRest: () => lab.rest(),
      },
    ]);
    this.handles[0].node.dataset.tag = "y";
    this.words = element("p", { class: "reading" });
    const entry = (which, text) => element("li", {}, swatch(which), text);
    const entries = [entry("truth", "the true motion"), entry(MINE, "yours")];
    this.legend = element("ul", { class: "legend", "aria-label": "Arrows" }, ...entries);
    this.body = element("div", { class: "witness" }, this.legend, this.figure, this.words);
  }

  move([y1, y2]) {
    const inside = (value) => Number(Math.min(Math.max(value, -1), 1).toFixed(3));
    this.lab.change({ point: [inside(y1), inside(y2), this.lab.settings.point[2]] });
  }

  /** Draw the arrows of an answer; without one those of before stay away. */
  show(answer, theme) {
    if (answer) this.body.hidden = !answer.witness;
    if (this.body.hidden) return;
    const { point } = this.lab.settings;
    const found = answer?.witness;
    const mine = found && typedPart(found);
    const inside = (pen, frame) => {
      if (!found) return;
      const scale = LENGTH / Math.max(length(found.true), mine ? length(mine) : 0, 1e-9);
      arrow(pen, frame, point, found.true, scale, theme.ink, SOLID);
      if (mine) arrow(pen, frame, point, mine, scale, theme.lines[MINE], DASHES[MINE]);
      pointMark(pen, frame.x(point[0]), frame.y(point[1]), theme.ink, theme);
    };
    this.paint(() => SQUARE, theme, { inside }, () => [point.slice(0, 2)]);
    if (!found) return;
    const told = inWords(found, point);
    setText(this.words, told);
    this.tell(told);
    this.handles[0].describe();
  }
}

/** The motion by the typed lines; what is not typed is taken from the truth. */
function typedPart({ mine, true: known }) {
  return mine.every((value) => value === null) ? null : mine.map((value, k) => value ?? known[k]);
}

function inWords({ names, mine, true: known }, [y1, y2, inverse]) {
  const place = `At y1 = ${readable(y1)}, y2 = ${readable(y2)}, inverse distance ${readable(inverse)}/m: `;
  const each = names.map((name, k) => {
    const yours = mine[k] === null ? "" : `yours ${readable(mine[k])}, `;
    return `${name}: ${yours}true ${readable(known[k])}`;
  });
  return `${place}${each.join("; ")}.`;
}

function length([y1, y2]) {
  return Math.hypot(y1, y2);
}

/** An arrow from a place, so long as a motion is at a scale. */
function arrow(pen, { x, y }, [y1, y2], [d1, d2], scale, colour, dash) {
  const to = [x(y1 + scale * d1), y(y2 + scale * d2)];
  arrowMark(pen, [x(y1), y(y2)], to, { colour, dash, width: 2.5, head: HEAD });
}
