// Surfaces become a case in the browser: dropped, meshed to the end, and planned on.
import assert from "node:assert/strict";
import { check, fits, go, json, pictured, planned, positions, serious, slide, address } from "./tools.mjs";

/** A ball as an STL file in text. */
function ball(centre, radius, rings = 24) {
  const at = (ring, step) => {
    const [down, about] = [(Math.PI * ring) / rings, (Math.PI * step) / rings];
    return [Math.sin(down) * Math.cos(about), Math.sin(down) * Math.sin(about), Math.cos(down)].map((one, axis) => centre[axis] + radius * one);
  };
  const corner = (point) => `vertex ${point.map((one) => one.toFixed(6)).join(" ")}`;
  const facet = (corners) => `facet normal 0 0 0\nouter loop\n${corners.map(corner).join("\n")}\nendloop\nendfacet\n`;
  const facets = [];
  for (let ring = 0; ring < rings; ring += 1) {
    for (let step = 0; step < 2 * rings; step += 1) {
      const [a, b, c, d] = [at(ring, step), at(ring + 1, step), at(ring + 1, step + 1), at(ring, step + 1)];
      if (ring > 0) facets.push(facet([a, b, d]));
      if (ring < rings - 1) facets.push(facet([b, c, d]));
    }
  }
  return `solid ball\n${facets.join("")}endsolid ball\n`;
}

export async function meshed(page) {
  await check("dropped surfaces are meshed to the end, and the bone is moved", async () => {
    await go(page, "#/jobs");
    await go(page, "#/cases");
    const files = [["skin.stl", ball([60, 60, 60], 50)], ["jaw.stl", ball([60, 45, 45], 15)], ["skull.stl", ball([60, 75, 75], 15)]];
    await page.locator("input[data-files]").setInputFiles(files.map(([name, content]) => ({ name, mimeType: "model/stl", buffer: Buffer.from(content) })));
    const text = page.getByLabel("Case document");
    await text.waitFor();
    await page.getByLabel("Frame").selectOption("LPS");
    const document = JSON.parse(await text.inputValue());
    document.meshing.size = { tetrahedra: 3000 };
    await text.fill(JSON.stringify(document));
    await page.getByRole("button", { name: "Send" }).click();
    // The view of its progress becomes that of the case.
    await page.getByRole("heading", { name: "What the check found" }).waitFor();
    const { case: made, state } = await json(`/v1/cases/${await page.evaluate(() => /case\/([0-9a-f-]+)/.exec(location.hash)[1])}`);
    assert.equal(state, "ready");
    assert.deepEqual(made.segments.map(({ name }) => name).sort(), ["jaw", "skull"]);
    assert.deepEqual(await serious(page), []);
    await fits(page);
    await pictured(page, "meshed");
    await page.getByRole("link", { name: "Plan a movement" }).click();
    await planned(page);
    const rest = await positions(page);
    await slide(page, "jaw", "forward", 3);
    const moved = await positions(page);
    const most = moved.reduce((high, value, at) => Math.max(high, Math.abs(value - rest[at])), 0);
    assert(most > 0.3 && most < 3.5, `${most} mm`);
  });
}
