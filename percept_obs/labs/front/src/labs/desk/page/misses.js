// A chart of how far a line misses, term by term.  It is the scrubber: one drags through what was typed.

import { View } from "../../../draw/view.js";
import { scrubbed } from "../../../ui/scrub.js";

const PAD = { left: 50, right: 48, top: 26, bottom: 24 };
/** Room after the last term, where its step goes on. */
const TREAD = 32;
/** Height from which terms are named in rows, how many these are, and how high. */
const [TALL, ROWS, ROW] = [180, 3, 15];

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
    const { grid, muted, ink, lines: [blue] } = theme;
    const rows = height < TALL ? 1 : ROWS;
    const [top, right, bottom] = [PAD.top, width - PAD.right, height - PAD.bottom - (rows - 1) * ROW];
    const known = parts.filter(({ miss }) => miss !== null);
    const shown = known.filter(({ end }) => end <= at);
    const most = Math.min(Math.max(1, ...known.map(({ miss }) => miss)), 3) * 1.12;
    const x = (k) => PAD.left + (k / this.count) * (right - PAD.left);
    const y = (miss) => bottom - (Math.min(miss, most) / most) * (bottom - top);
    for (const level of [0, 0.5, 1]) {
      this.line([[PAD.left, y(level)], [right + TREAD, y(level)]], grid, { width: 1 });
      this.write(`${100 * level} %`, PAD.left - 6, y(level), muted, "right");
    }
    this.write("how far the line misses", PAD.left, top - 14, muted, "left");
    this.line(stairs(known, x, y, this.count), blue, { width: 2, alpha: at < this.count ? 0 : 0.3 });
    this.line(stairs(shown, x, y, at), blue, { width: 3 });
    if (at >= this.count) {
      const height = y(shown.at(-1)?.miss ?? 1);
      this.line([[right, height], [right + TREAD, height]], blue, { width: 3 });
    }
    // The last term first: it is named also where there is no room for all.
    const ends = [0, ...parts.map(({ end }) => end).filter((end) => end <= at)];
    for (let k = ends.length - 1; k > 0; k--) {
      const row = k % rows;
      this.write(text.slice(ends[k - 1], ends[k]).trim(), x(ends[k]), bottom + 12 + row * ROW, muted, "right");
    }
    const { miss = 1, end = 0 } = shown.at(-1) ?? {};
    this.line([[x(at), top - 6], [x(at), bottom]], ink);
    this.dot(x(at), bottom, 6, ink);
    this.ring(x(at), y(miss), 4, blue, 2.5);
    const yet = end < this.count ? "so far " : "";
    const said = miss < 5e-3 ? "misses nothing" : `${yet}misses by ${Math.round(100 * miss)} %`;
    this.tag({ id: "now", text: said, at: [x(at), y(miss)], colour: blue, rank: 0, towards: [-1, -1] });
    this.end();
    this.tell(shown.length ? said : "nothing is typed");
  }
}

/** Points of a line that falls or rises at the end of each term; nothing typed misses by all. */
function stairs(parts, x, y, last) {
  const points = [[x(0), y(1)]];
  for (const { end, miss } of parts) points.push([x(end), points.at(-1)?.[1] ?? 0], [x(end), y(miss)]);
  return [...points, [x(last), points.at(-1)?.[1] ?? 0]];
}
