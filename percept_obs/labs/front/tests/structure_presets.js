// Prints the settings of every act of every preset of the structure lab, from the standard settings on standard input.
import { readFileSync } from "node:fs";
import { settingsAfter } from "../src/common/model/settings.js";
import { PRESETS } from "../src/structure/model/presets.js";

const standard = JSON.parse(readFileSync(0, "utf8"));
const acts = PRESETS.map(({ name, acts }) => [name, acts.map((act) => settingsAfter(act, standard))]);
process.stdout.write(JSON.stringify(Object.fromEntries(acts)));
