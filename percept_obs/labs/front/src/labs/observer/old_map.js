// The map of the bound under the track: the stronger the shade of a place in the image, the less can be known there of
// the distance.

import { readable } from "../../draw/scales.js";
import { percent } from "../../state/words.js";
import { paintDots } from "../../draw/canvas.js";
import { noBound } from "./bound.js";
import { mapAt, mapOf, placeAlong } from "./bound_map.js";

/** Places along a side while a hand moves, and when it rests. */
const COARSE = 48;
const FINE = 144;
/** Half decades of the relative error from 0.01 % to 100 %, each in a shade of its own. */
const [LEAST, SHADES] = [-4, 8];
const DARKEST = 0.6;
/** The key beside the picture: how wide it is, and with its numbers. */
const KEY = { width: 8, room: 40 };

/** The shade of a relative error, from 0 on; the last one for all above. */
function shadeOf(value) {
  return Math.min(Math.max(Math.floor(2 * (Math.log10(value) - LEAST)), 0), SHADES - 1);
}

function opacityOf(shade) {
  return (DARKEST * (shade + 1)) / SHADES;
}

export class MapPicture {
  constructor(lab) {
    this.lab = lab;
    this.canvas = document.createElement("canvas");
    this.known = this.painted = "";
    /** @type {ReturnType<typeof mapOf> | null} what is drawn */
    this.found = null;
  }

  wanted({ settings, problem }) {
    return !problem && settings.bound.includes("map") && !noBound(settings, this.lab.model);
  }

  /** The map of a result in a square of the image, computed when something of it has changed. */
  of({ settings }, { centre, half }) {
    const { lab } = this;
    const functions = lab.kernels.of(settings);
    if (!functions) return this.found;
    const { surface, outputs, A, b, normal, xi, motion, scenario, noise, period, map } = settings;
    const resolution = lab.held ? COARSE : FINE;
    const read = [surface, outputs, A, b, normal, xi, motion, scenario, noise, period, map];
    const key = JSON.stringify([read, centre, half, resolution]);
    if (key !== this.known) {
      this.known = key;
      const moving = lab.results.engines[0].camera.motion(settings, functions);
      this.found = mapOf(settings, functions, moving, { centre, half }, resolution, lab.model);
    }
    return this.found;
  }

  draw(pen, { x, y }, square, shown, theme) {
    if (!this.wanted(shown)) {
      this.found = null;
      this.known = "";
      return;
    }
    const found = this.of(shown, square);
    if (!found) return;
    this.shade(found, theme);
    const { y1, y2, resolution } = found;
    const cell = (x(y1[1]) - x(y1[0])) / (resolution - 1);
    // The places are the middles of the picture's dots, the first row of which is the highest.
    pen.drawImage(this.canvas, x(y1[0]) - cell / 2, y(y2[1]) - cell / 2, cell * resolution, cell * resolution);
  }

  /** Room that the key needs beside the picture. */
  roomFor(shown) {
    return this.wanted(shown) ? KEY.room : 0;
  }

  /** The key of the shades, beside the picture, where it covers nothing. */
  drawKey(picture, { box }, theme) {
    if (!this.found) return;
    const { pen } = picture;
    const { left, top, side } = box;
    const x = left + side + 6;
    const y = (shade) => top + side * (1 - shade / SHADES);
    for (let shade = 0; shade < SHADES; shade++) {
      pen.fillStyle = theme.warning;
      pen.globalAlpha = opacityOf(shade);
      pen.fillRect(x, y(shade + 1), KEY.width, side / SHADES);
    }
    pen.globalAlpha = 1;
    pen.setLineDash([]);
    pen.strokeStyle = theme.line;
    pen.strokeRect(x + 0.5, top + 0.5, KEY.width, side);
    for (let shade = 0; shade <= SHADES; shade += 2) {
      picture.write(readable(100 * 10 ** (LEAST + shade / 2)), x + KEY.width + 4, y(shade), theme.ink, "left");
    }
    const { seconds, distance } = this.found;
    const words = `least error in % after ${readable(seconds)} s, at ${readable(distance)} m`;
    picture.caption("map", words, box, theme.ink, 1);
  }

  /** Paint a dot for each place; where a point comes behind the camera there is none. */
  shade({ resolution, relative }, theme) {
    const key = this.known + theme.warning;
    if (key === this.painted) return;
    this.painted = key;
    paintDots(this.canvas, resolution, theme.warning, (k) => {
      return Number.isNaN(relative[k]) ? 0 : opacityOf(shadeOf(relative[k]));
    });
  }

  /** The text equivalent. */
  inWords({ foe, truth }) {
    const { found } = this;
    if (!found) return "";
    const { relative, y1, y2, resolution, seconds, distance } = found;
    const places = Array.from(relative.keys()).filter((i) => Number.isFinite(relative[i]));
    const begun = `Map of the bound for points at ${readable(distance)} m, seen for ${readable(seconds)} s`;
    if (!places.length) return `${begun}: nowhere is there a bound, for all come behind the camera.`;
    const place = (i) => {
      const at = (ends, k) => readable(placeAlong(ends, resolution, k), 2);
      return `y1 ${at(y1, i % resolution)}, y2 ${at(y2, Math.floor(i / resolution))}`;
    };
    const best = places.reduce((a, i) => (relative[i] < relative[a] ? i : a));
    const worst = places.reduce((a, i) => (relative[i] > relative[a] ? i : a));
    const parts = [
      `the distance to ${percent(relative[best], 2)} at best, at ${place(best)}`,
      `to ${percent(relative[worst], 2)} at worst, at ${place(worst)}`,
    ];
    const told = (name, there) => {
      const value = there ? mapAt(found, there) : NaN;
      if (Number.isFinite(value)) parts.push(`to ${percent(value, 2)} at ${name}`);
    };
    told("the focus of expansion", foe);
    told("the point's first image", truth && [truth[0], truth[1]]);
    return `${begun}: ${parts.join("; ")}.`;
  }
}
