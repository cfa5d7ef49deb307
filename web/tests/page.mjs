// The page as people use it, in headless Chromium, on the demo of the built program.
import assert from "node:assert/strict";
import { readFile, mkdir, writeFile } from "node:fs/promises";
import { createRequire } from "node:module";
import { join } from "node:path";
import { fileURLToPath } from "node:url";
import { chromium } from "playwright-core";
import { demo, guarded } from "./service.mjs";

const BINARY = process.env.FACIES_BINARY;
const CHROMIUM = process.env.FACIES_CHROMIUM ?? "/usr/bin/chromium";
const PICTURES = process.env.FACIES_PICTURES;
const KEY = "a-key-of-this-one-run";
const AXE = await readFile(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
const HEAD = fileURLToPath(new URL("../../examples/head/", import.meta.url));
const SOFTWARE = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"];
/** f32 columns and positions in mm. */
const AGREED_MM = 1e-4;
/** For one step, on a machine that does other things too. */
const DEADLINE_MS = 180_000;
const WIDE = { width: 1280, height: 800 };

let [passed, failed] = [0, 0];
async function check(name, deed) {
  try {
    await deed();
    passed += 1;
    console.log(`ok ${name}`);
  } catch (error) {
    failed += 1;
    console.log(`FAILED ${name}\n${error.stack ?? error}`);
  }
}

const service = await demo(BINARY);
const [, address, plan, caseId] = service.match;
const browser = await chromium.launch({ executablePath: CHROMIUM, args: SOFTWARE });
const hosts = new Set();
const complaints = [];

async function opened(size = WIDE, options = {}) {
  const context = await browser.newContext({ viewport: size, locale: "en-GB", ...options });
  context.setDefaultTimeout(DEADLINE_MS);
  const page = await context.newPage();
  page.on("request", (request) => { if (/^https?:/.test(request.url())) hosts.add(new URL(request.url()).host); });
  page.on("console", (message) => { if (message.type() === "error") complaints.push(`${message.text()} ${message.location().url}`); });
  page.on("pageerror", (error) => complaints.push(String(error)));
  return page;
}
/** A complaint may come later than what it complains about: what a check provokes is told by its words, not by when it came. */
const excused = [/GPU stall/];
/** Until the address says so: it is written after a key or a click, and told to this program later still. */
const addressed = (page, pattern, says = true) => page.waitForFunction(
  ([source, wanted]) => new RegExp(source).test(decodeURIComponent(location.href)) === wanted, [pattern.source, says]);
/** Opens a view, until that of before is gone: where only what is behind the # changes, it may still be there when `goto` is done. */
async function go(page, path) {
  await page.evaluate(() => document.querySelector("#stage")?.setAttribute("data-before", ""));
  await page.goto(`${address}/${path}`);
  await page.locator("#stage:not([data-before])").waitFor({ state: "attached" });
}
/** The processor may be busy elsewhere when the first paint is noted. */
const painted = (page) => page.waitForFunction(() => performance.getEntriesByName("first-contentful-paint")[0]?.startTime)
  .then((time) => time.jsonValue());
const positions = (page) => page.evaluate(() => [...document.querySelector(".screen").scene.skinPositions_mm]);
const planned = async (page) => { await page.locator(".told[data-apart]").waitFor(); };
const apart = (a, b) => a.reduce((most, value, at) => Math.max(most, Math.abs(value - b[at])), 0);
const slider = (page, segment, word) => page.locator("details.segment", { hasText: segment }).locator(`input[type=range][data-word=${word}]`);
async function slide(page, segment, word, value) {
  await slider(page, segment, word).fill(String(value));
  await slider(page, segment, word).dispatchEvent("change");
}
const json = async (path, body) => {
  const answer = await fetch(address + path, body === undefined ? {} : { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(body) });
  assert(answer.ok, `${path}: ${answer.status}`);
  return answer.json();
};
async function serious(page) {
  await page.evaluate(AXE);
  const { violations } = await page.evaluate(() => window.axe.run());
  return violations.filter(({ impact }) => impact === "serious" || impact === "critical")
    .map(({ id, nodes }) => `${id}: ${nodes.slice(0, 3).map(({ html }) => html).join(" | ")}`);
}
async function pictured(page, name) {
  if (PICTURES === undefined) return;
  await mkdir(PICTURES, { recursive: true });
  await page.screenshot({ path: join(PICTURES, `${name}.png`) });
}

const page = await opened();
await check("the first thing is the list of cases, and what the program is not", async () => {
  await page.goto(address);
  await page.getByRole("link", { name: "half head" }).waitFor();
  assert.equal(await page.locator("#notice").textContent(), "Research software, not a medical device");
  assert.deepEqual(await serious(page), []);
  console.log(`   first paint after ${(await painted(page)).toFixed(0)} ms`);
  await pictured(page, "cases");
});

// The response of the demo's case, which takes long where much else is compiled.
let response = await json("/v1/jobs", { kind: "response", case: caseId });
while (response.status === "accepted" || response.status === "running") {
  response = await (await fetch(`${address}/v1/jobs/${response.id}`, { headers: { Prefer: "wait=30" } })).json();
}

let rest;
await check("the demo's case opens with its skin, and the face looks at the viewer", async () => {
  await go(page, `${plan}?view=1`);
  await planned(page);
  rest = await positions(page);
  assert.equal(rest.length, 3 * 2695);
  const box = await page.locator(".screen canvas").boundingBox();
  const hit = (across, down) => page.evaluate(([x, y]) =>
    document.querySelector(".screen").scene.pick(new MouseEvent("click", { clientX: x, clientY: y })), [box.x + across * box.width, box.y + down * box.height]);
  const [middle, right] = [await hit(0.5, 0.5), await hit(0.58, 0.5)];
  assert(middle.point_mm[1] < -80, `LPS: the front has small y, ${middle.point_mm}`);
  assert(right.point_mm[0] > 10, `the patient's left is on the right, ${right.point_mm}`);
});

await check("a slider moves the skin as the service does, to 1e-4 mm", async () => {
  await slide(page, "mandible", "forward", -6);
  await slide(page, "mandible", "pitch", 3);
  await slide(page, "maxilla", "up", 2);
  const moved = await positions(page);
  const { segments } = await json(`/v1/cases/${caseId}/response`);
  const pivot_mm = segments.find(({ name }) => name === "mandible").centre_mm;
  const answer = await json(`/v1/cases/${caseId}/response/apply`, { plan: { frame: "LPS", segments: [
    { name: "mandible", translation_mm: [0, 6, 0], rotation_deg: [-3, 0, 0], pivot_mm }, { name: "maxilla", translation_mm: [0, 0, 2] }] } });
  const difference = apart(answer.displacement_mm.flat(), moved.map((value, at) => value - rest[at]));
  assert(answer.max_mm > 5, "something moves");
  assert(difference < AGREED_MM, `${difference} mm`);
  await page.waitForFunction(() => Number(document.querySelector(".told[data-apart]").dataset.apart) < 1e-4);
  await page.getByText("left out: about").waitFor();
  console.log(`   ${difference.toExponential(1)} mm from the service`);
});

await check("the state is in the address, and what was done is taken back", async () => {
  await addressed(page, /p=maxilla,0,2,0,0,0,0;mandible,-6,0,0,3,0,0/);
  const moved = await positions(page);
  await page.getByRole("button", { name: "Undo" }).click();
  await addressed(page, /p=mandible,-6,0,0,3,0,0/);
  await page.getByRole("button", { name: "Redo" }).click();
  assert(apart(moved, await positions(page)) === 0);
  await page.reload();
  await planned(page);
  assert(apart(moved, await positions(page)) < AGREED_MM);
});

await check("everything works from the keyboard", async () => {
  await page.locator(".screen canvas").focus();
  const direction = () => page.evaluate(() => { const { camera, controls } = document.querySelector(".screen").scene; return camera.position.clone().sub(controls.target).normalize().toArray(); });
  await page.keyboard.press("1");
  assert(apart(await direction(), [0, 0, 1]) < 1e-6);
  await page.keyboard.press("3");
  assert(apart(await direction(), [1, 0, 0]) < 1e-6, "from the patient's left");
  await page.keyboard.press("ArrowLeft");
  assert(apart(await direction(), [1, 0, 0]) > 0.1);
  await slider(page, "mandible", "left").focus();
  await page.keyboard.press("ArrowRight");
  await addressed(page, /mandible,-6,0,0\.1,3/);
  await page.keyboard.press("Control+z");
  await addressed(page, /mandible,-6,0,0\.1,3/, false);
});

await check("colours are those of the legend", async () => {
  await page.keyboard.press("1");
  await page.locator(".tools select").selectOption("displacement");
  await page.locator(".legend").waitFor();
  const swatches = await page.locator(".legend .bands span").evaluateAll((all) => all.map((one) => getComputedStyle(one).backgroundColor.match(/\d+/g).map(Number)));
  assert.equal(swatches.length, 10);
  assert.deepEqual(await page.locator(".legend .ticks span").allTextContents(), ["0", "2", "4", "6", "8", "10"]);
  const seen = await page.evaluate(() => {
    const { scene } = document.querySelector(".screen");
    const { canvas } = scene;
    const box = canvas.getBoundingClientRect();
    const copy = Object.assign(document.createElement("canvas"), { width: canvas.width, height: canvas.height });
    const pen = copy.getContext("2d");
    pen.drawImage(scene.drawNow(), 0, 0);
    const values = scene.skin.geometry.attributes.uv.array;
    const found = [];
    for (let down = 0.3; down < 0.9; down += 0.02) {
      const place = { clientX: box.left + box.width / 2, clientY: box.top + down * box.height };
      const hit = scene.pick(new MouseEvent("click", place));
      if (hit === undefined) continue;
      const pixel = pen.getImageData((canvas.width / 2) | 0, (down * canvas.height) | 0, 1, 1).data;
      found.push({ share: values[2 * hit.node], pixel: [...pixel].slice(0, 3) });
    }
    return found;
  });
  // Shade changes how light a colour is, not which it is: shares of red, green and blue.
  const hue = (rgb) => rgb.map((value) => value / (rgb[0] + rgb[1] + rgb[2]));
  const nearest = ({ pixel }) => swatches.map((swatch, at) => [apart(hue(swatch), hue(pixel)), at]).sort((a, b) => a[0] - b[0])[0][1];
  const off = seen.filter((one) => Math.abs(nearest(one) - Math.floor(10 * one.share)) > 1);
  assert(seen.length > 15 && off.length <= seen.length / 10, JSON.stringify(off));
  assert(seen.some(({ share }) => share > 0.4) && seen.some(({ share }) => share < 0.1));
});

await check("a slider's frame is short", async () => {
  await page.evaluate(() => performance.clearMeasures());
  for (let step = 0; step < 40; step += 1) await slider(page, "mandible", "yaw").fill(String(step / 10));
  const took = await page.evaluate(() => performance.getEntriesByName("slider", "measure").map(({ duration }) => duration).sort((a, b) => a - b));
  console.log(`   script of a slider's frame: median ${took[took.length >> 1].toFixed(1)} ms, longest ${took.at(-1).toFixed(1)} ms, ${took.length} frames, ${rest.length / 3} nodes`);
  // The machine does other things too: what it does in most of a second's steps is not what the script takes.
  assert(took.length === 40 && took[took.length >> 2] < 16);
});

await check("a plan is saved, compared and removed", async () => {
  await page.getByRole("button", { name: "Save plan" }).click();
  const saved = page.locator(".plans li").first();
  await saved.getByRole("button", { name: "Compare" }).click();
  await page.getByText("Against this plan: mean 0.00 mm").waitFor();
  assert.equal((await json(`/v1/cases/${caseId}/plans`)).items.length, 1);
  await saved.getByRole("button", { name: /Remove/ }).click();
  await page.getByText("No plans yet.").waitFor();
});

await check("planning has no serious fault of access", async () => {
  assert.deepEqual(await serious(page), []);
  await pictured(page, "plan");
});

let job;
await check("a prediction is run, and shown before and after", async () => {
  await go(page, `${plan}?p=maxilla,4,0,0,0,0,0;mandible,-6,2,0,0,0,0`);
  await planned(page);
  await page.locator("section", { hasText: "Predict in full" }).locator("select").selectOption("fem_linear");
  await page.getByRole("button", { name: "Predict in full" }).click();
  await page.getByRole("heading", { name: "Before and after" }).waitFor();
  job = await page.evaluate(() => /job\/([0-9a-f-]+)/.exec(location.hash)[1]);
  const after = await positions(page);
  await page.getByRole("button", { name: "Before", exact: true }).click();
  assert(apart(await positions(page), rest) < 1e-3, "before is the skin at rest");
  await page.getByRole("button", { name: "After", exact: true }).click();
  assert(apart(await positions(page), after) < AGREED_MM);
  const { results } = await json(`/v1/jobs/${job}`);
  const shown = await page.locator("table", { hasText: "whole skin" }).locator("tr", { hasText: "chin" }).locator("td").first().textContent();
  assert.equal(shown, results.statistics.regions.chin.area.mean.toFixed(2));
  const back = await page.locator("table", { hasText: "Landmark" }).locator("tr", { hasText: "pogonion" }).locator("td").first().textContent();
  assert.equal(back, (-results.statistics.landmarks.pogonion[1]).toFixed(2));
  await page.getByText("large-rotation").waitFor();
  assert.deepEqual(await serious(page), []);
});

await check("the probe says how far a point moves", async () => {
  await page.keyboard.press("1");
  const box = await page.locator(".screen canvas").boundingBox();
  await page.mouse.click(box.x + box.width / 2, box.y + 0.72 * box.height);
  await page.getByText(/Point \d+ moves by \d+\.\d\d mm/).waitFor();
  await page.locator(".tools select").selectOption("displacement");
  await pictured(page, "result");
});

await check("a picture is saved with its legend and what it is not", async () => {
  const [download] = await Promise.all([page.waitForEvent("download"), page.getByRole("button", { name: "Save picture" }).click()]);
  const content = await readFile(await download.path());
  assert.equal(content.subarray(1, 4).toString(), "PNG");
  assert(content.length > 20_000);
  if (PICTURES !== undefined) await writeFile(join(PICTURES, "saved.png"), content);
});

await check("each call may be copied as curl", async () => {
  await page.getByRole("button", { name: "Calls to the service" }).click();
  const curl = await page.locator("#calls code", { hasText: `GET /v1/jobs/${job}` }).last().getAttribute("title");
  assert(curl.startsWith("curl -sS") && curl.includes(`'${address}/v1/jobs/${job}`), curl);
  await page.getByRole("button", { name: "Calls to the service" }).click();
});

await check("inverse planning finds the movement that brings the chin where it is wanted", async () => {
  await go(page, `#/case/${caseId}/inverse?view=3`);
  await page.getByLabel("Add a landmark").selectOption("pogonion");
  await page.getByLabel("pogonion Forward mm").fill("3");
  await page.getByLabel("pogonion Up mm").fill("1");
  assert.deepEqual(await serious(page), []);
  await pictured(page, "inverse");
  await page.getByRole("button", { name: "Find the plan" }).click();
  await page.getByRole("heading", { name: "What was found" }).waitFor();
  const pogonion = page.locator("table", { hasText: "Landmark" }).locator("tr", { hasText: "pogonion" }).locator("td");
  const [forward, up] = await pogonion.allTextContents();
  assert(Math.abs(forward - 3) < 0.1 && Math.abs(up - 1) < 0.1, `${forward} ${up}`);
  await page.getByRole("link", { name: "Open as plan" }).click();
  await planned(page);
  assert(Number(await slider(page, "mandible", "forward").inputValue()) > 2);
});

await check("a point of the skin is pulled to where it should be", async () => {
  await go(page, `#/case/${caseId}/inverse?view=3`);
  await page.getByText("Pull", { exact: true }).click();
  const box = await page.locator(".screen canvas").boundingBox();
  const at = await page.evaluate(() => {
    const { scene } = document.querySelector(".screen");
    const frame = scene.canvas.getBoundingClientRect();
    for (let across = frame.left; across < frame.right; across += 3) {
      const hit = scene.pick(new MouseEvent("click", { clientX: across, clientY: frame.top + 0.735 * frame.height }));
      if (hit !== undefined) return across;
    }
  });
  await page.mouse.move(at + 4, box.y + 0.735 * box.height);
  await page.mouse.down();
  await page.mouse.move(at - 30, box.y + 0.735 * box.height, { steps: 4 });
  await page.mouse.up();
  const forward = await page.locator(".target input").first().inputValue();
  assert(Number(forward) > 1, `seen from the left the front is on the left: ${forward}`);
});

await check("a predicted skin is compared with a real one", async () => {
  await go(page, `#/case/${caseId}/compare?job=${job}`);
  const skin = Buffer.from(await (await fetch(`${address}/v1/jobs/${job}/results/skin.vtp`)).arrayBuffer());
  await page.getByLabel("Real skin").setInputFiles({ name: "skin.vtp", mimeType: "application/xml", buffer: skin });
  await page.getByRole("button", { name: "Compare" }).click();
  const row = page.locator("table", { hasText: "< 1 mm" }).locator("tr", { hasText: "whole skin" }).locator("td");
  await row.first().waitFor();
  const [mean, , , within] = await row.allTextContents();
  assert.deepEqual([mean, within], ["0.00", "100.0 %"]);
  await addressed(page, /comparison=/);
  assert.deepEqual(await serious(page), []);
  await pictured(page, "comparison");
});

await check("files that are no mesh are refused in words", async () => {
  await go(page, `#/cases`);
  excused.push(/the server responded with a status of 4\d\d .*\/v1\/meshes/);
  await page.locator("input[data-files]").setInputFiles({ name: "broken.vtu", mimeType: "text/plain", buffer: Buffer.from("no mesh at all") });
  const alert = page.getByRole("alert");
  await alert.waitFor();
  assert.match(await alert.textContent(), /Refused\. .{10,}/);
  assert.match(await alert.locator("a").getAttribute("href"), /^\/errors#[a-z-]+$/);
});

await check("a mesh alone becomes a case by saying what its sets are", async () => {
  await page.locator("input[data-files]").setInputFiles([`${HEAD}face.vtu`]);
  await page.getByLabel("mandible").selectOption("segment");
  const text = await page.getByLabel("Case document").inputValue();
  const { segments, fixed, skin } = JSON.parse(text);
  assert(segments.some(({ name }) => name === "mandible") && fixed.length > 0 && skin.node_set === "skin", text);
  assert.deepEqual(await serious(page), []);
  await page.getByRole("button", { name: "Send" }).click();
  await page.getByRole("heading", { name: "What the check found" }).waitFor();
  await page.getByText("6,912").first().waitFor();
});

await check("a case document with its files becomes a case", async () => {
  await go(page, `#/cases`);
  await page.locator("input[data-files]").setInputFiles(["case.json", "face.vtu", "mandible.vtp", "maxilla.vtp"].map((name) => HEAD + name));
  await page.getByRole("heading", { name: "What the check found" }).waitFor();
  await page.getByRole("button", { name: "What holds it" }).click();
  await page.getByRole("img", { name: /Drawn by the service/ }).waitFor();
  assert.deepEqual(await serious(page), []);
  await pictured(page, "case");
});

await check("a case without a response gets one when it is planned on", async () => {
  await page.getByRole("link", { name: "Plan a movement" }).click();
  await planned(page);
  await slide(page, "mandible", "forward", 4);
  await page.locator(".told", { hasText: /The skin moves [1-4]\.\d\d mm at most/ }).waitFor();
});

await check("jobs are listed, and studies", async () => {
  await go(page, `#/jobs`);
  await page.getByRole("link", { name: "optimise" }).waitFor();
  assert.deepEqual(await serious(page), []);
  await pictured(page, "jobs");
  await page.getByRole("link", { name: "Studies" }).click();
  await page.getByText("No studies yet.").waitFor();
});

await check("a job is cancelled", async () => {
  const study = await json("/v1/jobs", { kind: "study", scenes: ["slab"], plans: ["patch 4 mm"], methods: ["fem_linear", "fem_nonlinear"], levels: [0, 1], truth: { refine: 1 }, repeats: 9 });
  await go(page, `#/job/${study.id}`);
  await page.getByRole("button", { name: "Cancel" }).click();
  await page.getByText("It was cancelled.").waitFor();
});

await check("a lost connection is told, and taken up again", async () => {
  await go(page, `#/cases`);
  await page.getByRole("link", { name: "half head" }).waitFor();
  excused.push(/ERR_INTERNET_DISCONNECTED/);
  await page.context().setOffline(true);
  await page.getByRole("link", { name: "Jobs" }).click();
  await page.getByRole("alert").getByText("No connection.").waitFor();
  await page.context().setOffline(false);
  await page.getByRole("button", { name: "Try again" }).click();
  await page.getByRole("heading", { name: "Jobs" }).waitFor();
});

await check("German and dark, and at 390 pixels nothing is cut off", async () => {
  const small = await opened({ width: 390, height: 844 }, { locale: "de-DE", colorScheme: "dark", reducedMotion: "reduce" });
  await go(small, `${plan}?p=mandible,-4,0,0,0,0,0&view=1`);
  await small.getByRole("button", { name: "Ganz vorhersagen" }).waitFor();
  await planned(small);
  assert.equal(await small.locator("html").getAttribute("lang"), "de");
  assert.equal(await small.evaluate(() => document.documentElement.scrollWidth), 390);
  assert.deepEqual(await serious(small), []);
  await pictured(small, "plan-390-dark-german");
  await go(small, `#/job/${job}?map=displacement&view=1`);
  await small.getByRole("heading", { name: "Vorher und nachher" }).waitFor();
  assert.equal(await small.evaluate(() => document.documentElement.scrollWidth), 390);
  await pictured(small, "result-390-dark-german");
  await small.context().close();
});

await check("where keys are asked for the page asks, and keeps the key for the tab only", async () => {
  const closed = await guarded(BINARY, KEY);
  excused.push(/the server responded with a status of 401/);
  const guest = await opened();
  await guest.goto(closed.match[1]);
  await guest.getByRole("heading", { name: "This service asks for a key" }).waitFor();
  assert.deepEqual(await serious(guest), []);
  await guest.getByLabel("Key").fill("another-key-altogether");
  await guest.getByRole("button", { name: "Go on" }).click();
  await guest.getByLabel("Key").fill(KEY);
  await guest.getByRole("button", { name: "Go on" }).click();
  await guest.getByText("No cases yet.").waitFor();
  const kept = await guest.evaluate(() => ({ tab: sessionStorage.getItem("facies-key"), ever: localStorage.length, cookies: document.cookie }));
  assert.deepEqual(kept, { tab: KEY, ever: 0, cookies: "" });
  assert.deepEqual(await guest.context().cookies(), []);
  const other = await opened();
  await other.goto(closed.match[1]);
  await other.getByRole("heading", { name: "This service asks for a key" }).waitFor();
  await guest.context().close();
  await other.context().close();
  await closed.stop();
});

await check("nothing was asked of another host", () => {
  const others = [...hosts].filter((host) => !host.startsWith("127.0.0.1:"));
  assert.deepEqual(others, []);
});
await check("the browser had nothing to complain about", () => assert.deepEqual(complaints.filter((text) => !excused.some((pattern) => pattern.test(text))), []));

await browser.close();
await service.stop();
console.log(`${passed} passed, ${failed} failed`);
process.exitCode = failed === 0 ? 0 : 1;
