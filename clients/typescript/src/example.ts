// Ten calls: upload, make a case, predict, download the skin, compare it, study methods.
import { readFile } from "node:fs/promises";
import { WAIT, answered, connect, ended, type Documents } from "./index.js";

const facies = connect(process.env.FACIES_ADDRESS ?? "", process.env.FACIES_API_KEY);
const run = async (body: Documents["JobDocument"]) =>
  ended(facies, await answered(facies.POST("/v1/jobs", { body, params: { header: { Prefer: WAIT } } })));
const upload = (file: Blob) => {
  const params = { query: { units: "mm", frame: "LPS" } } as const;
  const headers = { "Content-Type": "application/octet-stream" };
  return answered(facies.POST("/v1/meshes", { body: file, params, headers }));
};

const mesh = await upload(new Blob([await readFile("examples/block/block.vtu")]));
const case_ = await answered(facies.POST("/v1/cases", { body: {
  units: "mm", frame: "LPS", volume: mesh.id, fixed: [{ node_set: "skull" }],
  segments: [{ name: "mandible", nodes: { node_set: "mandible" } }],
} }));

const plan = { segments: [{ name: "mandible", translation_mm: [4, 0, 1] as [number, number, number] }] };
const predicted = await run({ kind: "predict", case: case_.id, plan });
const movement = predicted.results?.statistics?.skin.area;
console.log(`the skin moves ${movement?.mean.toFixed(2)} mm on average, ${movement?.max.toFixed(2)} mm at most`);

const path = { id: predicted.id, file: "skin.vtp" };
const skin = await answered(facies.GET("/v1/jobs/{id}/results/{file}", { params: { path }, parseAs: "blob" }));
const actual = await upload(skin);
const compared = await run({ kind: "compare", prediction: { job: predicted.id }, actual: { mesh: actual.id } });
const distance = compared.results?.comparison?.both;
console.log(`prediction and downloaded skin are ${distance?.max.toFixed(4)} mm apart at most`);

const studied = await run({
  kind: "study", scenes: ["slab"], plans: ["patch 2 mm"], methods: ["fem_linear"],
  elements: ["plain", "stabilised"], truth: { refine: 1, element: "stabilised" }, repeats: 1,
});
const report = await answered(facies.GET("/v1/jobs/{id}/report", { params: { path: { id: studied.id } } }));
console.log(`the study has ${report.rows.length} rows, and its outcome is ${report.verdict.outcome}`);
