// @ts-check
// Observers on a recording: the same numbers as track() in Python.

import { columnOf } from "./derived.js";
import { settlingTime } from "./errors.js";
import { Memory } from "./memory.js";
import { arriving, EACH, held, instants, lastSamples, spansOf } from "./tables.js";

/** Base class of the engines that run observers. */
export class Runner {
  constructor(model) {
    this.model = model;
    this.memory = new Memory();
    this.order = Object.keys(model.observers);
    this.room = (part, length) => this.memory.room(part, length);
  }

  /**
   * The relative error of what is sought, as the view's relative_error() in Python; each lab seeks something else.
   *
   * @returns {Float64Array}
   */
  relativeError(_result, _estimate) {
    throw new Error("a lab says what its verdicts judge");
  }

  /** The signal without noise at the instants of a grid's steps, a column each. */
  exact(settings, grid, functions) {
    const make = (read) => /** @type {any} */ (this).camera.exact(read, functions, instants(grid));
    return this.memory.once("exact", settings, make, grid);
  }

  /** Inputs of all observers of a run: steps, held outputs, samples as they arrive, known numbers. */
  layOut({ time, outputs, measured, sampled, tolerance }, lines, known, hold, exact, own) {
    const { grid, index } = lines;
    const columns = measured.map((c) => columnOf(outputs, sampled, c));
    const room = (part) => (length) => this.room(part, length);
    const samples = arriving(columns, index, grid.length, room("arriving"));
    if (own) samples.fill(NaN, 0, columns.length); // a sample that is the start corrects nothing
    return {
      ...lines,
      of: [outputs, measured, lines, known, hold, exact?.[0], own, tolerance],
      columns,
      last: columns.map((values, m) => lastSamples(values, room(`last ${m}`))),
      held: held(columns, time, grid, index, hold, exact, room("held")),
      arriving: samples,
      own,
      known,
    };
  }

  /** The runs of all observers; a run is made anew where its inputs or its own gains have changed. */
  followAll(settings, result, inputs, kernelOf, functions, asked) {
    return settings.observers.map((name) => {
      const kernel = kernelOf(name);
      const follow = ({ gains }) =>
        this.follow(name, gains[name], result, inputs, kernel, functions.observers[name], asked);
      return this.kept(name, settings, follow, ...inputs.of, kernel, ...asked);
    });
  }

  kept(name, settings, make, ...inputs) {
    return this.memory.once(`run of ${name}`, settings, make, ...inputs);
  }

  /**
   * One observer's run: estimates, resets, gaps, errors.
   *
   * @returns {import("../types.js").ObserverRun}
   */
  follow(name, chosen, result, inputs, kernel, functions, asked) {
    const { width, time, truth } = result;
    const { grid, known: table } = inputs;
    const gains = Float64Array.from(kernel.gains, (gain) => chosen[gain]);
    const states = this.room(`states of ${name}`, grid.length * kernel.states);
    const resets = this.room("resets", grid.length).fill(0);
    const start = startState(inputs, kernel, functions, gains, asked);
    const { steps, held: outputs, arriving: samples } = inputs;
    const diverged = functions.run(start, steps, outputs, table.rows, samples, gains, table.varying, states, resets);
    if (diverged >= 0) states.fill(NaN, diverged * kernel.states);
    const estimate = new Float64Array(time.length * width);
    const lacking = this.room("lacking", time.length).fill(0);
    readEstimates(functions, kernel, states, inputs, gains, result, estimate, lacking);
    const error = truth && this.relativeError(result, estimate);
    return {
      name,
      title: this.model.observers[name].title,
      order: this.order.indexOf(name),
      estimate,
      deviation: functions.variances ? readDeviations(functions, kernel, states, inputs, width) : null,
      resets: grid.filter((_, k) => resets[k]),
      gaps: spansOf(time.length, (k) => lacking[k]).map(({ first, last, key }) => [time[first], time[last], key]),
      gapReasons: kernel.gapReasons,
      divergedAt: diverged < 0 ? null : grid[diverged],
      error,
      settling: error && settlingTime(time, (k) => error[k], result.tolerance),
    };
  }
}

