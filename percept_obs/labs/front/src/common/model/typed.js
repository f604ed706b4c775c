// @ts-check
// Motions that somebody typed: Python read them, and printed each as a function of time and of the numbers that a lab sets.

/** The function that a typed motion is, as a module of functions; nothing of settings without one. */
export function typedModule({ written }, text) {
  if (!text?.trim()) return [];
  const answer = written?.[text];
  if (!answer?.source) {
    const why = answer?.refusal ?? "only Python reads what is typed, and it has not: run the cell again";
    return [{ key: `motion ${text}`, texts: {}, refusal: `The motion "${text}" cannot be shown: ${why}` }];
  }
  return [{ key: `motion ${text}`, texts: { typed: answer.source } }];
}

/** Rows of a typed motion at some times, with room behind each for more numbers. */
export function typedRows(typed, numbers, times, width = numbers.length) {
  const rows = new Float64Array(width * times.length);
  const x = Float64Array.of(0, ...numbers);
  const out = new Float64Array(numbers.length);
  for (let k = 0; k < times.length; k++) {
    x[0] = times[k];
    rows.set(typed(x, out), k * width);
  }
  return rows;
}

/** Whether settings have a motion that is typed. */
export function isTyped({ motion }) {
  return motion.trim() !== "";
}
