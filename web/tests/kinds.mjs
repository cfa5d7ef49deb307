// Results of kinds beside predictions: what was learned, cohorts, operations, templates; stress; sets that are painted.
import assert from "node:assert/strict";
import { check, ended, fits, go, json, pictured, serious, address, caseId } from "./tools.mjs";

const predicted = (y, more = {}) => ended({ kind: "predict", case: caseId, plan: { segments: [{ name: "mandible", translation_mm: [0, y, 0] }] }, method: "fem_linear", ...more });
const cells = (page, caption) => page.locator("table", { has: page.locator("caption", { hasText: caption }) }).locator("tbody tr");
/** The rows of a table by their names. */
async function rows(page, caption) {
  await cells(page, caption).first().waitFor();
  return Object.fromEntries(await cells(page, caption).evaluateAll((all) =>
    all.map((row) => [row.querySelector("th").textContent, [...row.querySelectorAll("td")].map((cell) => cell.textContent)])));
}

/** A surface as the service writes it, and one of ours for it. */
async function surface(id) {
  const content = Buffer.from(await (await fetch(`${address}/v1/meshes/${id}/content?format=ply`)).arrayBuffer());
  const head = content.subarray(0, content.indexOf("end_header\n") + 11).toString("latin1");
  const [vertices, faces] = ["vertex", "face"].map((name) => Number(new RegExp(`element ${name} (\\d+)`).exec(head)[1]));
  const sizes = { float: 4, double: 8, int: 4 };
  const types = [...head.matchAll(/^property (\w+) \w+$/gm)].map(([, type]) => sizes[type]);
  const stride = types.reduce((sum, size) => sum + size, 0);
  const number = (at) => (types[0] === 8 ? content.readDoubleLE(at) : content.readFloatLE(at));
  const points = Array.from({ length: vertices }, (_, node) => [0, 1, 2].map((axis) => number(head.length + node * stride + axis * types[0])));
  const triangles = Array.from({ length: faces }, (_, face) => [0, 1, 2].map((corner) => content.readInt32LE(head.length + vertices * stride + 13 * face + 1 + 4 * corner)));
  return { points, triangles };
}
async function uploaded(...parts) {
  const points = parts.flatMap((part) => part.points);
  const firsts = parts.map((_, at) => parts.slice(0, at).reduce((sum, part) => sum + part.points.length, 0));
  const triangles = parts.flatMap((part, at) => part.triangles.map((corners) => corners.map((node) => node + firsts[at])));
  const text = ["ply", "format ascii 1.0", `element vertex ${points.length}`, "property double x", "property double y", "property double z", `element face ${triangles.length}`,
    "property list uchar int vertex_indices", "end_header", ...points.map((point) => point.join(" ")), ...triangles.map((corners) => `3 ${corners.join(" ")}`), ""].join("\n");
  const answer = await fetch(`${address}/v1/meshes?units=mm&frame=LPS`, { method: "POST", headers: { "Content-Type": "application/octet-stream" }, body: text });
  assert(answer.ok, await answer.clone().text());
  return (await answer.json()).id;
}

