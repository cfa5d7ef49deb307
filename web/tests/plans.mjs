// Stored plans by their names, two of them compared, a view that an address opens again.
import assert from "node:assert/strict";
import { addressed, apart, check, ended, excused, fits, go, json, opened, pictured, planned, positions, serious, slide, slider, address, caseId, plan, AGREED_MM } from "./tools.mjs";

const stored = async () => (await json(`/v1/cases/${caseId}/plans`)).items;
const kept = (name, translation_mm) => json(`/v1/cases/${caseId}/plans`, { name, frame: "LPS", segments: [{ name: "mandible", translation_mm }] });
const row = (page, caption, name) => page.locator("table", { has: page.locator("caption", { hasText: caption }) })
  .locator("tbody tr", { has: page.getByRole("rowheader", { name, exact: true }) }).locator("td").allTextContents();

/** Where the camera stands, what it sees in the middle, and how large. */
const seen = (page) => page.evaluate(() => {
  const { scene } = document.querySelector(".screen");
  const { camera, controls } = scene;
  const from = camera.position.clone().sub(controls.target).normalize().toArray();
  return { numbers: [...from, camera.zoom, ...controls.target.toArray().map((value) => value / 100)], pixel: scene.pixelsPerMm, middle: scene.middle()?.point_mm };
});

