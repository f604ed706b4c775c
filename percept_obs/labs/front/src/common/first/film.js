// @ts-check
// The frames of a film behind tracks: each is decoded when it is first seen, and a few are kept.

import { sampleAt } from "../model/tables.js";

const KEPT = 24;
/** Opacity, with which all marks and letters stand out on it. */
const SEEN = 0.65;

export class Film {
  constructor(lab) {
    this.lab = lab;
    this.films = lab.widget.get("frames") ?? [];
    /** @type {Map<string, ImageBitmap | null>} */
    this.ready = new Map();
    /** @type {string} */
    this.last = "";
  }

  /** Draw the frame of a film's time in its box, or the last one while it is being decoded. */
  draw(pen, which, time, [left, right, lower, upper]) {
    const { time: times, images } = this.films[which];
    const frame = sampleAt(times, Math.max(time, times[0]));
    const key = `${which} ${frame}`;
    this.prepare(key, images[frame]);
    if (this.ready.get(key)) this.last = key;
    const image = this.last.startsWith(`${which} `) ? this.ready.get(this.last) : null;
    if (!image) return;
    pen.save();
    pen.globalAlpha = SEEN;
    pen.translate(left, upper);
    // An edge may lie on either side.
    pen.scale(Math.sign(right - left), Math.sign(lower - upper));
    pen.drawImage(image, 0, 0, Math.abs(right - left), Math.abs(lower - upper));
    pen.restore();
  }

  prepare(key, bytes) {
    if (this.ready.has(key)) return;
    this.ready.set(key, null);
    const type = bytes.getUint8(0) === 0xff ? "image/jpeg" : "image/png";
    createImageBitmap(new Blob([bytes], { type })).then(
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
