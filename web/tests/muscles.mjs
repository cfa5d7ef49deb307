// A face with muscles, that the program makes itself: their columns stand behind those of its segments.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtemp, readdir, rm } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { AGREED_MM, apart, BINARY, check, ended, fits, go, json, opened, pictured, planned, positions, serious, slide } from "./tools.mjs";

const SMILE = { zygomaticus_major_left: 20, zygomaticus_major_right: 20 };
let face;

/** The skin as the page draws it, from the answer of the service for the same plan. */
async function fromService(page, rest, plan) {
  const answer = await json(`/v1/cases/${face}/response/apply`, { plan: { frame: "LPS", ...plan } });
  assert(answer.max_mm > 0.5, `something moves: ${answer.max_mm}`);
  const moved = (await positions(page)).map((value, at) => value - rest[at]);
  return apart(answer.displacement_mm.flat(), moved);
}

export async function muscles(page) {
  let rest;
  await check("a face with muscles becomes a case, and its response has them by name", async () => {
    const folder = await mkdtemp(join(tmpdir(), "facies-face-"));
    execFileSync(BINARY, ["face", "--out", folder], { stdio: "ignore" });
    await go(page, "#/cases");
    await page.locator("input[data-files]").setInputFiles((await readdir(folder)).map((name) => join(folder, name)));
    await page.getByRole("heading", { name: "What the check found" }).waitFor();
    face = await page.evaluate(() => /case\/([0-9a-f-]+)/.exec(location.hash)[1]);
    await page.getByRole("link", { name: "Plan a movement" }).click();
    await planned(page);
    rest = await positions(page);
    const { inner_columns, columns } = await json(`/v1/cases/${face}/response`);
    assert.equal(columns.count, 24 + inner_columns.length);
    assert.equal(await page.locator("input[type=range][data-inner]").count(), inner_columns.length);
    await rm(folder, { recursive: true });
  });

  await check("a segment of a case with muscles moves the skin as the service does", async () => {
    await slide(page, "mandible", "forward", -5);
    const difference = await fromService(page, rest, { segments: [{ name: "mandible", translation_mm: [0, 5, 0] }] });
    assert(difference < AGREED_MM, `${difference} mm`);
  });

  await check("a muscle pulls as the service says, on both sides", async () => {
    const field = page.locator("input[type=number][data-inner=zygomaticus_major_left]");
    await field.fill("20");
    await field.dispatchEvent("change");
    const activations = Object.entries(SMILE).map(([muscle, stress_kpa]) => ({ muscle, stress_kpa }));
    const plan = { activations, segments: [{ name: "mandible", translation_mm: [0, 5, 0] }] };
    assert(!(await page.locator("input[type=range][data-inner=zygomaticus_major_right]").isVisible()), "both sides alike have one line");
    const difference = await fromService(page, rest, plan);
    assert(difference < AGREED_MM, `${difference} mm`);
    console.log(`   ${difference.toExponential(1)} mm from the service`);
    await page.locator(".trust.unknown", { hasText: "Error of the model" }).waitFor();
    await page.getByRole("link", { name: "nonlinearity-unknown" }).waitFor();
    assert.deepEqual(await serious(page), []);
    await pictured(page, "muscles");
    const moved = await positions(page);
    await page.reload();
    await planned(page);
    assert(apart(moved, await positions(page)) < AGREED_MM, "muscles stand in the address");
    await page.getByRole("button", { name: "Set to zero" }).click();
    assert(apart(rest, await positions(page)) === 0, "at rest nothing pulls");
    assert.equal(await field.inputValue(), "0");
  });

  await check("a muscle that the response does not have is refused by its name", async () => {
    await go(page, `#/case/${face}/plan?muscle=risorius,30;zygomaticus_major_left,20`);
    await planned(page);
    await page.getByRole("alert").getByText(/no column of risorius/).waitFor();
    const difference = await fromService(page, rest, { activations: [{ muscle: "zygomaticus_major_left", stress_kpa: 20 }] });
    assert(difference < AGREED_MM, `${difference} mm`);
    assert(await page.locator("input[type=range][data-inner=zygomaticus_major_right]").isVisible(), "sides that differ have a line each");
    await page.getByLabel("both sides alike").check();
    const activations = Object.entries(SMILE).map(([muscle, stress_kpa]) => ({ muscle, stress_kpa }));
    const alike = await fromService(page, rest, { activations });
    assert(alike < AGREED_MM, `the right side takes what the left has: ${alike} mm`);
  });

  await check("tissue grows as the service says, all of it and a layer beside it", async () => {
    await go(page, `#/case/${face}/plan?muscle=zygomaticus_major_left,20`);
    await planned(page);
    const named = await page.locator("input[type=range][data-inner]").count();
    await page.getByRole("button", { name: "Add growth of tissue" }).click();
    await page.locator("input[type=number][data-inner=fat]").waitFor();
    const all = await page.locator("input[type=range][data-inner]").evaluateAll((sliders) => sliders.map((one) => one.dataset.inner));
    assert(all.length > named && ["*", "fat", "zygomaticus_major_left"].every((name) => all.includes(name)), all.join());
    assert.equal(await page.locator("input[type=number][data-inner=zygomaticus_major_left]").inputValue(), "20", "the plan stays");
    assert.equal(await page.getByRole("button", { name: "Add growth of tissue" }).count(), 0);
    assert.equal((await ended({ kind: "response", case: face, growth: ["*", "fat"], muscles: ["orbicularis_oris"] })).status, "successful");
    await go(page, `#/case/${face}/plan?growth=*,-0.2&view=1`);
    await planned(page);
    await page.locator("input[type=number][data-inner=fat]").fill("10");
    const plan = { growth: [{ region: "*", volume_change: -0.2 }, { region: "fat", volume_change: 0.1 }] };
    const difference = await fromService(page, rest, plan);
    assert(difference < AGREED_MM, `${difference} mm`);
    await pictured(page, "growth");
  });

  await check("muscles at 390 pixels", async () => {
    const small = await opened({ width: 390, height: 844 });
    await go(small, `#/case/${face}/plan?muscle=zygomaticus_major_left,20;zygomaticus_major_right,20`);
    await planned(small);
    await fits(small);
    await pictured(small, "muscles-390");
    await small.context().close();
  });
}
