// A predicted skin against a real one, landmarks that are dragged, and what is seen as a file.
import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { addressed, apart, check, ended, go, json, pictured, planned, positions, serious, address, caseId, plan, AGREED_MM } from "./tools.mjs";

/** The document of a GLB file, and the numbers of an accessor. */
export function glb(content) {
  assert.equal(content.subarray(0, 4).toString(), "glTF");
  assert.equal(content.readUInt32LE(8), content.length);
  const text = content.readUInt32LE(12);
  const document = JSON.parse(content.subarray(20, 20 + text).toString());
  const binary = 20 + text + 8;
  const numbers = (index) => {
    const { bufferView, count, type, componentType } = document.accessors[index];
    const begin = binary + document.bufferViews[bufferView].byteOffset;
    const read = componentType === 5125 ? (at) => content.readUInt32LE(at) : (at) => content.readFloatLE(at);
    return Array.from({ length: count * { SCALAR: 1, VEC3: 3 }[type] }, (_, at) => read(begin + 4 * at));
  };
  return { document, numbers };
}

async function saved(page) {
  const [download] = await Promise.all([page.waitForEvent("download"), page.getByRole("button", { name: "Save GLB" }).click()]);
  return glb(await readFile(await download.path()));
}

/** The skin that is drawn, moved, as a PLY file. */
export async function moved(page, move) {
  const { points, triangles } = await page.evaluate(() => {
    const { scene } = document.querySelector(".screen");
    return { points: [...scene.skinPositions_mm], triangles: [...scene.resting.triangles] };
  });
  const rows = (numbers) => Array.from({ length: numbers.length / 3 }, (_, at) => numbers.slice(3 * at, 3 * at + 3));
  return Buffer.from(["ply", "format ascii 1.0", `element vertex ${points.length / 3}`, "property double x", "property double y", "property double z",
    `element face ${triangles.length / 3}`, "property list uchar int vertex_indices", "end_header",
    ...rows(points).map((point) => move(point).join(" ")), ...rows(triangles).map((corners) => `3 ${corners.join(" ")}`), ""].join("\n"));
}

const overlaid = (page) => page.evaluate(() => [...document.querySelector(".screen").scene.ghost?.geometry.attributes.position.array ?? []]);

