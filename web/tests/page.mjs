// The page as people use it, in headless Chromium, on the demo of the built program.
import assert from "node:assert/strict";
import { readFile, writeFile } from "node:fs/promises";
import { join } from "node:path";
import { answers } from "./answers.mjs";
import { compared } from "./compared.mjs";
import { cuts } from "./cuts.mjs";
import { facts } from "./facts.mjs";
import { kinds } from "./kinds.mjs";
import { dragged, figured, framed, stepped } from "./frames.mjs";
import { mended } from "./mended.mjs";
import { muscles } from "./muscles.mjs";
import { meshed } from "./meshed.mjs";
import { plans } from "./plans.mjs";
import { printed } from "./printed.mjs";
import { allViews, reached, turned } from "./reached.mjs";
import { guarded } from "./service.mjs";
import { told } from "./told.mjs";
import {
  ended, fits, BINARY, WIDE, PICTURES, KEY, HEAD, AGREED_MM, check, service, browser, hosts, complaints, opened, excused, addressed, go, painted,
  positions, planned, apart, slider, slide, json, serious, pictured, address, plan, caseId, counted,
} from "./tools.mjs";

/** A second order may take so long where much else is computed. */
const BUILT_MS = 900_000;

/** How long sliders are dragged in a run of all tests; `web/tests/drag` takes ten minutes. */
const DRAGGED_S = 6;

const page = await opened();
await check("the first thing is the list of cases, and what the program is not", async () => {
  await page.goto(address);
  await page.getByRole("link", { name: "half head" }).waitFor();
  assert.equal(await page.evaluate(() => document.scrollingElement.scrollHeight - innerHeight), 0, "two cases need no scroll bar");
  assert.equal(await page.locator("#notice").textContent(), "Research software, not a medical device");
  assert.deepEqual(await serious(page), []);
  const first = await painted(page);
  console.log(`   first paint after ${first.toFixed(0)} ms`);
  await pictured(page, "cases");
});

// The response of the demo's case, which takes long where much else is compiled.
let response = await json("/v1/jobs", { kind: "response", case: caseId });
while (response.status === "accepted" || response.status === "running") {
  response = await (await fetch(`${address}/v1/jobs/${response.id}`, { headers: { Prefer: "wait=30" } })).json();
}

/** The displacement of a prediction's skin, node by node. */
const finite = async (page, id) => {
  const glb = Buffer.from(await (await fetch(`${address}/v1/jobs/${id}/results/skin.glb`)).arrayBuffer());
  const length = glb.readUInt32LE(12);
  const { accessors, bufferViews, meshes } = JSON.parse(glb.subarray(20, 20 + length).toString());
  const { bufferView, count, byteOffset = 0 } = accessors[meshes[0].primitives[0].attributes._DISPLACEMENT_MM];
  const first = 28 + length + (bufferViews[bufferView].byteOffset ?? 0) + byteOffset;
  return Array.from({ length: 3 * count }, (_, at) => glb.readFloatLE(first + 4 * at));
};

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