/** Rows of values of a printed function of columns and known numbers; `rowOf` says in which row these stand. */
export function evaluated(evaluate, columns, { rows, width, varying }, size, rowOf = (k) => k) {
  const outputs = columns.length;
  const found = new Float64Array(size * columns[0].length);
  const [x, out] = [new Float64Array(outputs + width), new Float64Array(size)];
  x.set(rows.subarray(0, width), outputs);
  for (let k = 0; k < columns[0].length; k++) {
    for (let m = 0; m < outputs; m++) x[m] = columns[m][k];
    const row = varying ? rowOf(k) * width : 0;
    if (varying) for (let p = 0; p < width; p++) x[outputs + p] = rows[row + p];
    evaluate(x, out);
    for (let i = 0; i < size; i++) found[k * size + i] = out[i];
  }
  return found;
}

/**
 * The state at the first sample, from it, from what is known there, from the estimates that are asked for, and from
 * whether those of the outputs are the sample itself.
 */
function startState({ columns, known: table, own }, kernel, functions, gains, asked) {
  const parameters = table.rows.subarray(0, table.width);
  const [first, given] = [columns.map((values) => values[0]), columns.map(() => (own ? 1 : 0))];
  return functions.start([...first, ...parameters, ...gains, ...asked, ...given], new Float64Array(kernel.states));
}

/** A function that fills in what the estimate at a sample follows from: outputs, what is known, gains, the state. */
function argumentsAt({ index, last, known: table }, kernel, states, gains, x) {
  const before = last.length + table.width + gains.length;
  x.set(table.rows.subarray(0, table.width), last.length);
  x.set(gains, last.length + table.width);
  return (k) => {
    const at = index[k] * kernel.states;
    for (let s = 0; s < kernel.states; s++) x[before + s] = states[at + s];
    for (let m = 0; m < last.length; m++) x[m] = last[m][k];
    if (!table.varying) return;
    const row = EACH * index[k] * table.width;
    for (let p = 0; p < table.width; p++) x[last.length + p] = table.rows[row + p];
  };
}

/** Fill in the estimates at the samples; none of the hidden coordinates in a gap, which `lacking` numbers from 1 on. */
function readEstimates(functions, kernel, states, inputs, gains, { width, time, measured, hidden }, estimate, lacking) {
  const { index, last, columns, known: table } = inputs;
  const before = last.length + table.width + gains.length;
  const after = before + kernel.states;
  const x = new Float64Array(after + 1 + last.length);
  const out = new Float64Array(width);
  const which = new Float64Array(1);
  const fill = argumentsAt(inputs, kernel, states, gains, x);
  for (let k = 0; k < index.length; k++) {
    fill(k);
    functions.estimate(x, out);
    for (let c = 0; c < width; c++) estimate[k * width + c] = out[c];
    if (!functions.gap) continue;
    // The innovation of the first sample counts for all that follow.
    if (k === 0) measured.forEach((c, m) => (x[after + 1 + m] = columns[m][0] - out[c]));
    x[after] = time[k] - time[0];
    lacking[k] = functions.gap(x, which)[0];
    if (lacking[k]) for (const c of hidden) estimate[k * width + c] = NaN;
  }
}

/** The standard deviations that are claimed at the samples. */
function readDeviations(functions, kernel, states, { index }, width) {
  const deviation = new Float64Array(index.length * width);
  const x = new Float64Array(kernel.states);
  const out = new Float64Array(width);
  for (let k = 0; k < index.length; k++) {
    for (let s = 0; s < kernel.states; s++) x[s] = states[index[k] * kernel.states + s];
    functions.variances(x, out);
    for (let c = 0; c < width; c++) deviation[k * width + c] = Math.sqrt(Math.max(0, out[c]));
  }
  return deviation;
}
