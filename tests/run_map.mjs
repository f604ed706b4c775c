// Computes a map of the bound from printed functions on standard input, and prints it with how long it took.
import { readFileSync } from "node:fs";
import { boundMap } from "../percept_obs/labs/front/src/observer/model/bound_map.js";

const { sources, given } = JSON.parse(readFileSync(0, "utf8"));
const kernel = Object.fromEntries(
  Object.entries(sources).map(([name, text]) => [name, new Function(`${text}; return evaluate;`)()]),
);
boundMap(kernel, given);
const begin = process.cpuUsage().user;
const found = boundMap(kernel, given);
const seconds = (process.cpuUsage().user - begin) / 1e6;
process.stdout.write(JSON.stringify({ found: [...found].map((v) => (Number.isNaN(v) ? null : v)), seconds }));