export async function compared(page, job) {
  const other = (await ended({ kind: "predict", case: caseId, method: "fem_linear", outputs: ["skin.vtp", "skin.glb"], plan: { frame: "LPS", segments: [{ name: "mandible", translation_mm: [0, -5, 0] }] } })).id;

  await check("a predicted skin is compared with a real one, which is drawn where its registration puts it", async () => {
    await go(page, `#/case/${caseId}/compare?job=${job}`);
    await page.waitForFunction(() => document.querySelector(".screen")?.scene.skinPositions_mm.length > 0);
    const predicted = await positions(page);
    const real = await moved(page, ([x, y, z]) => [x + 2, y - 3, z + 1]);
    await page.locator("input[data-actual]").setInputFiles({ name: "real.ply", mimeType: "application/octet-stream", buffer: real });
    // Nothing is registered by itself: skins that are fitted to each other hide what the prediction errs.
    assert.deepEqual(await page.locator("fieldset", { hasText: "Register first" }).locator("label").allTextContents(), ["no", "by bone", "by ICP of the skins"]);
    assert(await page.getByRole("radio", { name: "no", exact: true }).isChecked());
    await page.getByText("Fitting the skins to each other (ICP) hides the error of the prediction", { exact: false }).waitFor();
    await page.getByRole("button", { name: "Compare" }).click();
    await page.getByText("Registration: no").waitFor();
    const apartMean = Number(await page.locator("table", { hasText: "< 1 mm" }).locator("tr", { hasText: "whole skin" }).locator("td").first().textContent());
    assert(apartMean > 1, `${apartMean} mm, of a skin that is shifted by 3.7 mm`);
    await page.getByText("by ICP of the skins").click();
    await page.getByRole("button", { name: "Compare" }).click();
    await page.getByText("Registration: icp").waitFor();
    const row = page.locator("table", { hasText: "< 1 mm" }).locator("tr", { hasText: "whole skin" }).locator("td");
    await row.first().waitFor();
    const [mean, , , within] = await row.allTextContents();
    assert(Number(mean) < 0.05 && within === "100.0", `${mean} ${within}`);
    await page.getByText(/shifted 3\.7\d mm/).waitFor();
    const drawn = await overlaid(page);
    assert(drawn.length === predicted.length && apart(drawn, predicted) < 0.1, `${apart(drawn, predicted)} mm`);
    const report = await page.getByRole("link", { name: "Read the report" }).getAttribute("href");
    assert.match(await (await fetch(address + report)).text(), /Registration/);
    assert.deepEqual(await serious(page), []);
    await pictured(page, "comparison");
    await addressed(page, /comparison=.*actual=/);
    // The address alone shows the same.
    await page.reload();
    await row.first().waitFor();
    assert(apart(await overlaid(page), predicted) < 0.1);
    await page.getByText("side by side").click();
    await addressed(page, /show=sides/);
    assert.deepEqual(await page.locator(".halves span").allTextContents(), ["Real skin", "Prediction"]);
    await page.getByText("overlaid").click();
    const { document } = await saved(page);
    assert.deepEqual(document.meshes.map(({ name }) => name).slice(0, 2), ["skin", "laid_over"]);
    assert.equal(document.asset.extras.map.label, "Signed distance");
    assert.deepEqual(document.asset.extras.map.range, [-2, 2]);
  });

  await check("another prediction to be compared is another skin and another address", async () => {
    const before = await positions(page);
    const chosen = page.getByRole("combobox", { name: /^Prediction/ });
    await chosen.selectOption(other);
    await addressed(page, new RegExp(`job=${other}`));
    await addressed(page, /comparison=|actual=/, false);
    await page.waitForFunction((first) => Math.abs(document.querySelector(".screen").scene.skinPositions_mm[first.at] - first.value) > 1,
      { at: before.findIndex((_, at) => at % 3 === 1 && before[at] < -85), value: before[before.findIndex((_, at) => at % 3 === 1 && before[at] < -85)] });
    assert.equal(await page.getByRole("heading", { name: "Distances" }).count(), 0, "those were of the other one");
    assert.deepEqual(await overlaid(page), []);
    await page.reload();
    await page.waitForFunction(() => document.querySelector(".screen")?.scene.skinPositions_mm.length > 0);
    assert.equal(await chosen.inputValue(), other);
  });

  await check("a landmark is seen, and dragged before a point of the skin", async () => {
    await go(page, `#/case/${caseId}/inverse?view=3`);
    await page.getByText("Pull", { exact: true }).waitFor();
    await page.waitForFunction(() => document.querySelector(".screen")?.scene.bones.size === 3);
    const dots = () => page.evaluate(() => document.querySelector(".screen").scene.marks.group.children.length);
    assert.equal(await dots(), 0);
    await page.getByText("Pull", { exact: true }).click();
    assert(await dots() > 3, "landmarks are marked");
    await pictured(page, "landmarks");
    const { landmarks } = (await json(`/v1/cases/${caseId}`)).case;
    const [x, y] = await page.evaluate((at_mm) => document.querySelector(".screen").scene.seenAt(at_mm), landmarks.pogonion);
    // The chin is the outline of this view: a little inside there is skin.
    const inside = await page.evaluate(([across, down]) => {
      const { scene } = document.querySelector(".screen");
      for (let at = across; at < across + 60; at += 1) if (scene.pick(new MouseEvent("click", { clientX: at, clientY: down })) !== undefined) return at + 1;
    }, [x - 8, y]);
    await page.mouse.move(inside, y);
    await page.mouse.down();
    await page.mouse.move(inside - 25, y, { steps: 4 });
    await page.mouse.up();
    assert.deepEqual(await page.locator(".target legend").allTextContents(), ["pogonion"]);
    assert(Number(await page.getByLabel("pogonion Forward mm").inputValue()) > 1);
    await addressed(page, /targets=pogonion,/);
    // Pulled again it is the same target.
    await page.mouse.move(inside, y);
    await page.mouse.down();
    await page.mouse.move(inside - 40, y, { steps: 4 });
    await page.mouse.up();
    assert.equal(await page.locator(".target").count(), 1);
    const { document } = await saved(page);
    assert.deepEqual(document.meshes.map(({ name }) => name).sort(), ["mandible", "maxilla", "skin", "skull"]);
  });

  await check("what is seen is saved as GLB with bones, colours, provenance and what it is not", async () => {
    await go(page, `${plan}?p=mandible,-6,0,0,0,0,0&map=displacement&view=1`);
    await planned(page);
    const { document, numbers } = await saved(page);
    const { notice, provenance, caption, map } = document.asset.extras;
    assert.equal(notice, "Research software, not a medical device");
    assert.match(provenance, new RegExp(`case ${caseId} · response [0-9a-f-]{36}`));
    assert.match(caption, /mandible back 6 mm/);
    assert.deepEqual(map, { label: "Displacement", unit: "mm", range: [0, 10] });
    const names = document.nodes.map(({ name }) => name);
    assert.deepEqual([names[0], ...names.slice(1, -1).sort(), names.at(-1)], ["skin", "mandible", "maxilla", "skull", "head"]);
    const [{ attributes }] = document.meshes[0].primitives;
    assert(apart(numbers(attributes.POSITION), await positions(page)) < AGREED_MM);
    const values = numbers(attributes._DISPLACEMENT);
    assert(Math.abs(Math.max(...values) - 6) < 1, `${Math.max(...values)}`);
    const colours = new Set(numbers(attributes.COLOR_0).map((value, at, all) => (at % 3 === 0 ? [value, all[at + 1], all[at + 2]].map((one) => one.toFixed(4)).join() : "")));
    assert(colours.size > 4 && colours.size <= 11, "colours are bands");
    // The bone of the lower jaw stands where the plan brings it: 6 mm back is +y of LPS.
    const jaw = document.nodes.find(({ name }) => name === "mandible");
    assert(apart(jaw.matrix, [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 6, 0, 1]) < 1e-9, jaw.matrix.join());
    // In glTF y is up and lengths are metres: up in LPS is z.
    assert(apart(document.nodes.at(-1).matrix.slice(8, 11), [0, 0.001, 0]) < 1e-12, document.nodes.at(-1).matrix.join());
  });
}