export async function kinds(page) {
  await check("what was learned is told by curve, boxes, tables, and on the face", async () => {
    const job = await ended({ kind: "learn", virtual: { patients: 11, seed: 1, fineness: 1 } });
    const { table, helps } = job.results.learning;
    await go(page, `#/job/${job.id}`);
    await page.getByRole("img", { name: "Error by the number of cases" }).waitFor();
    const shown = await rows(page, "Mean error, mm, nested");
    assert.deepEqual(Object.keys(shown), table.map(({ name }) => name));
    assert(table.every(({ name, mean, p95 }) => shown[name][0] === mean.toFixed(2) && shown[name][1] === p95.toFixed(2)));
    // Eleven dots in each row but of what is tuned on all cases and of what is learned from other classes.
    const untuned = table.filter(({ name }) => !name.includes("tuned") && !name.includes("of other classes"));
    assert.equal(await page.getByRole("img", { name: "Error of each case" }).locator("circle").count(), 11 * untuned.length);
    await page.getByText(helps ? "Closer to what happened than mechanics alone." : "Not closer to what happened").first().waitFor();
    // The map is that of the table: its mean over the nodes is the mean over the cases.
    await page.locator(".tools select").selectOption({ label: "Mean error: fem linear GRNN" });
    const values = await page.evaluate(() => [...document.querySelector(".screen").scene.skin.geometry.attributes.uv.array].filter((_, at) => at % 2 === 0));
    const mean = (2 * values.reduce((sum, one) => sum + one, 0)) / values.length;
    assert(Math.abs(mean - table.find(({ name }) => name === "fem_linear + GRNN").mean) < 0.02, `${mean}`);
    assert.deepEqual(await serious(page), []);
    await fits(page);
    await pictured(page, "learned");
  });

  await check("what an operation did is told in words, and opens as a plan", async () => {
    const { bones } = (await json(`/v1/cases/${caseId}`)).case;
    const [upper, lower] = await Promise.all(["maxilla", "mandible"].map((name) => surface(bones.find((bone) => bone.name === name).mesh)));
    const after = { ...lower, points: lower.points.map(([x, y, z]) => [x + 0.5, y - 5, z + 1]) };
    const ends = (of) => [0, 1, 2].map((axis) => of(...upper.points.map((point) => point[axis])));
    const job = await ended({ kind: "reproduce", before: { mesh: await uploaded(upper, lower) }, after: { mesh: await uploaded(upper, after) },
      base: { mask: { box_mm: [...ends(Math.min).map((end) => end - 1), ...ends(Math.max).map((end) => end + 1)] } },
      planned: { segments: [{ name: "mandible", translation_mm: [0, -6, 0] }] },
      segments: [{ name: "mandible", before: { mesh: await uploaded(lower) }, after: { mesh: await uploaded(after) } }] });
    assert.equal(job.status, "successful", JSON.stringify(job.error));
    await go(page, `#/job/${job.id}`);
    assert.deepEqual((await rows(page, "What was performed, mm")).mandible, ["+5.00", "+1.00", "+0.50", "0.00°"]);
    assert.deepEqual((await rows(page, "Beyond what was planned, mm")).mandible.slice(0, 3), ["-1.00", "+1.00", "+0.50"]);
    assert.deepEqual(await serious(page), []);
    await pictured(page, "performed");
    await page.getByLabel("On the case").selectOption(caseId);
    await page.getByRole("link", { name: "Open as plan" }).click();
    const forward = page.locator("details.segment", { hasText: "mandible" }).locator("input[type=number][data-word=forward]");
    await forward.waitFor();
    assert(Math.abs(Number(await forward.inputValue()) - 5) < 0.01);
  });

  let actual;
  await check("a cohort is told by boxes and tests, a study by its report", async () => {
    const groups = { near: [], far: [] };
    for (const y of [2, 4, 6]) {
      const [truth, near, far] = await Promise.all([predicted(y, { keep: ["skin"] }), predicted(0.95 * y), predicted(0.8 * y)]);
      actual = truth.results.kept[0].mesh;
      for (const [name, job] of Object.entries({ near, far })) groups[name].push((await ended({ kind: "compare", prediction: { job: job.id }, actual: { mesh: actual }, align: "none" })).id);
    }
    const job = await ended({ kind: "cohort", groups });
    await go(page, `#/job/${job.id}`);
    const shown = await rows(page, "mean, closest point, mm");
    assert(Number(shown.near[1]) < Number(shown.far[1]), JSON.stringify(shown));
    assert.deepEqual((await rows(page, "Wilcoxon"))["far – near"].slice(1, 3), ["0.25", "0.25"]);
    assert.deepEqual(await serious(page), []);
    await pictured(page, "cohort");
    await ended({ kind: "study", scenes: ["slab"], plans: ["patch 4 mm"], methods: ["fem_linear"], levels: [0] });
    await go(page, "#/studies");
    await page.getByRole("button", { name: "Chart" }).first().click();
    const link = page.getByRole("link", { name: "Read the report" });
    await link.waitFor();
    assert.match(await (await fetch(address + await link.getAttribute("href"))).text(), /<html/);
  });

  await check("marks of a study's chart are pressed by pointer and by keys, and show the rows behind them", async () => {
    const { id } = await ended({ kind: "study", scenes: ["slab"], plans: ["patch 4 mm"], methods: ["fem_linear", "mtm_ti"], levels: [0, 1], sweep: { "*": { young_modulus_kpa: [10, 20] } } });
    const report = await json(`/v1/jobs/${id}/report`);
    const pairs = new Set(report.rows.filter(({ status }) => status === "solved").map(({ label, level }) => `${label}, level ${level}`));
    await go(page, `#/studies?study=${id}`);
    const marks = page.locator(".chart .mark");
    await marks.first().waitFor();
    assert.equal(await marks.count(), pairs.size);
    const shown = () => page.locator("table", { has: page.locator("caption", { hasText: "Rows" }) }).locator("tbody tr").evaluateAll((all) => all.map((row) => [row.children[0].textContent, Number(row.children[4].textContent)]));
    assert.equal((await shown()).length, report.rows.length);
    const first = page.locator('.chart .mark[aria-label*=", level 1: "]').first();
    // Marks may lie over each other: this one is pressed itself.
    await first.dispatchEvent("click");
    const [[called]] = await shown();
    const behind = report.rows.filter(({ label, level }) => label === called && level === 1);
    assert(behind.length > 0 && behind.length < report.rows.length);
    assert.deepEqual(await shown(), behind.map(({ label, level }) => [label, level]));
    await page.getByRole("status").getByText(`${called}, Mesh level 1: ${behind.length} of ${report.rows.length} rows`).waitFor();
    assert.equal(await first.getAttribute("aria-pressed"), "true");
    assert.deepEqual(await serious(page), []);
    await fits(page);
    await pictured(page, "study-mark");
    // By keys alone; the address keeps it.
    await first.focus();
    await page.keyboard.press("Tab");
    const name = await page.evaluate(() => document.activeElement.getAttribute("aria-label"));
    await page.keyboard.press("Enter");
    const [, level] = /, level (\d+): /.exec(name);
    const [[label]] = await shown();
    assert.notDeepEqual([label, level], [called, "1"]);
    assert((await shown()).every(([one, other]) => one === label && other === Number(level)));
    await page.reload();
    await page.locator(".chart [aria-pressed=true]").waitFor();
    assert((await shown()).every(([one, other]) => one === label && other === Number(level)));
    await page.getByRole("button", { name: "All rows" }).click();
    assert.equal((await shown()).length, report.rows.length);
  });

  await check("a template on a patient is shown with what is left", async () => {
    const { volume, landmarks } = (await json(`/v1/cases/${caseId}`)).case;
    const marks = Object.fromEntries(Object.entries(landmarks).slice(0, 4).map(([name, at]) => [name, { template_mm: at, patient_mm: [at[0], at[1] + 0.2, at[2]] }]));
    const job = await ended({ kind: "conform", template: { mesh: volume, skin: "skin", fixed: "skull", held: ["rim"], segments: { mandible: "mandible", maxilla: "maxilla" } }, patient: { skin: actual }, landmarks: marks });
    assert.equal(job.status, "successful", JSON.stringify(job.error));
    const { skin, landmarks_mm } = job.results.conformation;
    await go(page, `#/job/${job.id}`);
    await page.getByRole("button", { name: "Make this case" }).waitFor();
    const left = await rows(page, "What is left, mm");
    assert.equal((await cells(page, "What is left, mm").count()), 1 + Object.keys(landmarks_mm).length);
    assert(left.Skin === undefined || left.Skin[0] === skin.mean_mm.toFixed(2));
    assert(await page.evaluate(() => document.querySelector(".screen").scene.skinPositions_mm.length) > 1000);
    assert.deepEqual(await serious(page), []);
    await pictured(page, "conformed");
  });

  await check("stress and materials of the literature are asked for with a prediction", async () => {
    await go(page, `#/case/${caseId}/plan?p=mandible,4,0,0,0,0,0`);
    await page.getByText("Stress in the tissue too").click();
    await page.getByText("Materials of the literature").click();
    await page.locator("[data-region=fat] select").selectOption("tissue_chabanas_2003");
    await page.locator("[data-region=fat]").getByText("(Chabanas, Luboz").waitFor();
    assert.deepEqual(await serious(page), []);
    await page.locator("section", { has: page.getByRole("button", { name: "Predict in full" }) }).getByRole("combobox").first().selectOption("fem_linear");
    await page.getByRole("button", { name: "Predict in full" }).click();
    await page.getByRole("img", { name: "Mises' stress, kPa" }).waitFor();
    const id = await page.evaluate(() => /job\/([0-9a-f-]+)/.exec(location.hash)[1]);
    const { results } = await json(`/v1/jobs/${id}`);
    assert.equal(results.provenance.presets.fat.material.young_modulus_kpa, 15);
    const shown = await rows(page, "Mises' stress, kPa");
    assert.equal(shown.muscle[0], String(Number(results.stress.regions.muscle.von_mises_kpa.mean.toFixed(2))));
    await page.locator(".tools select").selectOption("stress");
    assert.equal(await page.locator(".legend figcaption").textContent(), "Mises' stress, kPa");
    const most = await page.evaluate(() => document.querySelector(".screen").scene.skin.geometry.attributes.uv.array.reduce((high, value) => Math.max(high, value), 0));
    assert(most > 0.05, `${most}`);
    assert.deepEqual(await serious(page), []);
    await pictured(page, "stress");
  });

  await check("a set is painted, by pointer and by keys, taken back, and is part of a case", async () => {
    await go(page, `#/case/${caseId}?view=1`);
    await page.getByText("Paint a set").click();
    const paint = page.locator("details.paint");
    const told = async () => Number(/^([\d,.]+)/.exec(await paint.locator(".told").textContent())[1].replaceAll(",", ""));
    await paint.getByText("Paint", { exact: true }).click();
    const box = await page.locator(".screen canvas").boundingBox();
    const at = (across, down) => [box.x + across * box.width, box.y + down * box.height];
    const before = await page.evaluate(() => document.querySelector(".screen").scene.camera.position.toArray());
    await page.mouse.move(...at(0.42, 0.55));
    await page.mouse.down();
    await page.mouse.move(...at(0.46, 0.58), { steps: 6 });
    await page.mouse.up();
    const stroke = await told();
    assert(stroke > 10, `${stroke} faces`);
    assert.deepEqual(await page.evaluate(() => document.querySelector(".screen").scene.camera.position.toArray()), before, "a brush does not turn the head");
    await page.locator(".screen canvas").focus();
    await page.keyboard.press("Enter");
    assert(await told() > stroke);
    await page.keyboard.press("Control+z");
    assert.equal(await told(), stroke);
    await paint.getByRole("button", { name: "Add the set to the case" }).click();
    await paint.getByRole("alert").getByText("The set needs a name.").waitFor();
    await paint.getByLabel("Name of the set").fill("right_cheek");
    assert.deepEqual(await serious(page), []);
    await pictured(page, "painted");
    await paint.getByRole("button", { name: "Add the set to the case" }).click();
    await page.locator(".sets li", { hasText: "right_cheek" }).waitFor();
    const here = page.url();
    await page.getByRole("button", { name: "Make a case with these roles" }).click();
    await page.waitForFunction((old) => location.href !== old, here);
    await page.getByText("Point at the mesh to name its sets").waitFor();
    const made = await json(`/v1/cases/${await page.evaluate(() => /case\/([0-9a-f-]+)/.exec(location.hash)[1])}`);
    // Each painted face has three nodes, which it shares with others.
    const nodes = made.check.skin.regions.right_cheek;
    assert(nodes > stroke / 3 && nodes < stroke, `${nodes} nodes of ${stroke} faces`);
  });
}