await check("the second order is built in the background and taken while somebody plans, who loses nothing", async () => {
  await slide(page, "mandible", "forward", -5);
  await page.getByText("Second order, in the background").waitFor();
  await page.getByRole("button", { name: "Cancel" }).waitFor();
  await page.locator(".trust", { hasText: "Model" }).getByText("linear response").waitFor();
  await page.locator(".panel").getByText("Where on the face this is, a linear response does not know").waitFor();
  const linear = await positions(page);
  await slider(page, "mandible", "forward").focus();
  await page.locator(".badge", { hasText: "Second order" }).waitFor({ timeout: BUILT_MS });
  await page.locator(".trust", { hasText: "Model" }).getByText("second-order response").waitFor();
  assert.equal(await slider(page, "mandible", "forward").inputValue(), "-5");
  assert.equal(await page.evaluate(() => document.activeElement.dataset.word), "forward", "the focus stays");
  assert.equal(await page.locator("#said").textContent(), "The second order is ready: the skin has it now.");
  const moved = await positions(page);
  const answer = await json(`/v1/cases/${caseId}/response/apply`, { plan: { frame: "LPS", segments: [{ name: "mandible", translation_mm: [0, 5, 0] }] } });
  assert.equal(answer.order, 2);
  assert(apart(moved, linear) > 0.1 && apart(answer.displacement_mm.flat(), moved.map((value, at) => value - rest[at])) < AGREED_MM);
  // What is left out still is shaded, and its mean over the skin that moves is the one that is told.
  await page.locator(".tools select").selectOption("left");
  const left = await page.evaluate(() => [...document.querySelector(".screen").scene.skin.geometry.attributes.uv.array].filter((_, at) => at % 2 === 0));
  const lengths = answer.displacement_mm.map((one) => Math.hypot(...one));
  const moving = lengths.map((length, node) => [length, left[node]]).filter(([length]) => length >= 0.1 * answer.max_mm);
  const mean = moving.reduce((sum, [, one]) => sum + one, 0) / moving.length;
  assert(Math.abs(mean / answer.nonlinearity_estimate_mm - 1) < 0.02, `${mean} mm shaded, ${answer.nonlinearity_estimate_mm} mm told`);
  await page.locator(".tools select").selectOption("");
});

await check("what is left out is shaded where finite strain says that it is", async () => {
  const plan = { frame: "LPS", segments: [{ name: "maxilla", translation_mm: [0, -5, 0] }, { name: "mandible", translation_mm: [0, 8, 0] }] };
  const { id } = await ended({ kind: "predict", case: caseId, plan, method: "fem_nonlinear", outputs: ["skin.glb"] });
  await go(page, `${new URL(page.url()).hash.split("?")[0]}?p=maxilla,5,0,0,0,0,0;mandible,-8,0,0,0,0,0&map=left&view=1`);
  await planned(page);
  const truth = await finite(page, id);
  const [here, left] = await page.evaluate(() => { const { scene } = document.querySelector(".screen"); return [[...scene.skinPositions_mm], [...scene.skin.geometry.attributes.uv.array].filter((_, at) => at % 2 === 0)]; });
  const off = left.map((_, node) => Math.hypot(...[0, 1, 2].map((axis) => here[3 * node + axis] - rest[3 * node + axis] - truth[3 * node + axis])));
  const mean = (all) => all.reduce((sum, one) => sum + one, 0) / all.length;
  const about = (all) => all.map((one) => one - mean(all));
  const [a, b] = [about(left), about(off)];
  const product = (one, other) => one.reduce((sum, value, at) => sum + value * other[at], 0);
  const correlation = product(a, b) / Math.sqrt(product(a, a) * product(b, b));
  console.log(`   left out: ${mean(left).toFixed(3)} mm shaded, ${mean(off).toFixed(3)} mm from finite strain, correlation over the nodes ${correlation.toFixed(2)}`);
  assert(correlation > 0.6 && mean(left) > 0.5 * mean(off) && mean(left) < 3 * mean(off), `${correlation}`);
  await go(page, `${new URL(page.url()).hash.split("?")[0]}?view=1`);
  await planned(page);
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
  await page.waitForFunction(() => Number(document.querySelector(".strip[data-apart]").dataset.apart) < 1e-4);
  await page.locator(".trust", { hasText: "Error of the model" }).getByText(/about \d\.\d\d mm/).waitFor();
  console.log(`   ${difference.toExponential(1)} mm from the service`);
});

await check("the state is in the address, and what was done is taken back", async () => {
  await addressed(page, /p=maxilla,0,2,0,0,0,0;mandible,-6,0,0,3,0,0/);
  const moved = await positions(page);
  await page.getByRole("button", { name: "Undo" }).click();
  await addressed(page, /p=mandible,-6,0,0,3,0,0/);
  await page.getByRole("button", { name: "Redo" }).click();
  assert(apart(moved, await positions(page)) < AGREED_MM);
  await page.reload();
  await planned(page);
  assert(apart(moved, await positions(page)) < AGREED_MM);
});

