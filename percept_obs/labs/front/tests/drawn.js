// A short mark of each scene of the labs, as it was found right by eye.  After a change that is meant, look at the
// pages, and write the marks anew:   npm run record [FOLDER]   A folder takes the scenes themselves, to compare.

import { createHash } from "node:crypto";
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { LABS, scenesOf } from "./scenes.js";

const FILE = new URL("drawn.json", import.meta.url);

const nothing = () => {};

/** Marks of the scenes of a lab by their names; `look` is shown each of them, and `marked` told each mark. */
export async function marksOf(name, { look = nothing, marked = nothing } = {}) {
  const marks = {};
  for await (const [scene, lines] of scenesOf(name)) {
    const text = lines.join("\n");
    look(scene, text);
    if (scene in marks) throw new Error(`there are two scenes "${scene}" of ${name}`);
    marks[scene] = createHash("sha256").update(text).digest("hex").slice(0, 8);
    marked(scene, marks[scene]);
  }
  return marks;
}

export const kept = () => JSON.parse(readFileSync(FILE, "utf8"));

if (process.argv[1].endsWith("drawn.js")) {
  const [folder] = process.argv.slice(2);
  const all = {};
  for (const name of Object.keys(LABS)) {
    const place = folder && `${folder}/${name}`;
    if (place) mkdirSync(place, { recursive: true });
    all[name] = await marksOf(name, {
      look: (scene, text) => place && writeFileSync(`${place}/${scene.replaceAll("/", "-").slice(0, 80)}`, text),
    });
  }
  writeFileSync(FILE, `{\n${Object.entries(all).map(([name, marks]) => `"${name}": ${JSON.stringify(marks)}`).join(",\n")}\n}\n`);
}
