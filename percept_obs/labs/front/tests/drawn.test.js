// Every lab draws and says what it did when it was last looked at, whatever a hand does: to a fiftieth of a pixel.

import assert from "node:assert/strict";
import { test } from "node:test";
import { kept, marksOf } from "./drawn.js";
import { LABS } from "./scenes.js";

for (const name of Object.keys(LABS)) {
  test(`${name} draws and says what it did`, async () => {
    const [before, now] = [kept()[name], await marksOf(name)];
    const changed = Object.keys({ ...before, ...now }).filter((scene) => before[scene] !== now[scene]);
    assert.deepEqual(changed, [], "look at these scenes; if they are right, npm run record");
  });
}