await check("everything works from the keyboard", async () => {
  await turned(page);
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
    // All pixels are drawn again first: what moved before was drawn with fewer.
    const drawn = scene.drawNow();
    const copy = Object.assign(document.createElement("canvas"), { width: drawn.width, height: drawn.height });
    const pen = copy.getContext("2d");
    pen.drawImage(drawn, 0, 0);
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

await check("steps of a slider are one picture a frame", () => stepped(page));

await check("a plan is saved, laid over the one that is planned on, and removed", async () => {
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
  await page.locator("section", { has: page.getByRole("button", { name: "Predict in full" }) }).getByLabel("Model", { exact: false }).first().selectOption("fem_linear");
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
  await page.getByRole("link", { name: "large-rotation" }).waitFor();
  // The legend of the profile names the colours that are drawn: before has more green than anything, after is dark.
  const lines = await page.locator("svg[aria-label^=Outline] path").evaluateAll((all) => all.slice(0, 2).map((one) => getComputedStyle(one).stroke.match(/\d+/g).map(Number)));
  assert(lines[0][1] > 1.5 * Math.max(lines[0][0], lines[0][2]) && Math.max(...lines[1]) < 60, JSON.stringify(lines));
  await page.getByText("before green, after dark", { exact: false }).waitFor();
  assert.deepEqual(await serious(page), []);
});

await check("the probe says how far a point moves", async () => {
  await page.keyboard.press("1");
  const box = await page.locator(".screen canvas").boundingBox();
  await page.mouse.click(box.x + box.width / 2, box.y + 0.72 * box.height);
  const told = page.getByText(/Point \d+ moves by \d+\.\d\d mm/);
  await told.waitFor();
  const clicked = await told.textContent();
  await page.locator(".screen canvas").focus();
  await page.keyboard.press("Enter");
  await page.waitForFunction((before) => document.querySelector(".panel .told").textContent !== before, clicked);
  await page.locator(".tools select").selectOption("displacement");
  await pictured(page, "result");
});

await check("before and after stand side by side under one camera", async () => {
  // In a list of colours keys choose colours.
  await page.locator(".screen canvas").focus();
  await page.keyboard.press("3");
  await page.getByText("side by side").click();
  await addressed(page, /show=sides/);
  const { places: halves, pixel_mm } = await page.evaluate(() => {
    const { scene } = document.querySelector(".screen");
    const { canvas } = scene;
    const box = canvas.getBoundingClientRect();
    const found = [];
    for (let across = 10; across < box.width / 2; across += 15) {
      for (let down = 100; down < box.height; down += 30) {
        const hits = [0, box.width / 2].map((half) => scene.pick(new MouseEvent("click", { clientX: box.left + across + half, clientY: box.top + down })));
        if (hits.every((hit) => hit !== undefined)) found.push(hits.map(({ point_mm }) => point_mm));
      }
    }
    return { places: found, pixel_mm: 1 / scene.pixelsPerMm };
  });
  // Seen from the left: what is at the same place of both halves lies at the same y and z, and before and after differ along x.
  assert(halves.length > 20, `${halves.length} places of both`);
  // Events have whole pixels.
  assert(halves.every(([a, b]) => Math.hypot(a[1] - b[1], a[2] - b[2]) < 1.01 * pixel_mm), "one camera for both");
  assert(halves.some(([a, b]) => Math.abs(a[0] - b[0]) > 0.05), "two states");
  assert.deepEqual(await serious(page), []);
  await pictured(page, "side-by-side");
  await page.getByText("one", { exact: true }).click();
  await addressed(page, /show=/, false);
});

await check("what a result may be trusted with is told, and warnings show what they name", async () => {
  const { results } = await json(`/v1/jobs/${job}`);
  const chip = (name) => page.locator(".trust", { hasText: name });
  await chip("Error of the mesh").getByText(`mean ${results.numerical_error_mm.mean.toFixed(2)} mm`).waitFor();
  await chip("Error of the model").getByText(`mean ${results.nonlinearity_mm.skin.mean.toFixed(2)} mm`).waitFor();
  const named = page.locator(".warnings li", { hasText: "large-rotation" });
  await named.getByRole("button", { name: /^Show / }).click();
  const dots = await page.evaluate(() => document.querySelector(".screen").scene.pointed.group.children.length);
  assert.equal(dots, 1, "what the warning names is marked");
  await pictured(page, "warning-in-place");
});

await check("a report is read and saved", async () => {
  const href = await page.getByRole("link", { name: "Read the report" }).getAttribute("href");
  const read = await (await fetch(address + href)).text();
  assert(read.includes("not a medical device"), "an English report");
  // As a browser shows it, under the policy of the service: with its pictures, in the colours of the page. What the policy forbids is a complaint.
  const reader = await opened(WIDE, { colorScheme: "dark" });
  await reader.goto(address + href);
  const drawn = await reader.evaluate(() => Promise.all([...document.querySelectorAll("svg image")].map((one) => {
    const image = new Image();
    image.src = one.getAttribute("href");
    return image.decode().then(() => image.naturalWidth, () => 0);
  })));
  assert(drawn.length === 9 && drawn.every((width) => width > 100), drawn.join());
  assert.equal(await reader.evaluate(() => getComputedStyle(document.body).backgroundColor), "rgb(255, 255, 255)", "a report is paper");
  assert.deepEqual(await serious(reader), []);
  await pictured(reader, "report");
  await reader.goto(`${address}/errors`);
  assert.deepEqual(await serious(reader), []);
  await fits(reader);
  await pictured(reader, "errors-dark");
  await reader.context().close();
  const pdf = Buffer.from(await (await fetch(address + await page.getByRole("link", { name: "Report as PDF" }).getAttribute("href"))).arrayBuffer());
  assert.equal(pdf.subarray(0, 4).toString(), "%PDF");
});

await check("a picture is saved with its legend and what it is not", async () => {
  const swatches = await page.locator(".legend .bands span").evaluateAll((all) => all.map((one) => getComputedStyle(one).backgroundColor.match(/\d+/g).map(Number)));
  await page.evaluate(() => {
    window.written = [];
    const usual = CanvasRenderingContext2D.prototype.fillText;
    CanvasRenderingContext2D.prototype.fillText = function fillText(text, ...place) { window.written.push(text); return usual.call(this, text, ...place); };
  });
  const [download] = await Promise.all([page.waitForEvent("download"), page.getByRole("button", { name: "Save picture" }).click()]);
  const content = await readFile(await download.path());
  assert.equal(content.subarray(1, 4).toString(), "PNG");
  // The words that it was written with, and the colours that stand in it.
  const written = (await page.evaluate(() => window.written)).join("\n");
  const { results } = await json(`/v1/jobs/${job}`);
  for (const part of ["Displacement, mm", "\n0\n", "\n10\n", `job ${job}`, results.provenance.spec_hash.slice(0, 16), "Research software, not a medical device", "half head", "mandible back 6 mm"]) {
    assert(`\n${written}\n`.includes(part), `${part} in ${written}`);
  }
  const found = await page.evaluate(async ([base64, wanted]) => {
    const image = await createImageBitmap(new Blob([Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0))], { type: "image/png" }));
    const copy = Object.assign(document.createElement("canvas"), { width: image.width, height: image.height });
    const pen = copy.getContext("2d");
    pen.drawImage(image, 0, 0);
    // The legend stands between the head and the words.
    const { data } = pen.getImageData(0, image.height - 118 - 64, 16 + 36 * 10, 64);
    return wanted.map((rgb) => { let count = 0; for (let at = 0; at < data.length; at += 4) if (rgb.every((value, channel) => data[at + channel] === value)) count += 1; return count; });
  }, [content.toString("base64"), swatches]);
  assert(swatches.length === 10 && found.every((count) => count > 300), found.join());
  if (PICTURES !== undefined) await writeFile(join(PICTURES, "saved.png"), content);
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
  await page.getByRole("button", { name: "Find the plan" }).click();
  await page.getByRole("heading", { name: "What was found" }).waitFor();
  const found = await page.evaluate(() => /job\/([0-9a-f-]+)/.exec(location.hash)[1]);
  const { results } = await json(`/v1/jobs/${found}`);
  const [target] = results.optimisation.targets;
  assert(target.points === 1 && target.residual_mm < forward / 3, `${forward} mm ${JSON.stringify(target)}`);
});

