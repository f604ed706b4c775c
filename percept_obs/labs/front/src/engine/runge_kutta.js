// @ts-check
// The Runge-Kutta method for the loops that are written by hand here; integrator.js has its numbers.

import { COUPLING, PLACES, WEIGHTS } from "./integrator.js";
import { EACH } from "./tables.js";

/**
 * A function that moves a state of so many numbers by a step: step(state, length, rate).
 * rate(instant, stage, out) fills the rates of the state `stage` at one of the step's instants.
 */
export function stepper(size) {
  const rates = WEIGHTS.map(() => new Float64Array(size));
  const stage = new Float64Array(size);
  const move = (target, length, shares) => {
    for (let j = 0; j < shares.length; j++) {
      if (!shares[j]) continue;
      const part = length * shares[j];
      const along = rates[j];
      for (let i = 0; i < size; i++) target[i] += part * along[i];
    }
  };
  return (state, length, rate) => {
    for (let j = 0; j < WEIGHTS.length; j++) {
      stage.set(state);
      move(stage, length, COUPLING[j]);
      rate(PLACES[j], stage, rates[j]);
    }
    move(state, length, WEIGHTS);
  };
}

/**
 * A function that moves a state of so many numbers along some of a grid's steps: along(state, steps, from, to).
 * rate(row, stage, out) fills the rates of a stage, where what is known at its instant stands from `row` on.
 */
export function alongSteps(size, { width, varying }, rate) {
  const step = stepper(size);
  let at = 0;
  const look = (instant, stage, out) => rate(varying ? (EACH * at + instant) * width : 0, stage, out);
  return (state, steps, from, to) => {
    for (at = from; at < to; at++) step(state, steps[at], look);
  };
}
