// The report of a case that has more of everything than two pages hold, as browsers print it.
import assert from "node:assert/strict";
import { check, ended, json, opened, pictured, address, caseId } from "./tools.mjs";

const pages = (pdf) => [...pdf.toString("latin1").matchAll(/\/Type\s*\/Page\b/g)].length;

/** The case of the demo with more landmarks than a page has lines, and parts of the skin. */
async function crowded() {
  const { case: document } = await json(`/v1/cases/${caseId}`);
  const skin = document.landmarks;
  const landmarks = Object.fromEntries(Array.from({ length: 60 }, (_, at) => {
    const [x, y, z] = Object.values(skin)[at % Object.keys(skin).length];
    return [`a landmark of a long name that goes on and on number ${at}`, [x, y, z]];
  }));
  const parts = Object.fromEntries(Array.from({ length: 20 }, (_, at) => [`a part of the skin with a long name ${at}`, Object.values(document.skin_regions)[at % Object.keys(document.skin_regions).length]]));
  const { id } = await json("/v1/cases", { ...document, name: "a case with everything and a name that is rather long ".repeat(2).trim(), landmarks: { ...skin, ...landmarks }, skin_regions: { ...document.skin_regions, ...parts } });
  return id;
}

export async function printed() {
  await check("a report of a case with everything prints on two pages", async () => {
    const id = await crowded();
    const job = await ended({ kind: "predict", case: id, method: "fem_linear", plan: { frame: "LPS", segments: [{ name: "mandible", translation_mm: [0, 6, 1], rotation_deg: [5, 4, 3], pivot_mm: [0, 0, 0] }, { name: "maxilla", translation_mm: [0, -6, 2] }] } });
    assert.equal(job.status, "successful", JSON.stringify(job.error));
    const reader = await opened();
    for (const lang of ["en", "de"]) {
      const path = `${address}/v1/jobs/${job.id}/results/report`;
      await reader.goto(`${path}.html?lang=${lang}`);
      const text = await reader.locator("main").textContent();
      assert.match(text, lang === "en" ? /and \d+ more, in result\.json/ : /und \d+ weitere, in result\.json/);
      assert.match(text, lang === "en" ? /Read by.*Name.*Date.*Signature/s : /Gelesen von.*Name.*Datum.*Unterschrift/s);
      assert.equal(pages(await reader.pdf({ preferCSSPageSize: true })), 2, `${lang}: HTML`);
      const pdf = Buffer.from(await (await fetch(`${path}.pdf?lang=${lang}`)).arrayBuffer());
      assert.match(pdf.toString("latin1"), /\/Count 2\b/, `${lang}: PDF`);
    }
    await reader.emulateMedia({ media: "print" });
    await pictured(reader, "report-printed");
    await reader.context().close();
  });
}
