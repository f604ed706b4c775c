// A chart of how far a line misses, term by term.  It is the scrubber: one drags through what was typed.

import { View } from "../../../draw/view.js";
import { scrubbed } from "../../../ui/scrub.js";

const PAD = { left: 50, right: 16, top: 26, bottom: 24 };
/** Height from which terms are named in rows, and the button has its place above the chart; what these take. */
const [TALL, ROWS, ROW, BUTTON] = [200, 3, 15, 30];

export class Misses extends View {
  /** @param {(at: number) => void} onPlace  takes the character that a hand asks for */
  constructor(onPlace) {
    super("misses", "How far the line misses, term by term");
    this.count = 1;
    scrubbed(this, PAD, (part) => onPlace(Math.round(this.count * part)));
  }

  ground() {
    return this.theme.paper;
  }

  /** Draw the beginnings of a text up to a character. */
  draw(text, parts, at, theme) {
    this.count = Math.max(text.length, 1);
    this.begin(theme);
    const { width, height } = this;
    const rows = height < TALL ? 1 : ROWS;
    const top = PAD.top + (rows > 1 ? BUTTON : 0);
    const [right, bottom] = [width - PAD.right, height - PAD.bottom - (rows - 1) * ROW];
    const known = parts.filter(({ miss }) => miss !== null);
    const most = Math.min(Math.max(1, ...known.map(({ miss }) => miss)), 3) * 1.12;
    const x = (k) => PAD.left + (k / this.count) * (right - PAD.left);
    const y = (miss) => bottom - (Math.min(miss, most) / most) * (bottom - top);
    for (const level of [0, 0.5, 1]) {
      this.line([[PAD.left, y(level)], [right, y(level)]], theme.grid, { width: 1 });
      this.write(`${100 * level} %`, PAD.left - 6, y(level), theme.muted, "right");
    }
    this.write("how far the line misses", PAD.left, top - 14, theme.muted, "left");
    const [blue] = theme.lines;
    const shown = known.filter(({ end }) => end <= at);
    this.line(stairs(known, x, y, this.count), blue, { width: 2, alpha: at < this.count ? 0 : 0.3 });
    this.line(stairs(shown, x, y, at), blue, { width: 3 });
    const ends = parts.map(({ end }) => end).filter((end) => end <= at);
    // The last term first: it is named also where there is no room for all.
    for (let k = ends.length - 1; k >= 0; k--) {
      const term = text.slice(ends[k - 1] ?? 0, ends[k]).trim();
      this.write(term, x(ends[k]), bottom + 12 + ((ends.length - 1 - k) % rows) * ROW, theme.muted, "right");
    }
    const now = x(at);
    const miss = shown.at(-1)?.miss ?? 1;
    this.line([[now, top - 6], [now, bottom]], theme.ink);
    this.dot(now, bottom, 6, theme.ink);
    this.ring(now, y(miss), 4, blue, 2.5);
    const yet = (shown.at(-1)?.end ?? 0) < this.count ? "so far " : "";
    const said = miss < 5e-3 ? "misses nothing" : `${yet}misses by ${Math.round(100 * miss)} %`;
    this.tag({ id: "now", text: said, at: [now, y(miss)], colour: blue, rank: 0, towards: [-1, -1] });
    this.end();
    this.tell(shown.length ? said : "nothing is typed");
  }
}

/** Points of a line that falls or rises at the end of each term; nothing typed misses by all. */
function stairs(parts, x, y, last) {
  let miss = 1;
  const points = [[x(0), y(1)]];
  for (const part of parts) {
    points.push([x(part.end), y(miss)], [x(part.end), y(part.miss)]);
    miss = part.miss;
  }
  return [...points, [x(last), y(miss)]];
}
