// Answers that lack something or are of something else: results without the file that is drawn, responses of other materials than the case
// states, studies that do not pass.
import assert from "node:assert/strict";
import { moved } from "./compared.mjs";
import { block, boxOf } from "./facts.mjs";
import { addressed, check, ended, go, json, pictured, planned, positions, serious } from "./tools.mjs";

const successful = (job) => { assert.equal(job.status, "successful", JSON.stringify(job.error)); return job; };
const PLAN = { segments: [{ name: "mandible", translation_mm: [0, 1, 0] }] };

export async function answers(page) {
  const of = await block({ name: "answers" });

  await check("a result without skin.glb is drawn from skin.vtp as it is from skin.glb", async () => {
    const [vtp, glb] = await Promise.all(["skin.vtp", "skin.glb"].map((file) => ended({ kind: "predict", case: of, method: "fem_linear", plan: PLAN, outputs: [file] })));
    const drawn = async ({ id }) => {
      await go(page, `#/job/${id}`);
      await page.getByRole("heading", { name: "Before and after" }).waitFor();
      const after = await positions(page);
      await page.getByRole("button", { name: "Before", exact: true }).click();
      return [after, await positions(page), await page.locator(".tools select option").allTextContents()];
    };
    const [after, before, maps] = await drawn(successful(vtp));
    const [other, rest] = await drawn(successful(glb));
    const apart = (a, b) => a.reduce((most, value, at) => Math.max(most, Math.abs(value - b[at])), 0);
    assert(after.length === other.length && apart(after, other) < 1e-4 && apart(before, rest) < 1e-4, `${apart(after, other)} ${apart(before, rest)}`);
    assert(apart(after, before) > 0.5 && maps.includes("Displacement"), maps.join());
  });

  await check("a result that nothing draws says so, tells its numbers in tables, and is predicted again", async () => {
    const { id } = successful(await ended({ kind: "predict", case: of, method: "fem_linear", plan: PLAN, outputs: ["skin.stl"] }));
    await go(page, `#/job/${id}`);
    await page.getByText("This result has no skin.glb and no skin.vtp", { exact: false }).waitFor();
    await page.locator("table", { hasText: "whole skin" }).waitFor();
    assert.deepEqual(await serious(page), []);
    await pictured(page, "no-skin");
    await page.getByRole("button", { name: "Predict again with the skin" }).click();
    await page.getByRole("heading", { name: "Before and after" }).waitFor();
    await addressed(page, new RegExp(id), false);
    await page.waitForFunction(() => document.querySelector(".screen")?.scene.skinPositions_mm.length > 0);
  });

  await check("a response of other materials than the case states is warned of, and given up for that of the case", async () => {
    // Of either order: of the second nothing else is to be built.
    for (const order of [1, 2]) {
      const id = await block({ name: `answers ${order}` });
      const other = successful(await ended({ kind: "response", case: id, order, materials: { deep: { poisson_ratio: 0.2 } } }));
      await go(page, `#/case/${id}/plan?p=mandible,1,0,0,0,0,0`);
      await planned(page);
      await page.locator(".order .warned", { hasText: "This response was built in another way than the case says" }).waitFor();
      await page.locator(".trust.heed", { hasText: "not of this case" }).waitFor();
      await pictured(page, `other-response-${order}`);
      assert.equal((await json(`/v1/cases/${id}/response?job=${other.id}`)).job, other.id);
      const before = await positions(page);
      await page.getByRole("button", { name: "Use the response of the case" }).click();
      await page.locator(".trust.good", { hasText: "second-order response" }).waitFor();
      assert((await positions(page)).some((value, at) => Math.abs(value - before[at]) > 1e-4), "the skin is another");
      assert.equal(await page.locator(".order .warned").count(), 0);
    }
  });

  await check("a scan is registered by a bone that stays, whatever its skin is", async () => {
    const skull = (by) => boxOf([5, 5, -30].map((value, axis) => value + by[axis]), [45, 30, -10].map((value, axis) => value + by[axis]));
    const id = await block({ name: "registered", bones: [{ name: "mandible", mesh: "mandible.stl" }, { name: "skull", mesh: "skull.stl" }] }, { "skull.stl": skull([0, 0, 0]) });
    successful(await ended({ kind: "predict", case: id, method: "fem_linear", plan: PLAN, outputs: ["skin.vtp", "skin.glb"] }));
    await go(page, `#/case/${id}/compare`);
    await page.waitForFunction(() => document.querySelector(".screen")?.scene.skinPositions_mm.length > 0);
    const surface = (name, buffer) => ({ name, mimeType: "application/octet-stream", buffer });
    const scan = await moved(page, ([x, y, z]) => [x + 2, y - 3, z + 1]);
    assert(await page.getByRole("radio", { name: "no", exact: true }).isChecked());
    await page.locator("input[data-actual]").setInputFiles(surface("real.ply", scan));
    await page.getByText("by bone", { exact: true }).click();
    await page.locator("input[data-bone]").setInputFiles(surface("skull.stl", Buffer.from(skull([2, -3, 1]))));
    assert.deepEqual(await serious(page), []);
    await page.getByRole("button", { name: "Compare" }).click();
    await page.getByText(/Registration: surfaces, turned 0\.\d\d°, shifted 3\.7\d mm/).waitFor();
    await pictured(page, "registered");
    const [mean] = await page.locator("table", { hasText: "< 1 mm" }).locator("tr", { hasText: "whole skin" }).locator("td").allTextContents();
    assert(Number(mean) < 0.05, mean);
  });

  await check("a study that does not pass names its rows with what they have and may have", async () => {
    const { id } = successful(await ended({ kind: "study", scenes: ["slab"], plans: ["patch 4 mm"], methods: ["fem_linear"], levels: [0], thresholds: { mean_mm: 1e-6 } }));
    const { verdict: { failing } } = await json(`/v1/jobs/${id}/report`);
    assert(failing.length > 0);
    for (const path of [`#/studies?study=${id}`, `#/job/${id}`]) {
      await go(page, path);
      const row = page.locator("table", { has: page.locator("caption", { hasText: "Rows that fail" }) }).locator("tbody tr").first();
      await row.waitFor();
      const told = await row.locator("th, td").allTextContents();
      assert.deepEqual(told.slice(0, 5), [failing[0].label, failing[0].scene, failing[0].plan, failing[0].material, String(failing[0].level)]);
      assert.equal(told[6], String(Number(failing[0].value.toFixed(3))));
    }
  });
}
