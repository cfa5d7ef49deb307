// Numbers that the page shows beside those that the service answered: what was found backwards and how certain that is, cephalometric
// measures, distances as a histogram, pressure of contact; and warnings in the words of both languages.
import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { fileURLToPath } from "node:url";
import { inflateSync } from "node:zlib";
import { check, ended, go, json, opened, pictured, serious, address, caseId } from "./tools.mjs";

const BLOCK = fileURLToPath(new URL("../../examples/block/", import.meta.url));

const cells = (page, caption) => page.locator("table", { has: page.locator("caption", { hasText: caption }) }).locator("tbody tr");
/** The rows of a table by their names. */
async function rows(page, caption) {
  await cells(page, caption).first().waitFor({ state: "attached" });
  return Object.fromEntries(await cells(page, caption).evaluateAll((all) =>
    all.map((row) => [row.querySelector("th").textContent, [...row.querySelectorAll("td")].map((cell) => cell.textContent)])));
}
/** As the page writes a number that has no more digits than it needs. */
const figure = (value, digits) => String(Number(value.toFixed(digits)));
const successful = (job) => { assert.equal(job.status, "successful", JSON.stringify(job.error)); return job; };

/** The document of a GLB file of the service, and the numbers of its first surface by their names. */
async function surface(job) {
  const glb = Buffer.from(await (await fetch(`${address}/v1/jobs/${job}/results/skin.glb`)).arrayBuffer());
  const text = glb.readUInt32LE(12);
  const { accessors, bufferViews, meshes: [{ primitives: [{ attributes, indices }] }] } = JSON.parse(glb.subarray(20, 20 + text).toString());
  const numbers = (index) => {
    const { bufferView, count, type, componentType, byteOffset = 0 } = accessors[index];
    const first = 28 + text + (bufferViews[bufferView].byteOffset ?? 0) + byteOffset;
    return Array.from({ length: count * { SCALAR: 1, VEC3: 3 }[type] }, (_, at) => (componentType === 5126 ? glb.readFloatLE(first + 4 * at) : glb.readUInt32LE(first + 4 * at)));
  };
  return { triangles: numbers(indices), ...Object.fromEntries(Object.entries(attributes).filter(([name]) => !name.startsWith("COLOR")).map(([name, index]) => [name, numbers(index)])) };
}

/** A case of two layers that is solved in a moment. */
export async function block(changes = {}, files = {}) {
  const form = new FormData();
  const { case: document } = JSON.parse(await readFile(`${BLOCK}case.json`, "utf8"));
  form.append("case", new Blob([JSON.stringify({ ...document, ...changes })], { type: "application/json" }));
  for (const name of ["block.vtu", "mandible.stl"]) form.append(name, new Blob([await readFile(BLOCK + name)]), name);
  for (const [name, content] of Object.entries(files)) form.append(name, new Blob([content]), name);
  const posted = await fetch(`${address}/v1/cases`, { method: "POST", body: form });
  assert.equal(posted.status, 201, await posted.clone().text());
  return (await posted.json()).id;
}

/** A box between two corners as an STL file, its triangles facing out. */
export function boxOf(low, high) {
  const corner = (at) => low.map((value, axis) => ((at >> axis) & 1 ? high[axis] : value)).join(" ");
  const faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
  const triangles = faces.flatMap(([a, b, c, d]) => [[a, b, c], [a, c, d]]);
  return ["solid box", ...triangles.map((corners) => ["facet normal 0 0 0", "outer loop", ...corners.map((at) => `vertex ${corner(at)}`), "endloop", "endfacet"].join("\n")), "endsolid box", ""].join("\n");
}

/** An array of a VTK file of the service: blocks of base64 and zlib behind their sizes. */
function arrayOf(text, name) {
  const [, type, content] = new RegExp(`<DataArray[^>]*type="(Float32|Float64)"[^>]*Name="${name}"[^>]*>([^<]*)<`).exec(text);
  const body = content.trim();
  const count = Number(Buffer.from(body.slice(0, 12), "base64").readBigUInt64LE(0));
  const letters = 4 * Math.ceil(((3 + count) * 8) / 3);
  const head = Buffer.from(body.slice(0, letters), "base64");
  const packed = Buffer.from(body.slice(letters), "base64");
  let from = 0;
  const bytes = Buffer.concat(Array.from({ length: count }, (_, block) => {
    const size = Number(head.readBigUInt64LE(8 * (3 + block)));
    from += size;
    return inflateSync(packed.subarray(from - size, from));
  }));
  return type === "Float64" ? Array.from({ length: bytes.length / 8 }, (_, at) => bytes.readDoubleLE(8 * at)) : Array.from({ length: bytes.length / 4 }, (_, at) => bytes.readFloatLE(4 * at));
}

