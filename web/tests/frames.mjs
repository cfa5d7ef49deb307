// Frames of a large head, and the memory of dragging: what both take, for tests and by hand.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { addressed, go, json, opened, plan, planned, slider, address, caseId } from "./tools.mjs";

/** Script may keep so much more after than before, in MB: what the browser keeps for itself. */
const KEPT_MB = 1.5;

/** Puts a closed shell of 60 024 triangles in the place of the skin, as large as that was. */
const shell = (page) => page.evaluate(() => {
  const { scene } = document.querySelector(".screen");
  const rest = scene.resting.points_mm;
  const [rings, sides] = [122, 246];
  const spans = [0, 1, 2].map((axis) => {
    let [low, high] = [Infinity, -Infinity];
    for (let at = axis; at < rest.length; at += 3) { low = Math.min(low, rest[at]); high = Math.max(high, rest[at]); }
    return [(low + high) / 2, (high - low) / 2];
  });
  const points = [];
  const triangles = [];
  for (let ring = 0; ring <= rings; ring += 1) {
    for (let side = 0; side < sides; side += 1) {
      const [down, about] = [(Math.PI * (ring + 0.01)) / (rings + 0.02), (2 * Math.PI * side) / sides];
      const swell = 1 + 0.05 * Math.sin(8 * down) * Math.sin(6 * about);
      [Math.sin(down) * Math.cos(about), Math.sin(down) * Math.sin(about), Math.cos(down)].forEach((one, axis) => points.push(spans[axis][0] + spans[axis][1] * one * swell));
      if (ring === rings) continue;
      const [a, b] = [ring * sides + side, ring * sides + (side + 1) % sides];
      triangles.push(a, a + sides, b, b, a + sides, b + sides);
    }
  }
  scene.showSkin({ points_mm: new Float32Array(points), triangles: new Uint32Array(triangles) });
  scene.view("1");
  return triangles.length / 3;
});

/** Turns the head by keys: times in ms from frame to frame as they are shown, and with each read back before the next, and what was drawn. */
const turned = (page, frames, isWhole) => page.evaluate(async ([count, whole]) => {
  const { scene } = document.querySelector(".screen");
  const gl = scene.renderer.getContext();
  const usual = Object.getPrototypeOf(scene).hasten;
  scene.hasten = whole ? () => {} : usual;
  const turn = (at) => scene.turnByKey({ key: at % 24 < 12 ? "ArrowRight" : "ArrowLeft", preventDefault: () => {} });
  const frame = () => new Promise((done) => { requestAnimationFrame(done); });
  turn(0); await frame(); turn(0); await frame();
  const script = [];
  const measure = async (waited) => {
    const times = [];
    let last = performance.now();
    for (let at = 0; at < count; at += 1) {
      const begun = performance.now();
      turn(at);
      script.push(performance.now() - begun);
      await frame();
      waited();
      const now = performance.now();
      times.push(now - last);
      last = now;
    }
    times.sort((a, b) => a - b);
    return { median: times[count >> 1], p95: times[Math.floor(0.95 * count)] };
  };
  const shown = await measure(() => {});
  const readBack = await measure(() => gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4)));
  const drawn = { triangles: scene.skin.geometry.index.count / 3, pixels: scene.canvas.width * scene.canvas.height };
  delete scene.hasten;
  scene.settle();
  script.sort((a, b) => a - b);
  return { shown, readBack, script: script[count], ...drawn };
}, [frames, isWhole]);

/** Processor time of the process that draws, so far, in ms. */
async function drawing_ms(session) {
  const { processInfo } = await session.send("SystemInfo.getProcessInfo");
  return 1000 * processInfo.find(({ type }) => type === "GPU").cpuTime;
}

/** With the processor time of a frame, which does not depend on what else the machine does. */
async function timed(page, frames, isWhole) {
  const session = await page.context().browser().newBrowserCDPSession();
  const before = await drawing_ms(session);
  const told = await turned(page, frames, isWhole);
  const cpu_ms = (await drawing_ms(session) - before) / (2 * frames + 2);
  await session.detach();
  return { ...told, cpu_ms };
}

export async function framed(page, frames = 20) {
  await go(page, `${plan}?view=1`);
  await planned(page);
  assert(await shell(page) >= 60_000);
  const all = await timed(page, frames, true);
  const few = await timed(page, frames, false);
  for (const [name, one] of Object.entries({ all, few })) {
    const told = ({ median, p95 }) => `${median.toFixed(0)} ms median, ${p95.toFixed(0)} ms p95`;
    console.log(`   ${name}: ${one.triangles} triangles, ${one.pixels} pixels, a frame ${told(one.shown)}; read back ${told(one.readBack)}; drawn in ${one.cpu_ms.toFixed(0)} ms of processor time; script ${one.script.toFixed(2)} ms, load ${load()}`);
  }
  assert(all.triangles >= 60_000 && few.triangles < 15_000 && few.pixels < all.pixels / 3, JSON.stringify({ all, few }));
  // What stands is drawn whole.
  const stands = await page.evaluate(() => { const { scene } = document.querySelector(".screen"); scene.drawNow(); return [scene.skin.geometry.index.count / 3, scene.canvas.width * scene.canvas.height]; });
  assert.deepEqual(stands, [all.triangles, all.pixels]);
}

