// Prints the settings of every act of every preset of a lab; its folder and standard settings come as input.
import { readFileSync } from "node:fs";
import { settingsOf } from "../src/common/model/settings.js";

const { lab, standard } = JSON.parse(readFileSync(0, "utf8"));
const { PRESETS } = await import(`../src/${lab}/model/presets.js`);
const acts = PRESETS.map(({ name, acts }) => [name, acts.map((act) => settingsOf(act, standard))]);
process.stdout.write(JSON.stringify(Object.fromEntries(acts)));
