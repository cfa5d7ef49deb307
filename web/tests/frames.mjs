// Frames of a large head, and the memory of dragging: what both take, for tests and by hand.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { addressed, go, plan, planned, slider } from "./tools.mjs";

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

/** The heap of script in MB, after collecting garbage. */
async function heap(page) {
  const session = await page.context().newCDPSession(page);
  for (let round = 0; round < 3; round += 1) await session.send("HeapProfiler.collectGarbage");
  const { usedSize } = await session.send("Runtime.getHeapUsage");
  await session.detach();
  return usedSize / 1e6;
}

/** Drags sliders and turns the head for so long; tells the heap and says when it grows. */
export async function dragged(page, seconds) {
  await go(page, `${plan}?view=1&map=displacement`);
  await planned(page);
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
  console.log(`   ${steps} steps of sliders in ${seconds} s: heap ${marks.map((mark) => mark.toFixed(2)).join(", ")} MB`);
  assert(marks.at(-1) - before < KEPT_MB, `${before} MB became ${marks.at(-1)} MB`);
  await addressed(page, /p=mandible/);
}