const load = () => readFileSync("/proc/loadavg", "utf8").split(" ")[0];

/** The heap of script and its array buffers in MB, after collecting garbage. */
async function heap(page) {
  const session = await page.context().newCDPSession(page);
  for (let round = 0; round < 3; round += 1) await session.send("HeapProfiler.collectGarbage");
  const { usedSize, backingStorageSize } = await session.send("Runtime.getHeapUsage");
  await session.detach();
  return { script: usedSize / 1e6, arrays: backingStorageSize / 1e6 };
}

/** Drags sliders and turns the head for so long on a response of an order, with the colours of what that leaves out where it knows them;
 * tells the heap and says when it grows. */
export async function dragged(page, seconds, order = 2) {
  await go(page, "#/cases");
  // What is asked for in the background would be a response of another order.
  if (order === 1) await page.evaluate((id) => sessionStorage.setItem("facies-second-stopped", id), caseId);
  await go(page, `${plan}?view=1&map=${order === 2 ? "left" : "displacement"}`);
  await planned(page);
  await page.locator(".badge", { hasText: order === 2 ? "Second order" : "Linear" }).waitFor();
  const lines = await Promise.all(["forward", "up", "yaw"].map(async (word) => slider(page, "mandible", word).boundingBox()));
  let steps = 0;
  const drag = async () => {
    for (const line of lines) {
      await page.mouse.move(line.x + line.width / 2, line.y + line.height / 2);
      await page.mouse.down();
      for (const share of [0.6, 0.7, 0.55, 0.5, 0.4]) { await page.mouse.move(line.x + share * line.width, line.y + line.height / 2); steps += 1; }
      await page.mouse.up();
    }
    await page.locator(".screen canvas").focus();
    for (const key of ["ArrowLeft", "ArrowUp", "ArrowDown", "ArrowRight"]) await page.keyboard.press(key);
  };
  // The first drags compile, and fill what is kept once.
  const end = (share) => Date.now() + 1000 * seconds * share;
  for (const first = end(0.2); Date.now() < first;) await drag();
  const before = await heap(page);
  const marks = [before];
  for (let part = 1; part <= 8; part += 1) {
    for (const until = end(0.1); Date.now() < until;) await drag();
    marks.push(await heap(page));
  }
  const told = (kind) => marks.map((mark) => mark[kind].toFixed(2)).join(", ");
  console.log(`   ${steps} steps of sliders in ${seconds} s, order ${order}: heap ${told("script")} MB, array buffers ${told("arrays")} MB, load ${load()}`);
  for (const kind of ["script", "arrays"]) assert(marks.at(-1)[kind] - before[kind] < KEPT_MB, `${kind}: ${before[kind]} MB became ${marks.at(-1)[kind]} MB`);
  await addressed(page, /p=mandible/);
}

const NODES = 14_200;

/** The surface of a GLB file as the service writes it: a closed shell of so many nodes or a few less. */
function shellOf(nodes) {
  const sides = Math.round(Math.sqrt(nodes * 2));
  const rings = Math.floor(nodes / sides) - 1;
  const points = [];
  const triangles = [];
  for (let ring = 0; ring <= rings; ring += 1) {
    for (let side = 0; side < sides; side += 1) {
      const [down, about] = [(Math.PI * (ring + 0.01)) / (rings + 0.02), (2 * Math.PI * side) / sides];
      points.push(70 * Math.sin(down) * Math.cos(about), 90 * Math.sin(down) * Math.sin(about), 100 * Math.cos(down));
      if (ring === rings) continue;
      const [a, b] = [ring * sides + side, ring * sides + (side + 1) % sides];
      triangles.push(a, a + sides, b, b, a + sides, b + sides);
    }
  }
  const binary = Buffer.concat([Float32Array.from(points), Uint32Array.from(triangles)].map((array) => Buffer.from(array.buffer)));
  const bytes = 4 * points.length;
  const text = JSON.stringify({
    asset: { version: "2.0" }, meshes: [{ primitives: [{ attributes: { POSITION: 0 }, indices: 1 }] }], buffers: [{ byteLength: binary.length }],
    accessors: [{ bufferView: 0, componentType: 5126, count: points.length / 3, type: "VEC3" }, { bufferView: 1, componentType: 5125, count: triangles.length, type: "SCALAR" }],
    bufferViews: [{ buffer: 0, byteOffset: 0, byteLength: bytes }, { buffer: 0, byteOffset: bytes, byteLength: binary.length - bytes }],
    extras: { matrix4x4_to_case_row_major: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1] },
  });
  const json = Buffer.from(text.padEnd(Math.ceil(text.length / 4) * 4));
  const head = (length, kind) => { const own = Buffer.alloc(8); own.writeUInt32LE(length, 0); own.writeUInt32LE(kind, 4); return own; };
  const body = Buffer.concat([head(json.length, 0x4e4f534a), json, head(binary.length, 0x004e4942), binary]);
  const start = Buffer.alloc(12);
  [0x46546c67, 2, 12 + body.length].forEach((one, at) => start.writeUInt32LE(one, 4 * at));
  return { glb: Buffer.concat([start, body]), nodes: points.length / 3 };
}