await compared(page, job);
await told(page, job);
await plans(page);
await mended(page, job);
await cuts(page, job);

await check("files that are no mesh are refused in words", async () => {
  await go(page, `#/cases`);
  excused.push(/the server responded with a status of 4\d\d .*\/v1\/meshes/);
  await page.locator("input[data-files]").setInputFiles({ name: "broken.vtu", mimeType: "text/plain", buffer: Buffer.from("no mesh at all") });
  const alert = page.getByRole("alert");
  await alert.waitFor();
  assert.match(await alert.textContent(), /Refused\. .{10,}/);
  assert.match(await alert.locator("a").getAttribute("href"), /^\/errors#[a-z-]+$/);
  await page.locator("input[data-files]").setInputFiles({ name: "case.json", mimeType: "application/json", buffer: Buffer.from("{ no document") });
  await alert.getByText("case.json is not JSON").waitFor();
});

await check("a mesh alone becomes a case by saying what its sets are", async () => {
  await page.locator("input[data-files]").setInputFiles([`${HEAD}face.vtu`]);
  await page.getByLabel("mandible").selectOption("segment");
  const text = await page.getByLabel("Case document").inputValue();
  const { segments, fixed, skin } = JSON.parse(text);
  assert(segments.some(({ name }) => name === "mandible") && fixed.length > 0 && skin.node_set === "skin", text);
  // A set that is no part of the skin is refused, and said beside it.
  excused.push(/status of 422 .*\/v1\/cases/);
  await page.getByLabel("skull").selectOption("region");
  await page.getByRole("button", { name: "Send" }).click();
  await page.locator(".drop li", { hasText: "skull" }).getByText("no node of the selection is on the skin").waitFor();
  await page.getByLabel("skull").selectOption("fixed");
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

await check("sets are named and chosen in the view, and another role is another case", async () => {
  await page.getByText("Point at the mesh to name its sets").waitFor();
  // Coloured by what holds it, until another colour is chosen.
  const held = page.locator(".legend li");
  await held.first().waitFor();
  assert.deepEqual(await held.allTextContents(), ["Free", "Sliding", "Fixed", "mandible: moves as a bone", "maxilla: moves as a bone"]);
  const coloured = () => page.evaluate(() => {
    const { color } = document.querySelector(".screen").scene.skin.geometry.attributes;
    const found = new Map();
    for (let node = 0; node < color.count; node += 1) { const key = color.getX(node).toFixed(3); found.set(key, (found.get(key) ?? 0) + 1); }
    return [...found.values()].sort((one, other) => other - one);
  });
  const sizes = await coloured();
  assert.equal(sizes.length, 4, `${sizes}: free, fixed and two bones`);
  await page.locator(".sets li[data-set=maxilla]").getByRole("combobox").selectOption("none");
  assert.equal((await coloured()).length, 3, "a role that changes colours the skin anew");
  await page.getByRole("button", { name: "As they were" }).click();
  await page.keyboard.press("1");
  const box = await page.locator(".screen canvas").boundingBox();
  const [x, y] = [box.x + box.width / 2, box.y + 0.7 * box.height];
  await page.mouse.move(x, y);
  await page.locator(".caption", { hasText: /\(skin\)/ }).waitFor();
  await page.mouse.click(x, y);
  const chosen = page.locator(".sets li.chosen");
  await chosen.waitFor();
  const set = await chosen.getAttribute("data-set");
  assert.equal(await page.evaluate(() => document.querySelector(".screen").scene.pointed.group.children.length), 1);
  const before = await page.evaluate(() => location.hash);
  await page.locator(".sets li[data-set=nose]").getByRole("combobox").selectOption("none");
  assert.deepEqual(await serious(page), []);
  await pictured(page, "sets");
  await page.getByRole("button", { name: "Make a case with these roles" }).click();
  await page.waitForFunction((old) => location.hash !== old, before);
  await page.getByText("Point at the mesh to name its sets").waitFor();
  const id = await page.evaluate(() => /case\/([0-9a-f-]+)/.exec(location.hash)[1]);
  const made = (await json(`/v1/cases/${id}`)).case;
  const old = (await json(`/v1/cases/${/case\/([0-9a-f-]+)/.exec(before)[1]}`)).case;
  const { nose, ...others } = old.skin_regions;
  assert(nose !== undefined && set !== null);
  assert.deepEqual(made, { ...old, name: `${old.name} · other roles`, skin_regions: others });
  await page.goBack();
  await page.getByRole("heading", { name: "What the check found" }).waitFor();
});

await check("a case without a response gets one when it is planned on", async () => {
  // What nobody asked for is not refused in red, as where a key may only read.
  excused.push(/status of 403 .*\/v1\/jobs/);
  const posted = ({ pathname }) => pathname === "/v1/jobs";
  await page.route(posted, (route) => (route.request().method() === "POST" && route.request().postDataJSON().order === 2
    ? route.fulfill({ status: 403, contentType: "application/problem+json", body: JSON.stringify({ type: "/errors#forbidden", title: "", code: "forbidden", status: 403, detail: "this key may only read" }) }) : route.fallback()));
  await page.getByRole("link", { name: "Plan a movement" }).click();
  await planned(page);
  await page.getByText("The second order was not built: this key may only read").waitFor();
  assert.equal(await page.getByRole("alert").count(), 0);
  await page.unroute(posted);
  await page.getByRole("button", { name: "Try again" }).click();
  // It is stopped, and stays so in this tab.
  await page.locator(".order").getByRole("button", { name: "Cancel" }).click();
  await page.getByRole("button", { name: "Add the second order" }).waitFor();
  await page.reload();
  await planned(page);
  await page.getByRole("button", { name: "Add the second order" }).waitFor();
  await slide(page, "mandible", "forward", 4);
  await page.locator(".told", { hasText: /The skin moves [1-4]\.\d\d mm at most/ }).waitFor();
});

await check("what a case was warned of is told beside each of its plans", async () => {
  const told = { code: "teeth-joined", detail: "tissue is joined to the teeth of this test" };
  const warned = async (route) => {
    const answer = await route.fetch();
    const view = await answer.json();
    await route.fulfill({ response: answer, json: { ...view, check: { ...view.check, warnings: [told] } } });
  };
  await page.route(`**/v1/cases/${caseId}`, warned);
  await go(page, plan);
  await planned(page);
  await page.getByText(told.detail).waitFor();
  await page.locator(".trust.heed", { hasText: "Warnings" }).getByText("1", { exact: true }).waitFor();
  await page.unroute(`**/v1/cases/${caseId}`);
});

await check("a view is as tall as its window, and what is refused stands in the place of what was waited for", async () => {
  for (const path of [`#/case/${caseId}`, plan, `#/case/${caseId}/inverse`]) {
    await go(page, path);
    await page.locator(".loading").waitFor({ state: "detached" });
    assert.deepEqual(await page.evaluate(() => document.scrollingElement.scrollHeight - innerHeight), 0, path);
  }
  excused.push(/status of 500 .*response/);
  const there = ({ pathname }) => pathname === `/v1/cases/${caseId}/response`;
  await page.route(there, (route) => route.fulfill({ status: 500, contentType: "application/problem+json", body: JSON.stringify({ type: "/errors#internal", title: "", code: "internal", status: 500, detail: "no such place" }) }));
  await go(page, "#/cases");
  for (const view of [plan, `#/case/${caseId}/inverse`, `#/case/${caseId}/plans`]) {
    await go(page, view);
    await page.getByRole("alert").getByText("no such place").waitFor();
    assert.equal(await page.locator(".loading").count(), 0, view);
  }
  await page.unroute(there);
  excused.push(/status of 404 .*\/v1\/cases\/gone/);
  await go(page, "#/case/gone/plan");
  await page.getByRole("alert").getByText("Not here.").waitFor();
  await page.getByRole("link", { name: "To the cases" }).click();
  await page.getByRole("heading", { name: "Cases", exact: true }).waitFor();
});

await meshed(page);
await muscles(page);
await printed();
await kinds(page);
await facts(page);
await answers(page);

await check("jobs are listed, and studies", async () => {
  await go(page, `#/jobs`);
  await page.getByRole("link", { name: "Plan found backwards" }).first().waitFor();
  assert.deepEqual(await serious(page), []);
  await pictured(page, "jobs");
  await page.getByRole("link", { name: "Studies" }).click();
  // Those of the tests of other kinds.
  await page.locator("ul.cards li").first().waitFor();
});

await check("a job is cancelled", async () => {
  // Several times as long as everything before it: it is under way whenever the button is pressed.
  const study = await json("/v1/jobs", { kind: "study", scenes: ["slab"], plans: ["patch 2 mm", "patch 4 mm"], methods: ["fem_nonlinear"], levels: [0, 1], truth: { refine: 2 }, repeats: 20 });
  await go(page, `#/job/${study.id}`);
  await page.getByRole("button", { name: "Cancel" }).click();
  await page.getByText("It was cancelled.").waitFor();
});

await check("a job that failed says why, and one without a skin says what it found", async () => {
  // The least time that may be asked for: to read the mesh takes longer.
  const spec = { kind: "predict", case: caseId, plan: { segments: [{ name: "mandible", translation_mm: [0, 6, 0] }] }, method: "fem_nonlinear", budget: { wall_s: 1e-3 } };
  const failed = await ended(spec);
  assert.equal(failed.status, "failed", JSON.stringify(failed));
  await go(page, "#/jobs");
  await page.locator("tr", { hasText: `…${failed.id.slice(-6)}` }).locator(".failed").getByText(failed.error.detail.slice(0, 30)).waitFor();
  await go(page, `#/job/${failed.id}`);
  await page.getByRole("alert").getByText(failed.error.detail.slice(0, 30)).waitFor();
  const { items } = await json("/v1/jobs?kind=response&status=successful&limit=1");
  await go(page, `#/job/${items[0].id}`);
  await page.getByRole("heading", { name: "Response · done" }).waitFor();
  assert.deepEqual(await serious(page), []);
  await fits(page);
});

await check("results of kinds that the page does not know are told by the names of the service", async () => {
  const job = { id: "made-up", kind: "something-new", status: "successful", message: "", progress: 100, created: "2026-01-01T00:00:00Z", warnings: [], results: {
    files: [], something: { method: "regression", depth_mm: 3, table: [{ method: "regression", mean_mm: 1.25 }, { method: "none", mean_mm: 1.5 }], width: { chosen_mm: 12 } } } };
  await page.route("**/v1/jobs/made-up", (route) => route.fulfill({ json: job }));
  await go(page, "#/cases");
  await go(page, "#/job/made-up");
  await page.getByRole("heading", { name: "something-new · done" }).waitFor();
  assert.deepEqual(await page.locator("table", { hasText: "mean, mm" }).locator("td").allTextContents(), ["1.25", "1.5"]);
  await page.getByText("chosen, mm").waitFor();
  await page.getByText("depth, mm").waitFor();
  assert.deepEqual(await serious(page), []);
  await page.unroute("**/v1/jobs/made-up");
});

await check("a lost connection is told, and taken up again", async () => {
  await go(page, `#/cases`);
  await page.getByRole("link", { name: "half head", exact: true }).waitFor();
  excused.push(/ERR_INTERNET_DISCONNECTED/);
  await page.context().setOffline(true);
  await page.getByRole("link", { name: "Jobs" }).click();
  await page.getByRole("alert").getByText("No connection.").waitFor();
  await page.context().setOffline(false);
  await page.getByRole("button", { name: "Try again" }).click();
  await page.getByRole("heading", { name: "Jobs" }).waitFor();
});

const views = await allViews(job);
await check("views do not jump as they open", () => figured(views));

await check("a large head turns with fewer pixels and triangles, and stands with all", () => framed(page));

await check("memory is steady while sliders are dragged", () => dragged(page, DRAGGED_S));

await reached(views);

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
console.log(`${counted.passed} passed, ${counted.failed} failed`);
process.exitCode = counted.failed === 0 ? 0 : 1;
