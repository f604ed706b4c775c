// Judges lines of sheets as the page does, as standard input asks: prints each one's verdict, refusal and mathematics.
import { readFileSync } from "node:fs";
import { answerTo } from "../src/labs/desk/model/answers.js";
import { grownOf } from "../src/labs/desk/model/arrows.js";
import { Sheet } from "../src/labs/desk/model/sheet.js";
import { modelOf } from "../src/state/texts.js";

const { texts, lines = [], settings = [], grown = [], own = {} } = JSON.parse(readFileSync(0, "utf8"));
const { markup, sheets, said } = await modelOf(Buffer.from(texts, "base64"), {});
const made = new Map();

function sheetOf(name) {
  if (!made.has(name)) made.set(name, new Sheet(own[name] ?? sheets[name], markup.letters, said));
  return made.get(name);
}

const judged = lines.map(([name, row, text]) => {
  const sheet = sheetOf(name);
  const began = performance.now();
  const { tree } = sheet.entry(row, text);
  const line = sheet.judged(row, text);
  const pieces = sheet.pieces(tree, line?.wrong);
  return { mark: line?.mark ?? "", read: Boolean(tree), lacks: line?.lacks ?? 0, pieces, took: performance.now() - began };
});
const answers = settings.map(([name, each]) => answerTo(sheetOf(name), each, true));
const misses = grown.map(([name, row, text, point]) => grownOf(sheetOf(name), row, text, point).map(({ miss }) => miss));
process.stdout.write(JSON.stringify({ judged, answers, misses }));
