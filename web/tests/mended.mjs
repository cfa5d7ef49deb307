// What a person who had never seen the page stumbled over, each as it is now: words, signs, outlines, roles, names, progress.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { check, ended, fits, go, json, pictured, planned, serious, HEAD, address, caseId, plan, excused } from "./tools.mjs";

const sign = (page, name) => page.locator(".trust", { hasText: name }).first().locator(".sign").textContent();
/** Shares of the skin's pixels in the middle of the view, drawn now. */
const pixels = (page) => page.evaluate(() => {
  const { scene } = document.querySelector(".screen");
  const drawn = scene.drawNow();
  const copy = Object.assign(document.createElement("canvas"), { width: drawn.width, height: drawn.height });
  const pen = copy.getContext("2d");
  pen.drawImage(drawn, 0, 0);
  const [across, down] = [drawn.width / 2 - 40, drawn.height / 2 - 40].map(Math.round);
  return [...pen.getImageData(across, down, 80, 80).data];
});

export async function mended(page, job) {
  await check("targets are asked for, and what the bounds forbid is said before anything is solved", async () => {
    await go(page, `#/case/${caseId}/inverse?view=4`);
    await page.getByRole("button", { name: "Find the plan" }).click();
    const asked = page.locator(".warned", { hasText: "There is nothing to find a plan for yet" });
    await asked.waitFor();
    await page.getByLabel("Add a landmark").selectOption("pogonion");
    await asked.waitFor({ state: "detached" });
    await page.getByLabel("pogonion Left mm").fill("8.7");
    await page.getByText("pogonion is to go left 8.70 mm, but no segment may move that way.").waitFor();
    assert.deepEqual(await serious(page), []);
    await pictured(page, "inverse-forbidden");
    await page.getByRole("button", { name: "Allow left ± 9 mm" }).click();
    await page.getByText("is to go left").waitFor({ state: "detached" });
    assert.equal(await page.getByLabel("mandible Left ± mm").inputValue(), "9");
    // Targets and bounds stand in the address.
    assert.match(decodeURIComponent(page.url()), /targets=pogonion,0,0,8\.7&bounds=maxilla,10,10,9,0,0,0;mandible,10,10,9,0,0,0/);
    await page.reload();
    await page.getByLabel("pogonion Left mm").waitFor();
    assert.deepEqual([await page.getByLabel("pogonion Left mm").inputValue(), await page.getByLabel("mandible Left ± mm").inputValue()], ["8.7", "9"]);
    await page.getByLabel("pogonion Left mm").fill("12");
    await page.getByRole("button", { name: "Leave left free" }).click();
    assert.equal(await page.getByLabel("pogonion Left mm").inputValue(), "");
  });

  await check("what was found backwards is in the words of sliders, by the names of targets, and a missed one is heeded", async () => {
    await page.getByLabel("pogonion Forward mm").fill("9.5");
    await page.getByLabel("mandible Forward ± mm").fill("3");
    await page.getByLabel("maxilla Forward ± mm").fill("3");
    await page.getByRole("button", { name: "Find the plan" }).click();
    await page.getByRole("heading", { name: "What was found" }).waitFor();
    const told = await page.locator("section", { has: page.getByRole("heading", { name: "What was found" }) }).textContent();
    assert.match(told, /mandible forward, mm3\.00stopped by its bound/);
    assert.match(told, /pogonion\d/);
    assert.doesNotMatch(told, /translation|rotation_deg|Target 1|\(1\)/);
    assert.equal(await sign(page, "Targets"), "!");
    assert.match(await page.locator(".caption").textContent(), /mandible forward 3 mm/);
    await pictured(page, "found");
  });

  await check("a line of the strip is never good where its warning stands", async () => {
    await go(page, `#/job/${job}`);
    await page.getByRole("heading", { name: "Before and after" }).waitFor();
    const codes = await page.locator(".warnings .code").allTextContents();
    assert(codes.includes("large-rotation"), codes.join());
    assert.equal(await sign(page, "Error of the model"), "!");
    const { results } = await json(`/v1/jobs/${job}`);
    assert.equal(await sign(page, "Error of the mesh"), results.numerical_error_mm.mean > 0.1 ? "!" : "✓");
    // Adding the error does not make it smaller than what is accepted.
    const view = await json(`/v1/jobs/${job}`);
    view.results.numerical_error_mm = { ...view.results.numerical_error_mm, corrected: true, mean: 0.11 };
    await page.route(`**/v1/jobs/${job}`, (route) => route.fulfill({ json: view }));
    await go(page, "#/jobs");
    await go(page, `#/job/${job}`);
    await page.getByRole("heading", { name: "Before and after" }).waitFor();
    assert.equal(await sign(page, "Error of the mesh"), "!");
    await page.unroute(`**/v1/jobs/${job}`);
  });

  await check("the skin laid over leaves the colours of a map as they are, and is seen beside it", async () => {
    await go(page, `#/job/${job}?map=displacement&view=3`);
    await page.getByRole("heading", { name: "Before and after" }).waitFor();
    const alone = await pixels(page);
    const whole = await page.evaluate(() => document.querySelector(".screen").scene.drawNow().toDataURL());
    await page.getByText("overlaid").click();
    const over = await pixels(page);
    const changed = alone.filter((value, at) => Math.abs(value - over[at]) > 2).length / alone.length;
    assert(changed < 0.05, `${(100 * changed).toFixed(1)} % of the middle of the map changed`);
    assert.notEqual(await page.evaluate(() => document.querySelector(".screen").scene.drawNow().toDataURL()), whole, "the outline is there");
    await pictured(page, "overlaid");
    await page.getByText("one", { exact: true }).click();
  });

  await check("jobs are told apart by what they move and by the ends of their ids", async () => {
    await go(page, "#/jobs");
    const row = page.locator("tr", { hasText: `…${job.slice(-6)}` });
    for (const moved of ["maxilla forward 4 mm", "mandible back 6 mm, up 2 mm"]) await row.getByText(moved).waitFor();
    await fits(page);
    await pictured(page, "jobs-named");
    await go(page, `#/case/${caseId}/compare`);
    await page.locator("option", { hasText: `…${job.slice(-6)}` }).first().waitFor({ state: "attached" });
    assert.match(await page.locator("option", { hasText: `…${job.slice(-6)}` }).textContent(), /^Prediction · .*maxilla forward 4 mm/);
  });

  await check("rows of a study say scene, plan, material, level and mean; a sweep its values", async () => {
    const { id } = await ended({ kind: "study", scenes: ["slab"], plans: ["patch 4 mm"], methods: ["fem_linear"], levels: [0], sweep: { "*": { young_modulus_kpa: [10, 20] } } });
    await go(page, "#/studies");
    const card = page.locator(".cards li", { hasText: `…${id.slice(-6)}` });
    await card.getByText("slab · ").waitFor();
    await card.getByRole("button", { name: "Chart" }).click();
    const { rows } = await json(`/v1/jobs/${id}/report`);
    const shown = page.locator("table", { has: page.locator("caption", { hasText: "Rows" }) });
    await shown.locator("tbody tr").first().waitFor();
    assert.deepEqual(await shown.locator("thead th").allTextContents(), ["Variant", "Scene", "Plan", "Material", "Mesh level", "mean mm", "p95 mm", "s", "State"]);
    const cells = await shown.locator("tbody tr").evaluateAll((all) => all.map((one) => [...one.children].map((cell) => cell.textContent)));
    assert.deepEqual(cells.map(([label, scene, on, material, level]) => [label, scene, on, material, Number(level)]), rows.map((one) => [one.label, one.scene, one.plan, one.material, one.level]));
    assert(rows.some(({ material }) => /10/.test(material)) && rows.some(({ material }) => /20/.test(material)), rows.map(({ material }) => material).join());
    await pictured(page, "study-rows");
  });

  await check("a mesh alone has no frame until somebody says so, and each set is named once", async () => {
    await go(page, "#/cases");
    await page.locator("input[data-files]").setInputFiles([`${HEAD}face.vtu`]);
    await page.getByLabel("mandible").waitFor();
    const document = JSON.parse(await page.getByLabel("Case document").inputValue());
    const asked = page.getByText("Which way do the axes of this mesh point?");
    assert.equal(await asked.isVisible(), document.frame === "unspecified");
    await page.getByLabel("Frame").selectOption("unspecified");
    assert(await asked.isVisible());
    await page.getByLabel("Frame").selectOption("LPS");
    assert(!await asked.isVisible());
    const names = await page.locator(".drop .plans li").evaluateAll((all) => all.map((one) => one.innerText));
    assert(names.length > 2);
    const seen = await page.locator(".drop .plans .field > span").evaluateAll((all) => all.every((one) => one.className === "hidden"));
    assert(seen, "the name of a choice is for those who do not see the one before it");
    await pictured(page, "upload-roles");
  });

  await check("dropped surfaces are the skin and bones, and the document has the tissue between them meshed", async () => {
    // The view of before has the same address, and stays where it is asked for again.
    await go(page, "#/jobs");
    await go(page, "#/cases");
    const skin = Buffer.from(await (await fetch(`${address}/v1/jobs/${job}/results/skin.vtp`)).arrayBuffer());
    const files = [["face_skin.vtp", skin], ...["mandible.vtp", "maxilla.vtp"].map((name) => [name, readFileSync(HEAD + name)])];
    await page.locator(".drop").evaluate((drop, parts) => {
      const dataTransfer = new DataTransfer();
      for (const [name, content] of parts) dataTransfer.items.add(new File([Uint8Array.from(atob(content), (letter) => letter.charCodeAt(0))], name));
      drop.dispatchEvent(new DragEvent("drop", { dataTransfer, bubbles: true }));
    }, files.map(([name, content]) => [name, content.toString("base64")]));
    const text = page.getByLabel("Case document");
    await text.waitFor();
    await page.getByLabel("Frame").selectOption("LPS");
    const bones = ["mandible", "maxilla"].map((name) => ({ name, mesh: name }));
    assert.deepEqual(JSON.parse(await text.inputValue()).meshing, { kind: "mesh", frame: "LPS", surfaces: { skin: "face_skin", bones } });
    await page.getByLabel("face_skin").selectOption("bone");
    await page.getByText("One surface has to be the skin").waitFor();
    assert(await page.getByRole("button", { name: "Send" }).isDisabled());
    await page.getByLabel("face_skin").selectOption("skin");
    assert.deepEqual(await serious(page), []);
    await fits(page);
    await pictured(page, "upload-surfaces");
    await page.getByRole("button", { name: "Send" }).click();
    // Sent as it stands: a case that is being meshed, whose job this skin, which is open, makes fail in words.
    await page.waitForFunction(() => location.hash.startsWith("#/case/"));
    const made = await json(`/v1/cases/${await page.evaluate(() => /case\/([0-9a-f-]+)/.exec(location.hash)[1])}`);
    assert.equal(made.case.meshing.surfaces.bones.length, 2);
    await page.locator("progress, [role=alert], .viewport").first().waitFor();
    // It does not run on behind what is timed later.
    await fetch(`${address}/v1/jobs/${made.meshing.job}`, { method: "DELETE" });
  });

  await check("the calls to the service are seen when they are opened, and progress is told in words", async () => {
    // The job that waits is one of this test: the service does not know it.
    excused.push(/jobs\/waiting\/events/);
    await go(page, `${plan}?view=1`);
    await planned(page);
    await page.getByRole("button", { name: "Calls to the service" }).click();
    await page.waitForFunction(() => {
      const { top, height } = document.querySelector("#calls").getBoundingClientRect();
      return height > 0 && top < innerHeight && top >= -height;
    });
    await page.getByRole("button", { name: "Calls to the service" }).click();
    const { job: waited } = { job: { id: "waiting", kind: "predict", status: "running", message: "", progress: 90, phase: "solve", iteration: 5, residual: 8.8e-2, created: "2026-01-01T00:00:00Z", updated: "", warnings: [], tags: [] } };
    await page.route("**/v1/jobs/waiting", (route) => route.fulfill({ json: waited }));
    await page.route("**/v1/jobs/waiting/events", () => {});
    await page.evaluate(() => { location.hash = "#/job/waiting"; });
    await page.getByText("Solving · step 5", { exact: true }).waitFor();
    assert.equal(await page.locator("progress").getAttribute("value"), null);
    await page.unroute("**/v1/jobs/waiting");
    await page.unroute("**/v1/jobs/waiting/events");
  });
}