/** A third of each triangle for each of its nodes. */
function areas({ POSITION, triangles }) {
  const of = new Array(POSITION.length / 3).fill(0);
  for (let at = 0; at < triangles.length; at += 3) {
    const nodes = triangles.slice(at, at + 3);
    const [a, b, c] = nodes.map((node) => POSITION.slice(3 * node, 3 * node + 3));
    const [u, v] = [b, c].map((corner) => corner.map((value, axis) => value - a[axis]));
    const area = Math.hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]) / 2;
    for (const node of nodes) of[node] += area / 3;
  }
  return of;
}

/** What a number of a movement is called, and the sign of its slider, in LPS. */
const SLIDERS = { "translation_mm.x": ["left, mm", 1], "translation_mm.y": ["forward, mm", -1], "translation_mm.z": ["up, mm", 1] };
const TISSUE = { volume_change: ["growth, %", 100, 2], poisson_ratio: ["Poisson's ratio", 1, 4], young_modulus_kpa: ["Young's modulus, kPa", 1, 2] };

const chin = { landmark: "pogonion", displacement_mm: [0, -3, 1], sigma_mm: 0.4 };

export async function facts(page) {
  await check("what was found backwards has the standard errors of the service, in the signs of the sliders", async () => {
    const job = successful(await ended({ kind: "optimise", case: caseId, targets: [chin, { landmark: "subnasale", displacement_mm: [0, -1, null], sigma_mm: 0.3 }],
      bounds: { mandible: { translation_mm: [[-1, 1], [-10, 10], [-10, 10]] }, maxilla: { translation_mm: [[0, 0], [-10, 10], [0, 0]] } }, outputs: ["skin.vtp", "skin.glb"] }));
    const { parameters, standard_error } = job.results.optimisation;
    assert(parameters.length >= 3 && standard_error.every((error) => error > 0), JSON.stringify(parameters));
    await go(page, `#/job/${job.id}`);
    const shown = await rows(page, "Movement");
    parameters.forEach(({ segment, name, value }, at) => {
      const [word, sign] = SLIDERS[name];
      assert.deepEqual(shown[`${segment} ${word}`].map(Number), [sign * value, standard_error[at]].map((one) => Number(one.toFixed(2))), `${segment} ${name}`);
    });
    // The address of the plan that was found says it.
    const opens = new URLSearchParams((await page.getByRole("link", { name: "Open as plan" }).getAttribute("href")).split("?")[1]).get("p");
    for (const { segment, name, value } of parameters) {
      const numbers = opens.split(";").find((part) => part.startsWith(`${segment},`)).split(",").slice(1).map(Number);
      const [word, sign] = SLIDERS[name];
      assert(Math.abs(numbers[["forward, mm", "up, mm", "left, mm"].indexOf(word)] - sign * value) < 1e-9, `${opens}: ${segment} ${name} ${value}`);
    }
    // A bar's whiskers are the standard error.
    const [{ segment, name, value }] = parameters;
    const [word, sign] = SLIDERS[name];
    await page.locator("svg[aria-label=Movement] title", { hasText: `${segment} ${word}: ${figure(sign * value || 0, 2)} ± ${figure(standard_error[0], 2)}` }).waitFor({ state: "attached" });
  });

  await check("what was found backwards is told where no skin was asked for as a model", async () => {
    const layers = await block();
    const job = successful(await ended({ kind: "optimise", case: layers, targets: [{ landmark: "pogonion", displacement_mm: [null, 0, 1], sigma_mm: 0.5 }], bounds: { mandible: { translation_mm: [[0, 0], [-5, 5], [-5, 5]] } }, outputs: ["skin.csv"] }));
    const { parameters, standard_error } = job.results.optimisation;
    await go(page, `#/job/${job.id}`);
    const shown = await rows(page, "Movement");
    parameters.forEach(({ segment, name, value }, at) => {
      const [word, sign] = SLIDERS[name];
      assert.deepEqual(shown[`${segment} ${word}`].map(Number), [sign * value, standard_error[at]].map((one) => Number(one.toFixed(2))));
    });
    await page.getByRole("link", { name: "Open as plan" }).waitFor();
    assert.deepEqual(await serious(page), []);
  });

  await check("growth and constants of tissue are looked for with a movement, and told with errors, correlations and what they are warned of", async () => {
    const layers = await block({ landmarks: { pogonion: [60, 30, 20], near: [40, 30, 20] } });
    await go(page, `#/case/${layers}/inverse?targets=pogonion,0.2,1,0,0.3;near,0.1,0.5,0,0.3&tissue=skull,poisson_ratio,0.1,0.2;deep,volume_change,-0.1,0.1`);
    const section = page.locator("section", { has: page.getByRole("heading", { name: "Tissue that changed" }) });
    await section.waitFor();
    assert(await section.getByLabel("deep: growth, %", { exact: true }).isChecked(), "the address says what is looked for");
    assert.equal(await page.getByLabel("pogonion measured to ± mm").inputValue(), "0.3");
    await page.getByLabel("deep: growth, %, from").fill("-20");
    await section.locator("summary", { hasText: "skin" }).click();
    await section.getByLabel("skin: Poisson's ratio", { exact: true }).check();
    assert.match(decodeURIComponent(page.url()), /tissue=deep,volume_change,-0\.2,0\.1;skin,poisson_ratio,0\.3,0\.49/);
    assert.deepEqual(await serious(page), []);
    await pictured(page, "inverse-tissue");
    const asked = page.waitForRequest((request) => request.method() === "POST" && request.url().endsWith("/v1/jobs"));
    await page.getByRole("button", { name: "Find the plan" }).click();
    const spec = (await asked).postDataJSON();
    assert.deepEqual(spec.tissue_bounds, { deep: { volume_change: [-0.2, 0.1] }, skin: { poisson_ratio: [0.3, 0.49] } });
    assert.deepEqual(spec.targets.map(({ sigma_mm }) => sigma_mm), [0.3, 0.3]);
    await page.getByRole("heading", { name: "What was found" }).waitFor();
    const id = await page.evaluate(() => /job\/([0-9a-f-]+)/.exec(location.hash)[1]);
    const job = await json(`/v1/jobs/${id}`);
    const { parameters, standard_error, correlation, at_bound } = job.results.optimisation;
    const shown = await rows(page, "Tissue");
    const tissue = parameters.map((one, at) => ({ ...one, at })).filter(({ region }) => region !== undefined);
    assert.equal(tissue.length, 2);
    for (const { region, name, value, at } of tissue) {
      const [word, factor, digits] = TISSUE[name];
      const stopped = at_bound.some((one) => one.region === region && one.name === name) ? " (stopped by its bound)" : "";
      const [found, error, bound] = shown[`${region}: ${word}${stopped}`];
      assert.deepEqual([found, error], [value, standard_error[at]].map((one) => figure(factor * one, digits)), `${region} ${name}`);
      const most = correlation[at].filter((_, other) => other !== at).sort((a, b) => Math.abs(b) - Math.abs(a))[0];
      assert.equal(bound.split(":")[0], most.toFixed(2));
    }
    // Two places of the face do not tell both: the service says so, and no line above is good.
    const codes = await page.locator(".warnings .code").allTextContents();
    assert.deepEqual(codes.sort(), job.warnings.map(({ code }) => code).sort());
    assert(codes.includes("constant-not-determined") || codes.includes("constant-at-end"), codes.join());
    await page.locator(".trust.heed", { hasText: "Targets" }).waitFor();
    assert.deepEqual(await serious(page), []);
    await page.locator("section", { has: page.getByRole("heading", { name: "What was found" }) }).scrollIntoViewIfNeeded();
    await pictured(page, "found-tissue");
    const { value } = tissue.find(({ name }) => name === "poisson_ratio");
    await page.getByRole("button", { name: "Make a case with these constants" }).click();
    await page.getByRole("heading", { name: "What the check found" }).waitFor();
    const made = (await json(`/v1/cases/${await page.evaluate(() => /case\/([0-9a-f-]+)/.exec(location.hash)[1])}`)).case;
    const before = (await json(`/v1/cases/${layers}`)).case;
    assert.deepEqual(made.materials, { ...before.materials, skin: { ...before.materials.skin, poisson_ratio: value } });
  });

  await check("warnings are named in the language of the page, with the sentence of the service", async () => {
    const told = ["bulk-in-all-cells", "growth-left-out", "constant-not-determined", "constant-at-end", "a-code-of-tomorrow"].map((code) => ({ code, detail: `what the service says of ${code}` }));
    const job = (await json("/v1/jobs?kind=predict&status=successful&limit=1")).items[0];
    const view = await json(`/v1/jobs/${job.id}`);
    view.warnings = told;
    view.results.provenance.solver = { ...view.results.provenance.solver, newton: { energy_mn_mm: 1, least_det_f: 0.1, path: [], inner_iterations: 1, hierarchies: 1, indefinite_steps: 0, bulk_in_cells: 4, cells_with_bulk: 1234,
      is_stable: true, parts: [{ share: 0.5, energy_mn_mm: 1, least_det_f: 0.2, steps: 17 }, { share: 1, energy_mn_mm: 2, least_det_f: 0.1, steps: 22 }] } };
    const said = { en: ["Stiffer against changes of volume in all cells:", "50 % in 17 steps, 100 % in 22 steps", "1,234 cells, by 4 of their shear modulus"],
      de: ["In allen Zellen steifer gegen Volumenänderung:", "50 % in 17 Schritten, 100 % in 22 Schritten", "1.234 Zellen, um das 4-fache ihres Schubmoduls"] };
    for (const [language, [name, parts, cells]] of Object.entries(said)) {
      const reader = await opened(undefined, { locale: language });
      await reader.route(`**/v1/jobs/${job.id}`, (route) => route.fulfill({ json: view }));
      await go(reader, `#/job/${job.id}`);
      const list = reader.locator(".panel ul.warnings > li");
      await list.first().waitFor();
      assert.equal(await list.count(), told.length);
      const named = await list.locator("strong").allTextContents();
      assert.equal(named.length, 4, "a code that the page does not know has its sentence alone");
      assert.equal(named[0].trim(), name);
      assert.deepEqual(await list.locator("span[lang=en]").allTextContents(), told.map(({ detail }) => detail));
      for (const text of [parts, cells]) await reader.locator(".facts", { hasText: text }).waitFor();
      await reader.locator(".trust.heed").first().waitFor();
      assert.deepEqual(await serious(reader), []);
      await reader.context().close();
    }
  });

  await check("cephalometric measures are those of the service, before, planned and predicted, beside their norms", async () => {
    const { case: document } = await json(`/v1/cases/${caseId}`);
    const at = (position_mm, segment) => ({ position_mm, ...(segment === undefined ? {} : { segment }) });
    const { pogonion, subnasale } = document.landmarks;
    const [x, y, z] = subnasale;
    const bone_landmarks = { S: at([x, y + 75, z + 45]), N: at([x, y + 12, z + 50]), A: at([x, y + 14, z - 2], "maxilla"), B: at([x, y + 16, z - 32], "mandible"),
      ANS: at([x, y + 12, z + 2], "maxilla"), Me: at([x, y + 20, z - 50], "mandible"), U1: at([x, y + 10, z - 18], "maxilla"), L1: at([x, y + 13, z - 17], "mandible"),
      Oc: at([x, y + 40, z - 20], "maxilla") };
    const { id: of } = await json("/v1/cases", { ...document, name: "with landmarks of bone", bone_landmarks });
    const job = successful(await ended({ kind: "predict", case: of, method: "fem_linear", outputs: ["skin.vtp", "skin.glb"], plan: { frame: "LPS", segments: [{ name: "mandible", translation_mm: [0, 5, 1] }] } }));
    const { cephalometry } = job.results;
    assert(cephalometry.length >= 6 && cephalometry.some(({ before, planned }) => Math.abs(before - planned) > 1), JSON.stringify(cephalometry));
    await go(page, `#/job/${job.id}`);
    const shown = await rows(page, "Cephalometric measures");
    assert.equal(Object.keys(shown).length, cephalometry.length);
    const units = { deg: ", °", mm: ", mm", 1: "" };
    const number = (value) => (value === undefined || value === null ? "–" : value.toFixed(1));
    for (const { name, unit, before, planned, predicted, norm } of cephalometry) {
      const wanted = [before, planned, predicted].map(number);
      assert.deepEqual(shown[`${name.replaceAll("_", " ")}${units[unit]}`], [...wanted, norm ? `${norm.mean.toFixed(1)} ± ${norm.sd.toFixed(1)}` : "–"], name);
    }
    assert(cephalometry.some(({ norm }) => norm), "some have a norm");
    assert(pogonion !== undefined);
    await page.locator("section", { has: page.getByRole("heading", { name: "Cephalometric measures" }) }).scrollIntoViewIfNeeded();
    await pictured(page, "cephalometry");
  });

  await check("the histogram of a comparison has the shares of the skin that the service measured", async () => {
    const plans = [5, 2].map((y) => ({ frame: "LPS", segments: [{ name: "mandible", translation_mm: [0, y, 0] }] }));
    const [one, other] = await Promise.all(plans.map((plan) => ended({ kind: "predict", case: caseId, method: "fem_linear", plan, keep: ["skin"], outputs: ["skin.vtp", "skin.glb"] })));
    const edges = Array.from({ length: 25 }, (_, at) => -3 + at / 4);
    const mesh = other.results.kept[0].mesh;
    const job = successful(await ended({ kind: "compare", prediction: { job: one.id }, actual: { mesh }, align: "none", range_mm: 2, histogram_edges_mm: [0, 1, 2, 3] }));
    const skin = await surface(job.id);
    const distances = skin._SIGNED_DISTANCE_MM;
    const weights = areas(skin);
    const total = weights.reduce((sum, area) => sum + area, 0);
    await go(page, `#/case/${caseId}/compare?comparison=${job.id}&actual=${mesh}`);
    const bars = page.locator("svg[aria-label=Distances] rect title");
    await bars.first().waitFor({ state: "attached" });
    const shown = await bars.allTextContents();
    assert.equal(shown.length, 24);
    const shares = shown.map((text, at) => {
      const [, from, to, percent] = /^(-?[\d.]+) … (-?[\d.]+) mm: ([\d.]+) %$/.exec(text);
      assert.deepEqual([Number(from), Number(to)], [edges[at], edges[at + 1]]);
      return Number(percent) / 100;
    });
    edges.slice(0, -1).forEach((from, at) => {
      const inside = distances.map((value, node) => [value, weights[node]]).filter(([value]) => (value >= from || at === 0) && (value < edges[at + 1] || at === 23));
      const wanted = inside.reduce((sum, [, area]) => sum + area, 0) / total;
      assert(Math.abs(shares[at] - wanted) < 6e-4, `from ${from} mm: ${shares[at]}, of the service's file ${wanted}`);
    });
    // The same as the service says of points that it lays over the skin.
    const { to_actual, both } = job.results.comparison;
    const within = (most) => shares.filter((_, at) => Math.abs(edges[at] + 1 / 8) < most).reduce((sum, share) => sum + share, 0);
    assert(shares.filter((share) => share > 0.01).length > 2, shown.join());
    for (const most of [1, 2]) {
      const said = to_actual[`share_below_${most}_mm`];
      assert(Math.abs(within(most) - said) < 0.03, `${within(most)} within ${most} mm, ${said} told`);
    }
    const table = await rows(page, "Distances, mm");
    assert.deepEqual(table["whole skin"], [both.mean, both.p95, both.max].map((value) => value.toFixed(2)).concat([both.share_below_1_mm, both.share_below_2_mm, both.share_below_3_mm].map((share) => (100 * share).toFixed(1))));
  });

  await check("pressure of contact is a map of the skin, with the numbers of the service's file", async () => {
    // A plate of bone 0.3 mm over the block, against which the bone under it presses the skin.
    const bones = [{ name: "mandible", mesh: "mandible.stl" }, { name: "plate", mesh: "plate.stl" }];
    const pressed = await block({ bones }, { "plate.stl": boxOf([-10, -10, 20.3], [90, 70, 25]) });
    const plan = { frame: "LPS", segments: [{ name: "mandible", translation_mm: [0, 0, 1.5] }] };
    const job = successful(await ended({ kind: "predict", case: pressed, method: "fem_linear", contact: "unilateral", outputs: ["skin.vtp", "skin.glb"], plan }));
    const pressures = arrayOf(await (await fetch(`${address}/v1/jobs/${job.id}/results/skin.vtp`)).text(), "contact_pressure_kpa");
    const most = Math.max(...pressures);
    assert(most > 0.1 && most < 20, `${most} kPa`);
    await go(page, `#/job/${job.id}?view=1&map=contact&range=20`);
    await page.locator(".legend figcaption", { hasText: "Pressure of contact, kPa" }).waitFor();
    const shown = await page.evaluate(() => [...document.querySelector(".screen").scene.skin.geometry.attributes.uv.array].filter((_, at) => at % 2 === 0));
    assert.equal(shown.length, pressures.length);
    // What is drawn is a share of the range, a little within its ends.
    shown.forEach((share, node) => assert(Math.abs(share - Math.min(Math.max(pressures[node] / 20, 1e-3), 1 - 1e-3)) < 1e-4, `node ${node}: ${share} of 20 kPa, ${pressures[node]} kPa`));
    assert.deepEqual(await serious(page), []);
    await pictured(page, "contact");
  });
}