/** Answers in the place of the service for a response of so many nodes and two segments, whose columns are made up: times are those of any. */
async function largeResponse(page, order) {
  const real = await json(`/v1/cases/${caseId}/response`);
  const { glb, nodes } = shellOf(NODES);
  const [linear, pairs] = [24, 300];
  const columns = Float32Array.from({ length: linear * 3 * nodes }, (_, at) => Math.sin(at) / 10);
  const second = Int16Array.from({ length: order === 2 ? pairs * 3 * nodes : 0 }, (_, at) => (at * 7919) % 30_000 - 15_000);
  const layout = (number) => `${number} little-endian [column][node][xyz]`;
  const description = {
    ...real, node_ids: Array.from({ length: nodes }, (_, node) => node), columns: { ...real.columns, layout: layout("f32"), count: linear }, inner_columns: [], second_order: undefined,
    ...(order === 2 ? { second_order: { columns: { ...real.columns, layout: layout("i16"), count: pairs }, scale_mm: new Array(pairs).fill(1e-5) } } : {}),
  };
  const answer = (route) => {
    const { accept } = route.request().headers();
    if (accept === "model/gltf-binary") return route.fulfill({ contentType: accept, body: glb });
    if (accept !== "application/octet-stream") return route.fulfill({ json: description });
    return route.fulfill({ contentType: accept, body: Buffer.from(route.request().url().includes("order=2") ? second.buffer : columns.buffer) });
  };
  const applied = { job: real.job, displacement_mm: Array.from({ length: nodes }, () => [0, 0, 0]), node_ids: [], warnings: [], max_mm: 0, largest_rotation_deg: 0, order, within_linear_range: true };
  const [there, apply] = [({ pathname }) => pathname === `/v1/cases/${caseId}/response`, ({ pathname }) => pathname === `/v1/cases/${caseId}/response/apply`];
  await page.route(there, answer);
  await page.route(apply, (route) => route.fulfill({ json: applied }));
  return { nodes, gone: async () => { await page.unroute(there); await page.unroute(apply); } };
}

/** Steps of a slider between two frames are one picture: what a frame costs does not grow with how fast somebody drags. */
export async function stepped(page) {
  await page.evaluate(() => performance.clearMeasures());
  const { drawn, nodes } = await page.evaluate(async () => {
    const { scene } = document.querySelector(".screen");
    const input = document.querySelector("details.segment input[type=range][data-word=yaw]");
    const usual = Object.getPrototypeOf(scene).render;
    let pictures = 0;
    scene.render = function render() { pictures += 1; usual.call(this); };
    for (let step = 0; step < 40; step += 1) { input.value = String(step / 10); input.dispatchEvent(new Event("input", { bubbles: true })); }
    await new Promise((done) => { requestAnimationFrame(() => requestAnimationFrame(done)); });
    delete scene.render;
    return { drawn: pictures, nodes: scene.skinPositions_mm.length / 3 };
  });
  const took = await page.evaluate(() => performance.getEntriesByName("slider", "measure").map(({ duration }) => duration).sort((a, b) => a - b));
  // Times are printed and not judged: the machine does other things too.
  console.log(`   script of a slider's step: median ${took[took.length >> 1].toFixed(1)} ms, longest ${took.at(-1).toFixed(1)} ms, ${took.length} steps, ${nodes} nodes`);
  assert.equal(took.length, 40);
  assert(drawn >= 1 && drawn <= 2, `${drawn} pictures of two frames`);
}

/** Processor time of script in a page, so far, in ms: it does not depend on what else the machine does. */
async function scripted(page) {
  const session = await page.context().newCDPSession(page);
  await session.send("Performance.enable", { timeDomain: "threadTicks" });
  return async () => {
    const { metrics } = await session.send("Performance.getMetrics");
    return 1000 * metrics.find(({ name }) => name === "ScriptDuration").value;
  };
}

