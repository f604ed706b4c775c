// Prints the settings of each act of the presets of the lab of many points, from the standard settings given as input.
import { readFileSync } from "node:fs";
import { PRESETS, settingsOf } from "../src/points/model/presets.js";

const standard = JSON.parse(readFileSync(0, "utf8"));
const acts = PRESETS.map(({ name, acts }) => [name, acts.map((act) => settingsOf(act, standard))]);
process.stdout.write(JSON.stringify(Object.fromEntries(acts)));
