// Lighthouse's marks for accessibility: node lighthouse.mjs NODE_MODULES CHROMIUM FOLDER PAGE... prints a line a page.

import { join } from "node:path";
import { pathToFileURL } from "node:url";

const [modules, executablePath, folder, ...pages] = process.argv.slice(2);
const from = (path) => import(pathToFileURL(join(modules, path)));
const { snapshot } = await from("lighthouse/core/index.js");
const { default: whole } = await from("lighthouse/core/config/default-config.js");
const { launch } = await from("puppeteer-core/lib/esm/puppeteer/puppeteer-core.js");

const ALL_DRAWN = () =>
  [...document.querySelectorAll("[data-percept-obs]")].length === (window.perceptObsLabs?.size ?? 0) &&
  [...(window.perceptObsLabs ?? [])].every((lab) => lab.shown && lab.settled !== false && !lab.pending);

// The rest of Lighthouse left out, for each page it would be read, checked and translated anew.
const CONFIG = {
  settings: { ...whole.settings, formFactor: "desktop", screenEmulation: { disabled: true }, disableFullPageScreenshot: true },
  artifacts: whole.artifacts.filter(({ id }) => id === "Accessibility"),
  audits: whole.audits.filter((audit) => audit.startsWith("accessibility/")),
  groups: whole.groups,
  categories: { accessibility: whole.categories.accessibility },
};

const browser = await launch({ executablePath, args: ["--no-sandbox", "--disable-gpu"] });
try {
  const page = await browser.newPage();
  await page.setViewport({ width: 1280, height: 800 });
  for (const name of pages) {
    await page.goto(pathToFileURL(join(folder, name)).href);
    await page.waitForFunction(ALL_DRAWN, { timeout: 120_000 });
    const { lhr } = await snapshot(page, { config: CONFIG, flags: { logLevel: "silent" } });
    const { score, auditRefs } = lhr.categories.accessibility;
    const short = auditRefs.filter(({ id, weight }) => weight && lhr.audits[id].score === 0).map(({ id }) => id);
    console.log(JSON.stringify({ page: name, mark: Math.round(100 * (score ?? 0)), short }));
  }
} finally {
  await browser.close();
}
