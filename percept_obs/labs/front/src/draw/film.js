// @ts-check
// The frames of a film behind tracks: each is decoded when it is first seen, and a few are kept.

import { sampleAt } from "../engine/tables.js";

const KEPT = 24;
/** Frames that are decoded before they are due. */
const AHEAD = 4;
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

  /** Draw the frame nearest to a film's time in its box, or the last one while it is being decoded. */
  draw(pen, which, time, [left, right, lower, upper]) {
    const { time: times, images } = this.films[which];
    const before = sampleAt(times, Math.max(time, times[0]));
    const frame = times[before + 1] - time < time - times[before] ? before + 1 : before;
    const key = `${which} ${frame}`;
    for (let k = frame; k < Math.min(frame + AHEAD, images.length); k += 1) this.prepare(`${which} ${k}`, images[k]);
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
