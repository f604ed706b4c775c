// @ts-check
// The frames of a film behind a track: each is decoded when it is first seen, and a few are kept.

import { sampleAt } from "../model/tables.js";

const KEPT = 24;
const SEEN = 0.8;

export class Film {
  constructor(lab) {
    this.lab = lab;
    this.films = lab.widget.get("frames") ?? {};
    /** @type {Map<string, ImageBitmap | null>} */
    this.ready = new Map();
    /** @type {string} */
    this.last = "";
  }

  /** Draw the frame that is seen at a time, or the last one while it is being decoded. */
  draw(pen, { x, y }, { scenario }, time) {
    const film = this.films[scenario];
    if (!film || time === null) return;
    const which = sampleAt(film.time, Math.max(time, film.time[0]));
    const key = `${scenario} ${which}`;
    this.prepare(key, film.images[which]);
    if (this.ready.get(key)) this.last = key;
    const image = this.last.startsWith(`${scenario} `) ? this.ready.get(this.last) : null;
    if (!image) return;
    const [left, right, lower, upper] = film.extent;
    const [begin, top] = [x(left), y(upper)];
    pen.save();
    pen.globalAlpha = SEEN;
    pen.translate(begin, top);
    // An edge may lie on either side: y2 points down in many cameras.
    pen.scale(Math.sign(x(right) - begin), Math.sign(y(lower) - top));
    pen.drawImage(image, 0, 0, Math.abs(x(right) - begin), Math.abs(y(lower) - top));
    pen.restore();
  }

  prepare(key, bytes) {
    if (this.ready.has(key)) return;
    this.ready.set(key, null);
    createImageBitmap(new Blob([bytes], { type: "image/png" })).then(
      (image) => {
        this.ready.set(key, image);
        for (const old of [...this.ready.keys()].slice(0, -KEPT)) {
          if (old === this.last || !this.ready.get(old)) continue;
          this.ready.get(old)?.close();
          this.ready.delete(old);
        }
        this.lab.redraw();
      },
      (error) => this.lab.view.notice(`A frame cannot be shown: ${error.message}`),
    );
  }
}
