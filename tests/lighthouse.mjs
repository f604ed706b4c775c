// Lighthouse's marks for accessibility: node lighthouse.mjs NODE_MODULES CHROMIUM FOLDER PAGE... prints a line a page.

import { readFile } from "node:fs/promises";
import { createServer } from "node:http";
import { extname, join } from "node:path";
import { pathToFileURL } from "node:url";

const [modules, chromePath, folder, ...pages] = process.argv.slice(2);
const from = (path) => import(pathToFileURL(join(modules, path)));
const { default: lighthouse } = await from("lighthouse/core/index.js");
const { launch } = await from("chrome-launcher/dist/index.js");

const KINDS = { ".html": "text/html", ".js": "text/javascript", ".css": "text/css", ".svg": "image/svg+xml" };
const server = createServer(async ({ url }, answer) => {
  const path = decodeURIComponent(new URL(url, "http://site").pathname);
  try {
    const body = await readFile(join(folder, path));
    answer.writeHead(200, { "Content-Type": KINDS[extname(path)] ?? "application/octet-stream" }).end(body);
  } catch {
    answer.writeHead(404).end();
  }
});
await new Promise((listening) => server.listen(0, "127.0.0.1", listening));
const chrome = await launch({ chromePath, chromeFlags: ["--headless=new", "--no-sandbox", "--disable-gpu"] });
try {
  for (const page of pages) {
    const { lhr } = await lighthouse(`http://127.0.0.1:${server.address().port}/${page}`, {
      port: chrome.port,
      logLevel: "silent",
      onlyCategories: ["accessibility"],
      formFactor: "desktop",
      screenEmulation: { mobile: false, width: 1280, height: 800, deviceScaleFactor: 1, disabled: false },
      throttlingMethod: "provided",
      disableFullPageScreenshot: true,
      // What is drawn late is waited for by other tests; here nothing is timed.
      ...{ pauseAfterFcpMs: 0, pauseAfterLoadMs: 500, networkQuietThresholdMs: 0, cpuQuietThresholdMs: 0 },
    });
    const { score, auditRefs } = lhr.categories.accessibility;
    const short = auditRefs.filter(({ id, weight }) => weight && lhr.audits[id].score === 0).map(({ id }) => id);
    console.log(JSON.stringify({ page, mark: Math.round(100 * (score ?? 0)), short }));
  }
} finally {
  chrome.kill();
  server.close();
}
