// Runs a printed kernel on the arrays given on standard input and prints what it leaves.
import { readFileSync } from "node:fs";

const { source, inputs, varying, size, count } = JSON.parse(readFileSync(0, "utf8"));
const run = new Function(`${source}; return run;`)();
const arrays = inputs.map((values) => Float64Array.from(values, (v) => (v === null ? NaN : v)));
const states = new Float64Array(size * count).fill(NaN);
const resets = new Float64Array(count);
const diverged = run(...arrays, varying, states, resets);
process.stdout.write(JSON.stringify({ states: [...states], resets: [...resets], diverged }));
