// Puts settings into addresses and back, and has labs follow addresses, as standard input asks; prints what came of it.
import { readFileSync } from "node:fs";
import { Address } from "../src/ui/address.js";
import { ObserverLab } from "../src/labs/observer/lab.js";
import { PointsLab } from "../src/labs/points/lab.js";
import { StructureLab } from "../src/labs/structure/lab.js";
import { loadHere } from "./load_here.js";

const LABS = { observer: ObserverLab, points: PointsLab, structure: StructureLab };
const place = { hash: "", href: "" };
Object.assign(globalThis, { window: { location: place, addEventListener() {} } });

/** What a lab makes of an address, without its page. */
async function followed(name, model, hash) {
  const Lab = LABS[name];
  const lab = Object.create(Lab.prototype);
  const said = { notice: "", visited: null };
  const view = { notice: (text) => (said.notice = text), root: { scrollIntoView() {} } };
  const visit = (settings, view) => Object.assign(said, { visited: settings, view });
  const fail = (error) => (said.failed = error.message);
  Object.assign(lab, {
    model,
    state: { settings: model.opening, view: model.view.standard },
    kernels: new Lab.computing.Kernels(model, loadHere),
    view,
    visit,
    fail,
  });
  place.hash = hash;
  await new Address(lab, { name, names: [name] }).follow();
  return said;
}

const { models, settings, addresses } = JSON.parse(readFileSync(0, "utf8"));
const round = ([name, each, looked]) => {
  const address = Object.create(Address.prototype);
  address.lab = { model: models[name] };
  const view = { ...models[name].view.standard, ...looked };
  const text = address.text(each, view);
  const back = address.read(text);
  return { text, back: back.settings, view, seen: back.view };
};
const answer = { rounds: settings.map(round), followed: [] };
for (const [name, hash] of addresses) answer.followed.push(await followed(name, models[name], hash));
answer.polluted = Object.keys(Object.prototype).concat(({}).polluted ?? []);
process.stdout.write(JSON.stringify(answer));
