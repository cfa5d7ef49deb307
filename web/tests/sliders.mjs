// The page with sliders of the clients, as a service hands it out: `web/tests/sliders`.
import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { fileURLToPath } from "node:url";
import { chromium } from "playwright-core";
import { started } from "./service.mjs";

const BLOCK = fileURLToPath(new URL("../../examples/block/", import.meta.url));
const { FACIES_BINARY: binary, FACIES_CHROMIUM: executablePath } = process.env;
/** f32 columns in mm. */
const AGREED_MM = 1e-4;

const args = (folder) => ["serve", "--bind", "127.0.0.1:0", "--data", folder, "--free-space-floor-mib", "0", "--log-level", "error", "--clients-folder", process.argv[2]];
const service = await started(binary, args, /listening on (http:\/\/\S+)/);
const address = service.match[1];
const browser = await chromium.launch({ executablePath, args: ["--no-sandbox", "--enable-unsafe-swiftshader"] });
try {
  const form = new FormData();
  const { case: document } = JSON.parse(await readFile(`${BLOCK}case.json`, "utf8"));
  form.append("case", new Blob([JSON.stringify(document)], { type: "application/json" }));
  for (const name of ["block.vtu", "mandible.stl"]) form.append(name, new Blob([await readFile(BLOCK + name)]), name);
  const posted = await fetch(`${address}/v1/cases`, { method: "POST", body: form });
  assert.equal(posted.status, 201, await posted.clone().text());
  const { id } = await posted.json();

  const page = await browser.newPage();
  const complaints = [];
  page.on("console", (message) => { if (message.type() === "error") complaints.push(message.text()); });
  page.on("pageerror", (error) => complaints.push(String(error)));
  await page.addInitScript(() => {
    const drawn = WebGL2RenderingContext.prototype.bufferSubData;
    WebGL2RenderingContext.prototype.bufferSubData = function (target, at, data) {
      window.shown_mm = [...data];
      return drawn.call(this, target, at, data);
    };
  });
  await page.goto(`${address}/clients/sliders.html?case=${id}`);
  await page.getByRole("button", { name: "Load" }).click();
  const sliders = page.getByRole("group", { name: "mandible" }).locator("input[type=range]");
  await sliders.first().waitFor({ timeout: 180_000 });
  assert.equal(await sliders.count(), 6);
  for (const [at, value] of [[0, "3"], [2, "-1.5"], [4, "4"]]) {
    await sliders.nth(at).fill(value);
    await sliders.nth(at).dispatchEvent("change");
  }
  await page.locator("#estimate", { hasText: "Estimated linearisation error: about" }).waitFor();
  const shown_mm = await page.evaluate(() => window.shown_mm);
  const plan = JSON.parse(await page.locator("#plan").inputValue());
  const answer = await fetch(`${address}/v1/cases/${id}/response/apply`,
    { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify({ plan }) });
  assert.equal(answer.status, 200, await answer.clone().text());
  const { displacement_mm, max_mm, nonlinearity_estimate_mm } = await answer.json();
  const applied_mm = displacement_mm.flat();
  assert.equal(shown_mm.length, applied_mm.length);
  const difference = shown_mm.reduce((most, value, at) => Math.max(most, Math.abs(value - applied_mm[at])), 0);
  assert(max_mm > 2, `the skin moves ${max_mm} mm`);
  assert(difference < AGREED_MM, `${difference} mm`);
  const said = await page.locator("#estimate").textContent();
  assert(said.includes(`about ${nonlinearity_estimate_mm.toFixed(2)} mm`), said);
  assert.deepEqual(complaints.filter((text) => !/GPU stall/.test(text)), []);
  console.log(`ok three sliders move ${shown_mm.length / 3} points by ${max_mm.toFixed(2)} mm at most, ${difference.toExponential(1)} mm from the service`);
} finally {
  await browser.close();
  await service.stop();
}
