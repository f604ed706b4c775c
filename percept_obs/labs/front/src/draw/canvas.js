// A canvas that is as sharp as the screen and as wide as its place, with a name for those who do not see it.

import { element, setAttribute } from "./dom.js";
import { DASHES } from "./looks.js";

const COLOURS = ["raised", "ink", "muted", "line", "grid", "sample", "warning", "kept", "noise", "paper"];

/** A canvas with role, label and a text that tells what it shows. */
export class Picture {
  constructor(className, label) {
    this.label = label;
    this.canvas = element("canvas", { role: "img", "aria-label": label });
    this.context = /** @type {CanvasRenderingContext2D} */ (this.canvas.getContext("2d"));
    this.figure = element("figure", { class: className }, this.canvas);
    this.font = "";
    /** @type {{width: number, height: number} | null} */
    this.size = null;
  }

  /** The figure's last known size in CSS pixels; null while it is hidden. */
  measure() {
    // Asking the page for a size makes it lay itself out, which in a large notebook takes longer than drawing.
    if (!this.size) this.resize(this.figure.clientWidth, this.figure.clientHeight);
    return this.size;
  }

  /** Take a size in whole pixels: a part of one would move lines and not what lies below them. */
  resize(width, height) {
    const [across, down] = [Math.round(width), Math.round(height)];
    this.size = across && down ? { width: Math.max(120, across), height: Math.max(60, down) } : null;
  }

  /** Fit the canvas to its figure's last known size, with a font for its letters; return its size in CSS pixels. */
  fit(font) {
    const { canvas, context } = this;
    const ratio = window.devicePixelRatio || 1;
    const { width, height } = this.measure() ?? { width: 120, height: 60 };
    if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
      canvas.width = Math.round(width * ratio);
      canvas.height = Math.round(height * ratio);
      canvas.style.width = `${width}px`;
      canvas.style.height = `${height}px`;
      this.font = "";
    }
    // A canvas that is told its font makes the page style itself.
    if (this.font !== font) context.font = this.font = font;
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, width, height);
    context.lineWidth = 1;
    // Letters of the last picture may have left it as they need it.
    context.lineJoin = "round";
    return { width, height };
  }

  tell(text) {
    setAttribute(this.canvas, "aria-label", `${this.label}: ${text}`);
  }
}

/** The colours of the theme that the element is shown in. */
export function themeOf(element) {
  const style = getComputedStyle(element);
  const colour = (name) => style.getPropertyValue(`--lab-${name}`).trim();
  const named = /** @type {Record<string, any>} */ (Object.fromEntries(COLOURS.map((name) => [name, colour(name)])));
  const lines = DASHES.map((_, k) => colour(`line-${k}`));
  return { ...named, lines, font: `11px ${colour("font") || "sans-serif"}` };
}
