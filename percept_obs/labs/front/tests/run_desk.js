// Judges lines of sheets as the page does, as standard input asks: prints each one's verdict, refusal and mathematics.
import { readFileSync } from "node:fs";
import { answerTo, judgedIn, Sheet } from "../src/labs/desk/model/answers.js";
import { modelOf } from "../src/state/texts.js";

const { texts, lines = [], settings = [], own = {} } = JSON.parse(readFileSync(0, "utf8"));
const { reader, sheets, said } = await modelOf(Buffer.from(texts, "base64"), {});
const made = new Map();

function sheetOf(name) {
  if (!made.has(name)) made.set(name, new Sheet(own[name] ?? sheets[name], reader, said));
  return made.get(name);
}

const judged = lines.map(([name, row, text]) => {
  const sheet = sheetOf(name);
  const { markup, refusal = "", position = 0 } = sheet.entry(row, text);
  const [line] = judgedIn(sheet, [row], new Map([[row, text]]));
  return { mark: line?.mark ?? "", refusal, position, markup };
});
const answers = settings.map(([name, each]) => answerTo(sheetOf(name), each));
process.stdout.write(JSON.stringify({ judged, answers }));