export async function plans(page) {
  await check("a plan has a name, is opened again by its address, and saved over", async () => {
    await go(page, `${plan}?p=mandible,-6,0,0,3,0,0`);
    await planned(page);
    await page.getByLabel("Name of the plan").fill("jaw back");
    await page.getByLabel("Name of the plan").press("Enter");
    await page.getByRole("status").getByText("jaw back is saved.").waitFor();
    const [first] = await stored();
    assert.equal(first.plan.name, "jaw back");
    await slide(page, "mandible", "forward", -4);
    await page.getByRole("button", { name: "Save over jaw back" }).click();
    await page.waitForFunction(() => document.querySelectorAll(".plans [data-plan]").length === 1);
    await page.locator(".plans .name", { hasText: "back 4 mm" }).waitFor();
    const [again] = await stored();
    assert.deepEqual([again.id, again.version, again.plan.segments[0].translation_mm], [first.id, 2, [0, 4, 0]]);
    // The address of the stored plan alone says its movements.
    await go(page, "#/jobs");
    await go(page, `${plan}?plan=${first.id}`);
    await planned(page);
    assert.deepEqual([await slider(page, "mandible", "forward").inputValue(), await slider(page, "mandible", "pitch").inputValue()], ["-4", "3"]);
    assert.deepEqual(await serious(page), []);
    await fits(page);
    await pictured(page, "plans-saved");
    // Somebody else saved it meanwhile: theirs stays.
    excused.push(/status of 412/);
    const theirs = { name: "jaw back", segments: [{ name: "mandible", translation_mm: [0, 1, 0] }] };
    await fetch(`${address}/v1/cases/${caseId}/plans/${first.id}`, { method: "PUT", headers: { "Content-Type": "application/json", "If-Match": "*" }, body: JSON.stringify(theirs) });
    await page.getByRole("button", { name: "Save over jaw back" }).click();
    await page.getByRole("alert").getByRole("link", { name: "precondition-failed" }).waitFor();
    assert.deepEqual((await stored())[0].plan, theirs);
  });

  await check("two stored plans are compared by region and by their numbers, overlaid and side by side", async () => {
    const [a, b] = [await kept("six back", [0, 6, 0]), await kept("three forward", [0, -3, 1])];
    await go(page, plan);
    await planned(page);
    // On the linear response, whose answers to differences of plans are differences of its answers.
    const linear = (await json(`/v1/jobs?kind=response&status=successful&case=${caseId}`)).items.at(-1).id;
    const newest = ({ pathname, search }) => pathname === `/v1/cases/${caseId}/response` && search === "";
    await page.route(newest, (route) => route.continue({ url: `${route.request().url()}?job=${linear}` }));
    await page.getByRole("link", { name: "Compare two plans" }).click();
    await page.getByLabel("First plan").selectOption(a.id);
    await page.getByLabel("Second plan").selectOption(b.id);
    await addressed(page, new RegExp(`a=${a.id}&b=${b.id}`));
    await page.getByRole("columnheader", { name: "three forward, mean" }).waitFor();
    // The skin is linear in translations: how far both are apart is what their difference moves.
    const moved = async (translation_mm) => (await ended({ kind: "predict", case: caseId, method: "fem_linear", plan: { segments: [{ name: "mandible", translation_mm }] } })).results.statistics;
    const [first, second, between] = [await moved([0, 6, 0]), await moved([0, -3, 1]), await moved([0, -9, 1])];
    for (const [name, of] of [["whole skin", ({ skin }) => skin.area], ["chin", ({ regions }) => regions.chin.area], ["lips", ({ regions }) => regions.lips.area]]) {
      const told = (await row(page, "How far the skin moves", name)).map(Number);
      const wanted = [of(first).mean, of(second).mean, of(between).mean, of(between).p95, of(between).max];
      assert(wanted[2] > 0.5 && apart(told, wanted) < 0.006, `${name}: ${told} instead of ${wanted}`);
    }
    assert.deepEqual(await row(page, "Numbers of both plans", "mandible forward, mm"), ["-6", "3", "9"]);
    assert.deepEqual(await row(page, "Numbers of both plans", "mandible up, mm"), ["0", "1", "1"]);
    await page.getByRole("status").getByText(`apart in the mean and ${between.skin.area.max.toFixed(2)} mm at most`).waitFor();
    assert.deepEqual(await serious(page), []);
    await pictured(page, "plans-overlaid");
    await page.getByText("side by side", { exact: true }).click();
    await addressed(page, /show=sides/);
    const rest = await page.evaluate(() => [...document.querySelector(".screen").scene.resting.points_mm]);
    const applied = async (of) => (await json(`/v1/cases/${caseId}/response/apply?job=${linear}`, { plan: of.plan })).displacement_mm.flat();
    const left = await page.evaluate(() => [...document.querySelector(".screen").scene.twin.geometry.attributes.position.array]);
    assert(apart(left.map((value, at) => value - rest[at]), await applied(a)) < AGREED_MM, "the first on the left");
    assert(apart((await positions(page)).map((value, at) => value - rest[at]), await applied(b)) < AGREED_MM, "the second on the right");
    assert.deepEqual(await page.locator(".halves span").allTextContents(), ["six back", "three forward"]);
    await pictured(page, "plans-beside");
    await page.unroute(newest);
    const small = await opened({ width: 390, height: 844 }, { locale: "de-DE", colorScheme: "dark" });
    await go(small, `#/case/${caseId}/plans?a=${a.id}&b=${b.id}`);
    await small.getByRole("heading", { name: "Zahlen beider Pläne" }).waitFor();
    await fits(small);
    assert.deepEqual(await serious(small), []);
    await pictured(small, "plans-390-dark-german");
    await small.context().close();
    await page.getByRole("link", { name: "Load six back" }).click();
    await planned(page);
    assert.equal(await slider(page, "mandible", "forward").inputValue(), "-6");
  });

  await check("a head that was turned by hand stands in the address, which opens the same view", async () => {
    await go(page, `${plan}?view=1`);
    await planned(page);
    const box = await page.locator(".screen canvas").boundingBox();
    const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move(x + 90, y + 40, { steps: 5 });
    await page.mouse.up();
    await page.mouse.wheel(0, -240);
    await page.locator(".screen canvas").focus();
    for (const key of ["ArrowLeft", "+"]) await page.keyboard.press(key);
    // It is written once the head stands.
    await page.waitForFunction(() => {
      const said = new URLSearchParams(location.hash.split("?")[1]).get("camera");
      return said !== null && said === document.querySelector(".screen").scene.turnedTo.join(",");
    });
    const here = await seen(page);
    assert(Math.abs(here.numbers[0]) > 0.1 && here.numbers[3] > 1.1, JSON.stringify(here));
    const other = await opened();
    await other.goto(page.url());
    await planned(other);
    const there = await seen(other);
    assert(apart(here.numbers, there.numbers) < 2e-3 && Math.abs(here.pixel / there.pixel - 1) < 1e-3, JSON.stringify([here, there]));
    assert(apart(here.middle, there.middle) < 0.5, "the same place in the middle");
    await other.context().close();
    await page.keyboard.press("1");
    await addressed(page, /camera=/, false);
  });
}