/** Script of a slider's frame: of its step and of the picture after it. */
export async function slid(page) {
  for (const order of [1, 2]) {
    const { nodes, gone } = await largeResponse(page, order);
    await go(page, "#/jobs");
    await go(page, `${plan}?p=mandible,-4,1,0,3,0,0;maxilla,3,1,0,2,1,0&map=displacement&view=1`);
    await planned(page);
    const spent = await scripted(page);
    const before = await spent();
    const took = await page.evaluate(async () => {
      const { scene } = document.querySelector(".screen");
      const input = document.querySelectorAll("details.segment")[1].querySelector("input[type=range][data-word=yaw]");
      const frame = () => new Promise((done) => { requestAnimationFrame(() => requestAnimationFrame(done)); });
      const found = [];
      let drawn = 0;
      const usual = Object.getPrototypeOf(scene).render;
      scene.render = function render() { const begun = performance.now(); usual.call(this); drawn += performance.now() - begun; };
      for (let step = 0; step < 60; step += 1) {
        drawn = 0;
        const begun = performance.now();
        input.value = String(step / 20);
        input.dispatchEvent(new Event("input", { bubbles: true }));
        const moved = performance.now() - begun;
        await frame();
        found.push(moved + drawn);
      }
      delete scene.render;
      return found.sort((a, b) => a - b);
    });
    const cpu_ms = (await spent() - before) / took.length;
    const [median, longest] = [took[took.length >> 1], took.at(-1)];
    console.log(`   order ${order}: script of a slider's frame, ${nodes} nodes, two segments that turn: median ${median.toFixed(1)} ms, longest ${longest.toFixed(1)} ms of ${took.length}; ${cpu_ms.toFixed(1)} ms of processor time in the mean, load ${load()}`);
    // Times are printed and not judged: how many nodes move with a slider does not depend on the machine.
    assert(nodes >= 14_000 && took.length === 60, `order ${order}: ${nodes} nodes`);
    await gone();
  }
}

/** Nothing of a view jumps by more than this as it opens, as a share of the window: what counts as good. */
const JUMPS = 0.1;
/** Above this it is printed what it was. */
const TOLD_JUMP = 0.03;
/** Whoever waits sees what is there after the last answer, in ms. */
const SETTLED_MS = 700;

/** What a browser measures of a view as it opens, as Lighthouse does: largest contentful paint, cumulative layout shift with what shifts most,
 * and the time that tasks block it. */
async function figuresOf(path, { there, size }) {
  const page = await opened(size);
  await page.addInitScript(() => {
    const told = { paint: 0, shift: 0, blocked: 0, most: { value: 0, of: [] } };
    window.told = told;
    const watch = (type, note) => new PerformanceObserver((list) => list.getEntries().forEach(note)).observe({ type, buffered: true });
    const called = ({ node, previousRect: { x, y, width, height }, currentRect: now }) => `${node?.nodeName} ${node?.className ?? ""} ${[x, y, width, height].map(Math.round)} to ${[now.x, now.y, now.width, now.height].map(Math.round)}`;
    watch("largest-contentful-paint", ({ startTime }) => { told.paint = startTime; });
    watch("layout-shift", ({ value, hadRecentInput, sources }) => {
      if (hadRecentInput) return;
      told.shift += value;
      if (value > told.most.value) told.most = { value, of: sources.map(called) };
    });
    watch("longtask", ({ duration }) => { told.blocked += Math.max(0, duration - 50); });
  });
  await page.goto(`${address}/${path}`);
  await page.locator(there).first().waitFor();
  await page.locator(".loading").waitFor({ state: "detached" });
  await page.waitForFunction(() => window.told.paint > 0);
  await page.waitForTimeout(SETTLED_MS);
  const told = await page.evaluate(() => window.told);
  await page.context().close();
  return told;
}

/** How far what is seen jumps as a view opens is a count of pixels, and judged; times are printed. */
export async function figured(views) {
  const wrong = [];
  for (const size of [{ width: 1280, height: 800 }, { width: 390, height: 844 }]) {
    for (const [name, path] of Object.entries(views)) {
      const { paint, shift, blocked, most } = await figuresOf(path, { there: name === "plan" ? ".strip[data-apart]" : "#stage > *", size });
      console.log(`   ${name}, ${size.width} px: largest contentful paint ${paint.toFixed(0)} ms, layout shift ${shift.toFixed(3)}, blocked ${blocked.toFixed(0)} ms, load ${load()}`);
      if (shift >= TOLD_JUMP) console.log(`      ${most.value.toFixed(3)} of ${most.of.join("; ")}`);
      if (shift >= JUMPS) wrong.push(`${name}, ${size.width} px: ${shift.toFixed(3)}, most ${most.value.toFixed(3)} of ${most.of.join("; ")}`);
    }
  }
  assert.deepEqual(wrong, []);
}
