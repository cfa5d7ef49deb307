// What the page tells: the calls behind each action, lost connections wherever something waits, and what is on paper.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync, writeFileSync, mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { check, excused, go, json, opened, pictured, planned, serious, address, caseId, plan, HEAD } from "./tools.mjs";

const drawer = (page) => page.getByRole("button", { name: "Calls to the service" }).click();
/** The lines of the calls to a path, the last one first. */
const lines = (page, path) => page.locator("#calls code", { hasText: path });

/** Runs a line of the page as a person does, in a folder with its files; what the service answers. */
function run(line, files = {}) {
  const folder = mkdtempSync(join(tmpdir(), "facies-call-"));
  try {
    for (const [name, content] of Object.entries(files)) writeFileSync(join(folder, name), content);
    return JSON.parse(execFileSync("bash", ["-c", line], { cwd: folder, encoding: "utf8" }));
  } finally {
    rmSync(folder, { recursive: true });
  }
}

/** Refuses what the pattern names as a lost connection does, until `back`. */
async function lost(page, pattern, method) {
  const cut = (route) => (method === undefined || route.request().method() === method ? route.abort("internetdisconnected") : route.fallback());
  await page.route(pattern, cut);
  return () => page.unroute(pattern, cut);
}

export async function told(page, job) {
  await check("each call is copied as curl, which does the same", async () => {
    await page.context().grantPermissions(["clipboard-read", "clipboard-write"]);
    await go(page, `#/job/${job}`);
    await page.getByRole("heading", { name: "Before and after" }).waitFor();
    await drawer(page);
    const line = lines(page, `/v1/jobs/${job}'`).last();
    await line.locator("xpath=..").getByRole("button", { name: "Copy as curl" }).click();
    await page.getByRole("button", { name: "Copied" }).waitFor();
    const copied = await page.evaluate(() => navigator.clipboard.readText());
    assert.equal(copied, await line.textContent());
    assert.deepEqual(run(copied), await json(`/v1/jobs/${job}`));
    // Read by keys too: the line is reached, chosen as a whole, and seen as a whole.
    await line.focus();
    assert.equal(await page.evaluate(() => getSelection().toString().replaceAll(/\s+/g, " ")), copied.replaceAll(/\s+/g, " "));
    assert.deepEqual(await serious(page), []);
    await pictured(page, "calls");
    await drawer(page);
  });

  await check("an upload and the case that is made of it are calls as well", async () => {
    const files = Object.fromEntries(["case.json", "face.vtu", "mandible.vtp", "maxilla.vtp"].map((name) => [name, readFileSync(HEAD + name)]));
    await go(page, "#/jobs");
    await go(page, "#/cases");
    await page.locator("input[data-files]").setInputFiles(Object.keys(files).map((name) => HEAD + name));
    await page.getByRole("heading", { name: "What the check found" }).waitFor();
    await drawer(page);
    const made = await lines(page, "/v1/cases'").first().textContent();
    assert.match(made, /segments/, "the document of the case is in it");
    assert.equal(run(made, files).case.segments.length, 2);
    await drawer(page);
    await go(page, "#/cases");
    await page.locator("input[data-files]").setInputFiles([`${HEAD}face.vtu`]);
    await page.getByLabel("mandible").waitFor();
    await drawer(page);
    const posted = await lines(page, "/v1/meshes?").first().textContent();
    assert.match(posted, /^curl -sS -H 'Content-Type: application\/octet-stream' --data-binary '@face\.vtu' /);
    assert(run(posted, files).report.node_sets.mandible > 0);
    await drawer(page);
  });

  await check("where the browser lets no page copy, the page says so and the line is there", async () => {
    const plain = await opened();
    await plain.addInitScript(() => { Object.defineProperty(Navigator.prototype, "clipboard", { value: undefined }); });
    await plain.goto(`${address}/#/cases`);
    await plain.getByRole("link", { name: "half head" }).first().waitFor();
    await drawer(plain);
    await plain.getByText("the browser lets no page copy").waitFor();
    assert.equal(await plain.getByRole("button", { name: "Copy as curl" }).count(), 0);
    assert.match(await lines(plain, "/v1/cases").first().textContent(), /^curl /);
    await plain.context().close();
  });

  await check("a connection that is lost while jobs are looked at is told, and the list goes on by itself", async () => {
    excused.push(/ERR_INTERNET_DISCONNECTED/);
    const waits = { id: "waits-here", kind: "predict", status: "running", message: "", progress: 10, created: "2026-01-01T00:00:00Z", updated: "", warnings: [], tags: [] };
    const listed = (route) => route.fulfill({ json: { items: [waits] } });
    await page.route("**/v1/jobs?limit=*", listed);
    await go(page, "#/jobs");
    await page.locator("tr", { hasText: "running" }).waitFor();
    // Cancelling does not fail in silence.
    let back = await lost(page, "**/v1/jobs/waits-here", "DELETE");
    await page.getByRole("button", { name: "Cancel" }).click();
    await page.getByRole("alert").getByText("No connection.").waitFor();
    await back();
    await go(page, "#/cases");
    await go(page, "#/jobs");
    await page.locator("tr", { hasText: "running" }).waitFor();
    assert.equal(await page.getByRole("alert").count(), 0);
    back = await lost(page, "**/v1/jobs?limit=*");
    await page.getByRole("alert").getByText("No connection.").waitFor();
    await back();
    await page.getByRole("alert").waitFor({ state: "detached" });
    await page.unroute("**/v1/jobs?limit=*", listed);
  });

  await check("a file that does not come says why", async () => {
    await go(page, `#/job/${job}`);
    const back = await lost(page, `**/v1/jobs/${job}/results/skin.vtp`);
    await go(page, "#/jobs");
    await back();
    await go(page, `#/job/${job}`);
    const file = page.getByRole("button", { name: "skin.vtp" });
    await file.waitFor();
    const again = await lost(page, `**/v1/jobs/${job}/results/skin.vtp`);
    await file.click();
    await page.getByRole("alert").getByText("No connection.").waitFor();
    await again();
    const [download] = await Promise.all([page.waitForEvent("download"), file.click()]);
    assert.equal(download.suggestedFilename(), "skin.vtp");
    await page.getByRole("alert").waitFor({ state: "detached" });
  });

  await check("on paper the page is light, with the colours of its legend and the head", async () => {
    const dark = await opened(undefined, { colorScheme: "dark" });
    await go(dark, `${plan}?p=mandible,-6,0,0,3,0,0&map=displacement&view=1`);
    await planned(dark);
    const ground = () => dark.evaluate(() => getComputedStyle(document.body).backgroundColor);
    const onScreen = await ground();
    await dark.emulateMedia({ media: "print", colorScheme: "dark" });
    assert.notEqual(await ground(), onScreen);
    assert.equal(await ground(), "rgb(243, 244, 246)");
    await dark.getByLabel("Appearance").evaluate((select) => { select.value = "dark"; select.dispatchEvent(new Event("change")); });
    assert.equal(await ground(), "rgb(243, 244, 246)", "also where dark was chosen");
    const kept = await dark.locator(".legend .bands span").first().evaluate((one) => getComputedStyle(one).printColorAdjust);
    assert.equal(kept, "exact");
    await dark.context().close();
  });
}
