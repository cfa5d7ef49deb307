// Cuts of bone: placed in the view of a scan and of a surface by handle, by points and by numbers, and sent as the document that they are.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { check, fits, go, json, pictured, serious, address, HEAD } from "./tools.mjs";

const said = async (page) => JSON.parse(await page.getByLabel("Case document").inputValue()).meshing;
const named = (list, name) => list.find((one) => one.name === name);
/** Where a cut's handle is seen, and the numbers of its plane. */
const handle = (page, at_mm) => page.evaluate((point) => document.querySelector(".cuts .screen").scene.seenAt(point), at_mm);

/** Drops files as a person does. */
const dropped = (page, files) => page.locator(".drop").evaluate((drop, parts) => {
  const dataTransfer = new DataTransfer();
  for (const [name, content] of parts) dataTransfer.items.add(new File([Uint8Array.from(atob(content), (letter) => letter.charCodeAt(0))], name));
  drop.dispatchEvent(new DragEvent("drop", { dataTransfer, bubbles: true }));
}, files.map(([name, content]) => [name, content.toString("base64")]));

export async function cuts(page, job) {
  await check("cuts of a surface of bone are placed by handle, by points and by numbers, without any JSON by hand", async () => {
    await go(page, "#/jobs");
    await go(page, "#/cases");
    const skin = Buffer.from(await (await fetch(`${address}/v1/jobs/${job}/results/skin.vtp`)).arrayBuffer());
    await dropped(page, [["face_skin.vtp", skin], ["bone.vtp", readFileSync(`${HEAD}mandible.vtp`)]]);
    const place = page.getByRole("button", { name: "Place cuts in the view" });
    await page.getByText("Cuts can be placed where one surface is all bone and the frame is stated").waitFor();
    assert(!await place.isVisible());
    await page.getByLabel("Frame").selectOption("LPS");
    await place.click();
    await page.getByLabel("Le Fort I: the upper jaw").check();
    await page.getByLabel("Both rami: the lower jaw").check();
    const before = await said(page);
    assert.deepEqual(before.osteotomy.cuts.map(({ name }) => name), ["le-fort-1", "pterygomaxillary", "ramus-right", "ramus-left", "ramus-horizontal"]);
    assert.deepEqual(before.osteotomy.segments, [{ name: "maxilla", below: ["le-fort-1"], above: ["pterygomaxillary"] }, { name: "mandible", below: ["ramus-horizontal"], above: ["ramus-right", "ramus-left"] }]);
    assert.equal(before.frame, "LPS");
    assert.match(before.surfaces.bone, /^[0-9a-f-]{36}$/);
    // The handle, seen from the front: to the right of the window is the patient's left, +x, and up is +z.
    await page.locator(".cuts").getByRole("button", { name: "1: Front" }).click();
    // What a pointer takes has to be in the window.
    await page.locator(".cuts canvas").scrollIntoViewIfNeeded();
    const cut = named(before.osteotomy.cuts, "le-fort-1");
    const [x, y] = await handle(page, cut.point_mm);
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move(x + 20, y - 30, { steps: 4 });
    await page.mouse.up();
    const dragged = named((await said(page)).osteotomy.cuts, "le-fort-1");
    assert(dragged.point_mm[0] > cut.point_mm[0] + 1 && dragged.point_mm[2] > cut.point_mm[2] + 1 && Math.abs(dragged.point_mm[1] - cut.point_mm[1]) < 0.2, `${cut.point_mm} became ${dragged.point_mm}`);
    assert.equal(await page.getByLabel("Le Fort I: Up, mm").inputValue(), String(Number(dragged.point_mm[2].toFixed(1))));
    // Numbers, in words: forward is -y in LPS, and a plane whose front goes up leans its normal back.
    await page.getByLabel("Le Fort I: Forward, mm").fill("12.5");
    await page.getByLabel("Le Fort I: Pitch, °").fill("30");
    await page.getByLabel("Right ramus: Saw, width, mm").fill("1");
    const written = (await said(page)).osteotomy.cuts;
    assert.equal(named(written, "le-fort-1").point_mm[1], -12.5);
    assert.deepEqual(named(written, "le-fort-1").normal, [0, 0.5, 0.866]);
    assert.equal(named(written, "ramus-right").kerf_mm, 1);
    // Three points by keys: those that the middle of the view meets lie on the plane.
    await page.getByRole("button", { name: "Left ramus: Through three points" }).click();
    const canvas = page.locator(".cuts canvas");
    /** Turns on until bone is in the middle, and takes that place. */
    const takenByKeys = async (keys) => {
      for (const key of keys) await canvas.press(key);
      const middle = () => page.evaluate(() => document.querySelector(".cuts .screen").scene.middle()?.point_mm);
      for (let turns = 0; turns < 48 && await middle() === undefined; turns += 1) await canvas.press("ArrowDown");
      const point = await middle();
      assert(point !== undefined, `no bone in the middle of view ${keys} nor of any view down from it`);
      await canvas.press("Enter");
      return point;
    };
    const points = [await takenByKeys(["2"]), await takenByKeys(["3"]), await takenByKeys(["1"])];
    const through = named((await said(page)).osteotomy.cuts, "ramus-left");
    assert(through.normal[1] < 0, "it still faces forward");
    for (const point of points) {
      const off = point.reduce((sum, value, axis) => sum + (value - through.point_mm[axis]) * through.normal[axis], 0);
      assert(Math.abs(off) < 0.3, `${off} mm beside the plane`);
    }
    // A jaw is pointed at.
    await page.getByRole("button", { name: "Point at the lower jaw" }).click();
    const jaw = await takenByKeys(["1"]);
    const [seed] = named((await said(page)).osteotomy.segments, "mandible").seeds_mm;
    assert(Math.hypot(...seed.map((value, axis) => value - jaw[axis])) < 0.3, `${seed}`);
    assert.deepEqual(await serious(page), []);
    await fits(page);
    await pictured(page, "cuts-surface");
    const document = await said(page);
    await page.getByRole("button", { name: "Send" }).click();
    await page.waitForFunction(() => location.hash.startsWith("#/case/"));
    const made = await json(`/v1/cases/${await page.evaluate(() => /case\/([0-9a-f-]+)/.exec(location.hash)[1])}`);
    const { cuts: sent, segments } = document.osteotomy;
    assert.deepEqual([made.case.meshing.osteotomy.cuts, made.case.meshing.osteotomy.segments], [sent, segments]);
    assert.equal(made.case.meshing.surfaces.bone, document.surfaces.bone);
    // It does not run on behind what is timed later.
    await fetch(`${address}/v1/jobs/${made.meshing.job}`, { method: "DELETE" });
  });

  await check("bone of a scan is drawn from its values, and its cuts are written beside what was changed by hand", async () => {
    await go(page, "#/jobs");
    await go(page, "#/cases");
    await page.locator("input[data-files]").setInputFiles([`${HEAD}ct.nrrd`]);
    const text = page.getByLabel("Case document");
    await text.waitFor();
    const document = JSON.parse(await text.inputValue());
    const image = (await json(`/v1/meshes/${document.meshing.scan}`)).report.image;
    const bone = Math.round((image.lowest_hu + image.highest_hu) / 2);
    await text.fill(JSON.stringify({ ...document, name: "by hand", meshing: { ...document.meshing, size: { tetrahedra: 20000 } } }));
    await page.getByLabel("Bone from").fill(String(bone));
    await page.getByRole("button", { name: "Place cuts in the view" }).click();
    await page.getByLabel("Le Fort I: the upper jaw").check();
    const written = JSON.parse(await text.inputValue());
    assert.deepEqual([written.name, written.meshing.size.tetrahedra, written.meshing.thresholds_hu.bone, written.meshing.frame], ["by hand", 20000, bone, "LPS"]);
    // The drawn surface lies between voxels at or above the value and those below, in the place that the file says.
    const box = await page.evaluate(() => {
      const points = document.querySelector(".cuts .screen").scene.resting.points_mm;
      return [0, 1, 2].map((axis) => [0, 1].map((end) => points.filter((_, at) => at % 3 === axis).reduce((most, value) => (end === 0 ? Math.min : Math.max)(most, value))));
    });
    const reach = image.size.map((count, axis) => [image.origin_mm[axis] - image.spacing_mm[axis], image.origin_mm[axis] + count * image.spacing_mm[axis]]);
    assert(box.every(([low, high], axis) => low > reach[axis][0] && high < reach[axis][1] && high - low > 20), JSON.stringify([box, reach]));
    const [place] = written.meshing.osteotomy.cuts;
    assert(place.point_mm.every((value, axis) => value > box[axis][0] && value < box[axis][1]), "it begins within the bone");
    assert.deepEqual(await serious(page), []);
    await fits(page);
    await pictured(page, "cuts-scan");
    // Others begin at the list of cases.
    await go(page, "#/jobs");
  });
}
