// What the tests of the page share: a service with its demo, a browser, and ways to use the page.
import assert from "node:assert/strict";
import { mkdir, readFile } from "node:fs/promises";
import { createRequire } from "node:module";
import { join } from "node:path";
import { fileURLToPath } from "node:url";
import { chromium } from "playwright-core";
import { demo } from "./service.mjs";

export const BINARY = process.env.FACIES_BINARY;
export const CHROMIUM = process.env.FACIES_CHROMIUM ?? "/usr/bin/chromium";
export const PICTURES = process.env.FACIES_PICTURES;
/** A folder with a page that was built since the program was, which is served in the place of that within it. */
const PAGE = process.env.FACIES_PAGE;
export const KEY = "a-key-of-this-one-run";
export const AXE = await readFile(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
export const HEAD = fileURLToPath(new URL("../../examples/head/", import.meta.url));
/** As on a machine without a graphics card: the head is drawn by SwiftShader, the page around it by the processor. With `--use-angle=swiftshader`
 * SwiftShader would draw the page as well, at 20 ms of processor time a frame. */
export const SOFTWARE = ["--no-sandbox", "--enable-unsafe-swiftshader"];
/** f32 columns and positions in mm. */
export const AGREED_MM = 1e-4;
/** For one step, on a machine that does other things too. */
export const DEADLINE_MS = 180_000;
export const WIDE = { width: 1280, height: 800 };

export const counted = { passed: 0, failed: 0 };
export async function check(name, deed) {
  try {
    await deed();
    counted.passed += 1;
    console.log(`ok ${name}`);
  } catch (error) {
    counted.failed += 1;
    console.log(`FAILED ${name}\n${error.stack ?? error}`);
  }
}

export const service = await demo(BINARY);
export const [, address, plan, caseId] = service.match;
export const browser = await chromium.launch({ executablePath: CHROMIUM, args: SOFTWARE });
export const hosts = new Set();
export const complaints = [];

const TYPES = { html: "text/html", js: "text/javascript", css: "text/css", svg: "image/svg+xml" };
/** With the headers of the program, above all its Content Security Policy. */
async function fresh(route) {
  const { pathname } = new URL(route.request().url());
  const file = pathname === "/" ? "index.html" : pathname.slice(1);
  // The page may have gone meanwhile.
  const response = await route.fetch().catch(() => undefined);
  if (response === undefined) return;
  await route.fulfill({ response, status: 200, contentType: TYPES[file.split(".").at(-1)], body: await readFile(join(PAGE, file)) });
}

export async function opened(size = WIDE, options = {}) {
  const context = await browser.newContext({ viewport: size, locale: "en-GB", ...options });
  context.setDefaultTimeout(DEADLINE_MS);
  if (PAGE !== undefined) await context.route(({ pathname }) => pathname === "/" || pathname.startsWith("/assets/"), fresh);
  const page = await context.newPage();
  page.on("request", (request) => { if (/^https?:/.test(request.url())) hosts.add(new URL(request.url()).host); });
  page.on("console", (message) => { if (message.type() === "error") complaints.push(`${message.text()} ${message.location().url}`); });
  page.on("pageerror", (error) => complaints.push(String(error)));
  return page;
}
/** A complaint may come later than what it complains about: what a check provokes is told by its words, not by when it came. */
export const excused = [/GPU stall/];
/** Until the address says so: it is written after a key or a click, and told to this program later still. */
export const addressed = (page, pattern, says = true) => page.waitForFunction(
  ([source, wanted]) => new RegExp(source).test(decodeURIComponent(location.href)) === wanted, [pattern.source, says]);
/** Opens a view, until that of before is gone: where only what is behind the # changes, it may still be there when `goto` is done. */
export async function go(page, path) {
  await page.evaluate(() => document.querySelector("#stage")?.setAttribute("data-before", ""));
  await page.goto(`${address}/${path}`);
  await page.locator("#stage:not([data-before])").waitFor({ state: "attached" });
}
/** The processor may be busy elsewhere when the first paint is noted. */
export const painted = (page) => page.waitForFunction(() => performance.getEntriesByName("first-contentful-paint")[0]?.startTime)
  .then((time) => time.jsonValue());
export const positions = (page) => page.evaluate(() => [...document.querySelector(".screen").scene.skinPositions_mm]);
export const planned = async (page) => { await page.locator(".strip[data-apart]").waitFor(); };
export const apart = (a, b) => a.reduce((most, value, at) => Math.max(most, Math.abs(value - b[at])), 0);
export const slider = (page, segment, word) => page.locator("details.segment", { hasText: segment }).locator(`input[type=range][data-word=${word}]`);
export async function slide(page, segment, word, value) {
  await slider(page, segment, word).fill(String(value));
  await slider(page, segment, word).dispatchEvent("change");
}
export const json = async (path, body) => {
  const answer = await fetch(address + path, body === undefined ? {} : { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(body) });
  assert(answer.ok, `${path}: ${answer.status}`);
  return answer.json();
};
/** The last state of a job. */
export async function ended(spec) {
  let job = await json("/v1/jobs", spec);
  while (job.status === "accepted" || job.status === "running") {
    job = await (await fetch(`${address}/v1/jobs/${job.id}`, { headers: { Prefer: "wait=30" } })).json();
  }
  return job;
}
export async function serious(page) {
  await page.evaluate(AXE);
  const { violations } = await page.evaluate(() => window.axe.run({ rules: { "label-content-name-mismatch": { enabled: true } } }));
  return violations.filter(({ impact }) => impact === "serious" || impact === "critical")
    .map(({ id, nodes }) => `${id}: ${nodes.slice(0, 3).map(({ html }) => html).join(" | ")}`);
}
/** No view is wider than the window: nobody scrolls sideways. */
export async function fits(page) {
  const [is, most] = await page.evaluate(() => [document.scrollingElement.scrollWidth, document.documentElement.clientWidth]);
  assert(is <= most, `${page.url()}: ${is} px wide in a window of ${most} px`);
}
export async function pictured(page, name) {
  if (PICTURES === undefined) return;
  await mkdir(PICTURES, { recursive: true });
  await page.screenshot({ path: join(PICTURES, `${name}.png`) });
}
