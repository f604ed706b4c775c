// A canvas that is as sharp as the screen and as wide as its place, with a name for those who do not see it.

import { DASHES } from "./lines.js";

/** Make a picture: a canvas with role, label and a text that tells what it shows. */
export function picture(className, label) {
  const figure = document.createElement("figure");
  figure.className = className;
  const canvas = document.createElement("canvas");
  canvas.setAttribute("role", "img");
  canvas.setAttribute("aria-label", label);
  figure.append(canvas);
  return { figure, canvas, context: canvas.getContext("2d"), label, size: null };
}

/** Fit a picture to its figure's last known size; returns width and height in CSS pixels. */
export function fit(target) {
  const { canvas, figure } = target;
  const ratio = window.devicePixelRatio || 1;
  // Asking the page for a size makes it lay itself out, which in a large notebook takes longer than drawing.
  target.size ??= { width: figure.clientWidth, height: figure.clientHeight };
  const width = Math.max(120, target.size.width);
  const height = Math.max(60, target.size.height);
  if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
    canvas.style.width = `${width}px`;
    canvas.style.height = `${height}px`;
  }
  target.context.setTransform(ratio, 0, 0, ratio, 0, 0);
  target.context.clearRect(0, 0, width, height);
  return { width, height };
}

/** Put below what a picture shows that which seldom changes: painted once for each key, since letters are slow. */
export function underlay(target, key, paint) {
  const { canvas, context } = target;
  const whole = JSON.stringify([key, canvas.width, canvas.height]);
  if (target.paintedFor !== whole) {
    target.paintedFor = whole;
    target.below ??= document.createElement("canvas");
    target.below.width = canvas.width;
    target.below.height = canvas.height;
    const pen = target.below.getContext("2d");
    pen.setTransform(context.getTransform());
    pen.lineWidth = 1;
    paint(pen);
  }
  context.save();
  context.resetTransform();
  context.drawImage(target.below, 0, 0);
  context.restore();
}

/** Say what a picture shows now. */
export function describe(target, text) {
  const whole = `${target.label}: ${text}`;
  if (target.canvas.getAttribute("aria-label") !== whole) target.canvas.setAttribute("aria-label", whole);
}

/** The colours of the theme that the element is shown in. */
export function themeOf(element) {
  const style = getComputedStyle(element);
  const colour = (name) => style.getPropertyValue(`--lab-${name}`).trim();
  return {
    ink: colour("ink"),
    muted: colour("muted"),
    line: colour("line"),
    grid: colour("grid"),
    paper: colour("paper"),
    sample: colour("sample"),
    warning: colour("warning"),
    kept: colour("kept"),
    lines: DASHES.map((_, k) => colour(`line-${k}`)),
    font: `11px ${colour("font") || "sans-serif"}`,
  };
}
