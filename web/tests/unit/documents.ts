// What the page makes of documents: roles of sets, places that warnings name, results of any kind, words in both languages.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import type { Documents } from "../../../clients/typescript/src/facies.js";
import { documentOf, guess, heldBy, isHeldBySets, rolesOf, segmentOf, withRoles, type SetRoles } from "../../src/roles.js";
import { shareOf, warningNumbers } from "../../src/app.js";
import { wordOf } from "../../src/frame.js";
import { beyondBounds, readBounds, readTargets, writeBounds, writeTargets, type Bounds, type Target } from "../../src/targets.js";
import { closest, readTissue, regionsOf, usualEnds, writeTissue, type TissueBounds } from "../../src/tissue.js";
import { called } from "../../src/views/anything.js";
import { jobInWords, planInWords } from "../../src/views/called.js";
import { failingCells } from "../../src/views/failing.js";
import { foundLine, targetsOf, targetTags, withFound } from "../../src/views/found.js";
import { surfaceRole, surfacesDocument } from "../../src/views/meshed.js";
import { inWays } from "../../src/views/movements.js";
import { names } from "../../src/views/places.js";
import { againWithSkin } from "../../src/views/plain.js";
import { alignDocument, registrations } from "../../src/views/registration.js";
import { isSameModel, likeThis } from "../../src/views/second.js";
import { appliedLines, resultLines } from "../../src/views/trusted.js";
import { isSlice } from "../../src/views/upload.js";
import { de } from "../../src/words/de.js";
import { en } from "../../src/words/en.js";

const set = (name: string) => ({ node_set: name });
const CASE = {
  units: "mm", volume: "v", name: "face", landmarks: { chin_tip: [0, 0, 0] }, materials: { "*": { young_modulus_kpa: 15 } },
  segments: [{ name: "jaw", nodes: set("mandible") }, { name: "upper", nodes: { surface: "maxilla", within_mm: 1 } }],
  fixed: [set("skull"), set("rim")], skin: set("skin"), skin_regions: { chin: set("chin_nodes") },
  sliding: [{ nodes: set("vestibule"), normal: "surface", segment: "jaw" }],
} as unknown as Documents["CaseDocument"];
const SETS = ["mandible", "skull", "rim", "skin", "chin_nodes", "vestibule", "nose"];

test("roles are those of the document, and unchanged roles leave it as it is", () => {
  const roles = rolesOf(CASE, SETS);
  assert.deepEqual(roles, { mandible: "segment", skull: "fixed", rim: "fixed", skin: "skin", chin_nodes: "region", vestibule: "sliding", nose: "none" });
  assert.deepEqual(withRoles(CASE, roles), CASE);
});

test("another role changes what it is of and nothing else", () => {
  const roles = (changes: SetRoles) => ({ ...rolesOf(CASE, SETS), ...changes });
  const more = withRoles(CASE, roles({ nose: "region", rim: "none" }));
  assert.deepEqual(more, { ...CASE, fixed: [set("skull")], skin_regions: { chin: set("chin_nodes"), nose: set("nose") } });
  // Two sets that are skin are both skin.
  assert.deepEqual(withRoles(CASE, roles({ nose: "skin" })).skin, { any: [set("skin"), set("nose")] });
  assert.equal(rolesOf(withRoles(CASE, roles({ nose: "skin" })), SETS).nose, "skin");
  // A wall stays when the jaw that carried it is none any more, and is carried by nobody.
  const held = withRoles(CASE, roles({ mandible: "fixed" }));
  assert.deepEqual(held.segments?.map(({ name }) => name), ["upper"]);
  assert.deepEqual(held.fixed, [set("skull"), set("rim"), set("mandible")]);
  assert.deepEqual(held.sliding, [{ nodes: set("vestibule"), normal: "surface" }]);
});

test("a new document says every role", () => {
  const roles: SetRoles = { a: "skin", b: "skin", c: "segment", d: "fixed", e: "sliding", f: "region", g: "none" };
  const made = documentOf({ name: "n", frame: "LPS", units: "mm", mesh: "m" }, roles, ["c"]) as Documents["CaseDocument"];
  assert.deepEqual(rolesOf(made, Object.keys(roles)), roles);
  assert.deepEqual(made.bones, [{ name: "c", mesh: "c" }]);
});

test("a warning names a part as a word of its own", () => {
  assert(names('may be off by about 0.8 mm at "chin"', "chin"));
  assert(names("the skin of upper_lip passes through lower_lip", "upper_lip"));
  for (const [sentence, name] of [["chinchilla", "chin"], ["upper_lip_margin", "upper_lip"], ["nothing", ""], ["a.b", "a+b"]] as const) {
    assert(!names(sentence, name), `${sentence} ${name}`);
  }
});

test("members are told with their units", () => {
  assert.deepEqual(["largest_error_mm", "wall_s", "s", "share", "mm"].map(called), ["largest error, mm", "wall, s", "s", "share", "mm"]);
});

test("what is not known of an answer is not told as good", () => {
  const applied = { order: 1, within_linear_range: false, warnings: [], max_mm: 1 } as unknown as Documents["AppliedDocument"];
  const lines = appliedLines(en, applied, { apart: 1e-3, most: 1e-4 });
  assert.deepEqual(lines.map(({ trusted }) => trusted), ["good", "unknown", "unknown", "heed", "good"]);
  const results = (changes: object) => ({ provenance: { method: "fem_linear" }, nonlinearity_mm: null, numerical_error_mm: null, ...changes }) as unknown as Documents["ResultDocument"];
  const of = (changes: object) => resultLines(en, results(changes), []).map(({ trusted }) => trusted);
  assert.deepEqual(of({}), ["good", "unknown", "unknown", "good"]);
  assert.deepEqual(of({ nonlinearity_mm: { skin: { mean: 0.1, p95: 0.2 } }, numerical_error_mm: { mean: 0.14, p95: 2 } }), ["good", "good", "heed", "good"]);
  assert.deepEqual(of({ provenance: { method: "fem_nonlinear" } }), ["good", "good", "unknown", "good"]);
});

test("no line of the strip is good where a warning of its topic stands, or above the aim of 0.1 mm", () => {
  const results = { provenance: { method: "fem_linear" }, nonlinearity_mm: { skin: { mean: 0.05, p95: 1.2 } }, numerical_error_mm: { mean: 0.05, p95: 0.2 } } as unknown as Documents["ResultDocument"];
  const warned = (code: string) => resultLines(en, results, [{ code, detail: "As it is." }]).map(({ trusted }) => trusted);
  assert.deepEqual(resultLines(en, results, []).map(({ trusted }) => trusted), ["good", "good", "good", "good"]);
  assert.deepEqual(warned("large-rotation"), ["good", "heed", "good", "heed"]);
  assert.deepEqual(warned("numerical-error-large"), ["good", "good", "heed", "heed"]);
  assert.deepEqual(warned("materials-ignored"), ["heed", "good", "good", "heed"]);
  const applied = (mean: number, code?: string) => appliedLines(en, { order: 1, within_linear_range: true, nonlinearity_estimate_mm: mean, warnings: code === undefined ? [] : [{ code, detail: "So." }] } as unknown as Documents["AppliedDocument"], { apart: 0, most: 1 })[1]!;
  assert.deepEqual([applied(0.09).trusted, applied(0.11).trusted, applied(0.01, "outside-linear-range").trusted], ["good", "heed", "heed"]);
  assert.equal(applied(0.11).why, "More than the 0.1 mm that is aimed at.");
});

test("roles are guessed by whole words, and what is not certain is nothing", () => {
  const guesses = { outer_skin: "skin", skin: "skin", face: "skin", zygomatic_free: "none", zygomatic_ligament: "none", mandibular_ligament_idxplus1: "none",
    mandible: "segment", mandible_left: "segment", maxilla: "segment", skull: "fixed", "cut-rim": "fixed", skull_wall: "none", vestibule_wall: "sliding", upper_lip: "region", lip_skin: "region",
    interface: "none", surface_nodes: "none", eclipse: "none", primitive: "none", skin_of_the_neck: "none", Haut: "skin" };
  assert.deepEqual(Object.fromEntries(Object.keys(guesses).map((set) => [set, guess(set)])), guesses);
});

test("what was found has the words and signs of the sliders", () => {
  assert.deepEqual(wordOf("translation_mm.y", "LPS"), { word: "forward", sign: -1 });
  assert.deepEqual(wordOf("translation_mm.y", "RAS"), { word: "forward", sign: 1 });
  assert.deepEqual(wordOf("rotation_deg.x", "LPS"), { word: "pitch", sign: -1 });
  assert.deepEqual(wordOf("translation_mm.x", "RAS"), { word: "left", sign: -1 });
  const plan = { segments: [{ name: "maxilla", translation_mm: [0, -5, 0] }] } as unknown as Documents["PlanDocument"];
  assert.equal(planInWords(en, plan, "LPS"), "maxilla forward 5 mm");
  const job = { kind: "predict", id: "0199-aaaa-bbbb-123456", created: "2026-01-01T00:00:00Z", results: { provenance: { frame: "LPS", plan } } } as unknown as Documents["StatusInfo"];
  globalThis.document = { documentElement: { lang: "en" } } as unknown as Document;
  assert.match(jobInWords(en, job), /^Prediction · maxilla forward 5 mm · .+ · …123456$/);
});

test("a movement is told by the way that it goes, not by a sign", () => {
  const plan = { frame: "LPS", segments: [{ name: "mandible", translation_mm: [-2, 5, -1], rotation_deg: [3, 2, -4] }] } as unknown as Documents["PlanDocument"];
  assert.equal(planInWords(en, plan, "LPS"), "mandible back 5 mm, down 1 mm, right 2 mm, front down 3°, left side down 2°, front to the right 4°");
  assert.equal(planInWords(de, plan, "LPS"), "mandible zurück 5 mm, ab 1 mm, rechts 2 mm, vorn ab 3°, links ab 2°, vorn nach rechts 4°");
  assert.equal(planInWords(en, { segments: [{ name: "jaw", translation_mm: [0, -5, 0] }] } as unknown as Documents["PlanDocument"], "unspecified"), "jaw y -5 mm");
  assert.equal(inWays(en, [-1.5, 0.001, 2], "LPS"), "back 1.50, up 0.00, left 2.00");
  const found = { targets: [], at_bound: [{ segment: "maxilla", name: "translation_mm.y", value: 10, bound: "upper" }] } as unknown as Documents["OptimisationDocument"];
  assert.match(foundLine(en, found, [], "LPS").why!, /maxilla back, mm is stopped by its bound at 10\.00\./);
});

test("nothing is registered by itself, and bone is offered where a bone stays", () => {
  const [bones, segments] = [[{ name: "skull", mesh: "s" }, { name: "jaw", mesh: "j" }], [{ name: "jaw" }]];
  const offered = (document: object) => registrations(en, document as Documents["CaseDocument"] & { volume: string }).map(([way]) => way);
  assert.deepEqual(offered({ bones, segments }), ["none", "surfaces", "icp"]);
  assert.deepEqual(offered({ bones: bones.slice(1), segments }), ["none", "icp"]);
  assert.deepEqual(offered({}), ["none", "icp"]);
  assert.deepEqual([alignDocument("none"), alignDocument("surfaces", "s", "m")], ["none", { method: "surfaces", fixed: { mesh: "s" }, moving: { mesh: "m" } }]);
});

test("a result without a skin is predicted again by its plan", () => {
  const of = (provenance: object, more = {}) => againWithSkin({ case: "c", results: { provenance, ...more } } as unknown as Documents["StatusInfo"]);
  const plan = { segments: [] };
  assert.deepEqual(of({ plan, method: "fem_linear" }), { kind: "predict", case: "c", plan, method: "fem_linear" });
  assert.deepEqual(of({ plan, method: "fem_linear", model: "second_order" }), { kind: "predict", case: "c", plan });
  assert.deepEqual(of({ method: "msm" }, { optimisation: { plan } }), { kind: "predict", case: "c", plan, method: "msm" });
  assert.equal(of({ method: "fem_linear" }), undefined);
});

test("a failing row is told with what it has and may have", () => {
  const row = { label: "msm", scene: "head", plan: "back", material: "soft", level: 0, measure: "p95_mm", value: 0.1234, limit: 0.1, reason: "so" };
  assert.deepEqual(failingCells(en, row), ["msm", "head", "back", "soft", "0", "p95, mm", "0.123", "0.1"]);
  const { measure: _measure, value: _value, limit: _limit, ...without } = row;
  assert.deepEqual(failingCells(en, without).slice(5), ["so", "–", "–"]);
});

test("the numbers of a warning are told by their names", () => {
  const warning = { code: "tearing", detail: "held neighbours part", turned_edges: 3, largest_mm: 1.23456, nodes: [1, 2], nested: { a: 1 } } as Documents["WarningDocument"];
  assert.equal(warningNumbers(warning), "turned edges: 3 · largest, mm: 1.235 · nodes: 1, 2");
  assert.equal(warningNumbers({ code: "nothing-held", detail: "so" }), "");
});

test("a response that is not that of the case is never good", () => {
  const applied = { order: 2, within_linear_range: true, nonlinearity_estimate_mm: 0, warnings: [], max_mm: 1 } as unknown as Documents["AppliedDocument"];
  const model = (ofCase?: "same" | "other" | "unknown") => appliedLines(en, applied, { apart: 0, most: 1e-4, ...(ofCase && { ofCase }) })[0]!;
  assert.deepEqual([model("same"), model("unknown"), model("other")].map(({ trusted }) => trusted), ["good", "unknown", "heed"]);
  assert.deepEqual([model("other").value, model("other").why], ["second-order response, not of this case", en.responseOther]);
  const warned = { ...applied, warnings: [{ code: "materials-ignored", detail: "So." }] } as unknown as Documents["AppliedDocument"];
  assert.equal(appliedLines(en, warned, { apart: 0, most: 1, ofCase: "unknown" })[0]!.trusted, "heed");
});

test("responses are of one model where the columns of their segments agree, whatever else they have", () => {
  const of = (numbers: number[], inner: number[] = [], name = "jaw") => ({ description: { segments: [{ name }] }, columns: { nodes: 1, segments: 1, linear: Float32Array.from([...numbers, ...inner]) } });
  const column = Array.from({ length: 36 }, (_, at) => at / 10);
  const other = column.map((value, at) => (at === 20 ? value + 0.01 : value));
  assert(isSameModel(of(column), of(column, [1, 2, 3])) && isSameModel(of(column, [4, 5, 6]), of(column)));
  assert(!isSameModel(of(column), of(other)) && !isSameModel(of(column), of(column, [], "upper")));
  assert.deepEqual([likeThis({ second: undefined, inner: [] }, ["*"]), likeThis({ second: undefined, inner: [{ kind: "growth", name: "fat" }] } as unknown as Parameters<typeof likeThis>[0], ["*", "fat"])], [{}, { growth: ["*", "fat"] }]);
  assert.deepEqual(likeThis({ second: {}, inner: [] } as unknown as Parameters<typeof likeThis>[0], []), { order: 2 });
});

test("slices of a series are known by their names", () => {
  assert.deepEqual(["IM0001", "slice.dcm", "a.IMA", "face.vtu", "skull.stl", "ct.nii.gz"].map(isSlice), [true, true, true, false, false, false]);
});

test("targets keep their names, and a missed one or a stopped movement is to be heeded", () => {
  const named = [{ label: "pogonion", sigma_mm: 1 }, { label: "Point 1", sigma_mm: 0.5 }];
  assert.deepEqual(targetsOf(en, ["else", ...targetTags(named).reverse()], 2), named);
  assert.deepEqual(targetsOf(en, [], 1), [{ label: "Target 1", sigma_mm: 1 }]);
  const found = (residuals: number[], at_bound: object[] = []) => foundLine(en, { targets: residuals.map((residual_mm) => ({ residual_mm, largest_mm: residual_mm, points: 1 })), at_bound } as unknown as Documents["OptimisationDocument"], named, "LPS");
  assert.equal(found([1.9, 0.9]).trusted, "good");
  const missed = found([1.9, 1.1]);
  assert.deepEqual([missed.trusted, missed.value], ["heed", "at most 1.90 mm left over"]);
  assert.match(missed.why!, /more than 2 standard deviations.*Point 1 is missed by 1\.10 mm\.$/);
  const stopped = found([0, 0], [{ segment: "maxilla", name: "translation_mm.y", value: -10, bound: "lower" }]);
  assert.equal(stopped.trusted, "heed");
  assert.match(stopped.why!, /maxilla forward, mm is stopped by its bound at 10\.00\./);
});

test("growth and constants have their units, and are heeded where they are warned of", () => {
  const found = (at_bound: object[]) => ({ targets: [{ residual_mm: 0.1, largest_mm: 0.1, points: 1 }], at_bound }) as unknown as Documents["OptimisationDocument"];
  const line = (at_bound: object[], codes: string[]) => foundLine(en, found(at_bound), [{ label: "chin", sigma_mm: 1 }], "LPS", codes.map((code) => ({ code, detail: `${code} it is.` })));
  assert.equal(line([], ["large-rotation"]).trusted, "good");
  for (const code of ["constant-at-end", "constant-not-determined", "growth-left-out"]) {
    const told = line([], [code]);
    assert.deepEqual([told.trusted, told.why!.endsWith(`${code} it is.`)], ["heed", true], code);
  }
  assert.match(line([{ region: "fat", name: "volume_change", value: -0.3, bound: "lower" }], []).why!, /fat: growth, % is stopped by its bound at -30\.00\./);
  assert.match(line([{ region: "*", name: "poisson_ratio", value: 0.4875, bound: "upper" }], []).why!, /all tissue: Poisson's ratio is stopped by its bound at 0\.4875\./);
});

test("constants that were found stand over those of the case, field by field", () => {
  const document = { materials: { "*": { young_modulus_kpa: 15, poisson_ratio: 0.4 }, fat: { young_modulus_kpa: 5, poisson_ratio: 0.45, density_g_per_cm3: 0.9 } } } as unknown as Documents["CaseDocument"];
  assert.deepEqual(withFound(document, { fat: { poisson_ratio: 0.48 }, skin: { young_modulus_kpa: 60 } }).materials,
    { "*": { young_modulus_kpa: 15, poisson_ratio: 0.4 }, fat: { young_modulus_kpa: 5, poisson_ratio: 0.48, density_g_per_cm3: 0.9 }, skin: { young_modulus_kpa: 60, poisson_ratio: 0.4 } });
});

test("what is looked for of tissue is in the address and comes back, and what is none is left out", () => {
  const bounds: TissueBounds = { "*": { volume_change: [-0.3, 0.3] }, "fat, deep": { poisson_ratio: [0.3, 0.49], young_modulus_kpa: [5, 50] } };
  const regions = ["*", "fat, deep", "skin"];
  assert.deepEqual(readTissue(`${writeTissue(bounds)};bone,volume_change,0,1;skin,stiffness,0,1;skin,volume_change,0;skin,volume_change,,1;junk`, regions), bounds);
  assert.equal(writeTissue({}), "");
  const document = { regions: { array: "layer", names: { 0: "fat" } }, materials: { "*": { young_modulus_kpa: 30 }, fat: { young_modulus_kpa: 6 } } } as unknown as Documents["CaseDocument"];
  assert.deepEqual(regionsOf(document), ["*", "fat"]);
  assert.deepEqual([usualEnds("young_modulus_kpa", document, "fat"), usualEnds("young_modulus_kpa", document, "skin")], [[2, 18], [10, 90]]);
  // The largest in absolute value, but not its own.
  assert.deepEqual(closest([[1, 0.2, -0.9], [0.2, 1, 0], [-0.9, 0, 1]], 0), { at: 2, correlation: -0.9 });
  assert.equal(closest([[1]], 0), undefined);
});

test("names of warnings are of codes that the service has", () => {
  const [, table] = readFileSync("../docs/errors.md", "utf8").split("## Warnings\n");
  const codes = [...table!.matchAll(/^\| `([^`]+)` \|/gm)].map(([, code]) => code!);
  assert(codes.length > 100);
  assert.deepEqual(Object.keys(en.warningNames).filter((code) => !codes.includes(code)), []);
  // Those that a plan and its search are warned of have one.
  for (const code of ["bulk-in-all-cells", "constant-at-end", "constant-not-determined", "growth-left-out", "large-rotation", "numerical-error-large"]) assert(code in en.warningNames, code);
});

test("targets that the bounds forbid are known before anything is solved", () => {
  const held = { forward: 10, up: 10, left: 0, pitch: 0, roll: 0, yaw: 0 };
  const target = { label: "Point 1", at_mm: [0, 0, 0], by: [2, null, 8.7], sigma_mm: 1 } as Parameters<typeof beyondBounds>[0][number];
  assert.deepEqual(beyondBounds([target], { jaw: held }).map(({ at, wanted, allowed }) => [at, wanted, allowed]), [[2, 8.7, 0]]);
  assert.deepEqual(beyondBounds([target], { jaw: held, upper: { ...held, left: 9 } }), []);
  assert.deepEqual(beyondBounds([{ ...target, by: [11, 0, null] }], { jaw: held }).map(({ at }) => at), [0]);
  assert.deepEqual(beyondBounds([target], { jaw: { ...held, yaw: 5 } }), [], "a turn may take it there");
});

test("a share is told only where it is known", () => {
  assert.equal(shareOf({ phase: "solve", progress: 90, residual: 8.8e-2 }), undefined);
  assert.equal(shareOf({ phase: "solve", progress: 43, residual: 8.8e-2 }), 43);
  assert.equal(shareOf({ phase: "contact", progress: 90 }), 90);
});

test("both languages have the same words, and none is empty", () => {
  const members = (words: object, path = ""): string[] => Object.entries(words).flatMap(([name, value]) =>
    (typeof value === "object" ? members(value as object, `${path}${name}.`) : [`${path}${name}${typeof value === "string" && value.trim() === "" ? " is empty" : ""}`]));
  assert.deepEqual(members(de).sort(), members(en).sort());
  const kept = new Set(["°", "mm", "s", "p95", "p95 mm", "max", "rms", "Jobs", "Plan", "JSON", "Linear", "Material", "Segment", "Name"]);
  const same = Object.entries(en).filter(([name, value]) => typeof value === "string" && value.length > 8 && (de as Record<string, unknown>)[name] === value && !kept.has(value));
  assert.deepEqual(same.map(([name]) => name), []);
});

test("targets and bounds are in the address and come back, and what is none is left out", () => {
  const targets: Target[] = [
    { label: "nose, tip", landmark: "nose, tip", at_mm: [1, 2, 3], by: [3, null, -0.5], sigma_mm: 1 },
    { label: "Point 1", at_mm: [-1.5, 2.25, 30], by: [null, 0, null], sigma_mm: 0.3 },
  ];
  const written = writeTargets(targets);
  assert.deepEqual(readTargets(`${written};chin,1,2,3;@1@2,1,1,1;junk`, { "nose, tip": [1, 2, 3] }, (number) => `Point ${number}`), targets);
  const still = { forward: 10, up: 10, left: 0, pitch: 0, roll: 0, yaw: 0 };
  const start: Bounds = { "le fort, 1": { ...still }, mandible: { ...still } };
  const bounds: Bounds = { "le fort, 1": { ...still, left: 2, yaw: 4 }, mandible: { ...still } };
  assert.deepEqual(readBounds(`${writeBounds(bounds, start)};skull,1,1,1,1,1,1`, start), bounds);
  assert.equal(writeBounds(start, start), "");
});

test("surfaces are one skin and bones, or there is nothing to mesh", () => {
  assert.deepEqual(["patient_skin", "Haut", "mandible"].map(surfaceRole), ["skin", "skin", "bone"]);
  const bone = (name: string) => ({ name, mesh: name });
  assert.deepEqual(surfacesDocument("a", "RAS", { skin: "skin", jaw: "bone", other: "none" }),
    { name: "a", meshing: { kind: "mesh", frame: "RAS", surfaces: { skin: "skin", bones: [bone("jaw")] } } });
  assert.equal(surfacesDocument("a", "RAS", { skin: "skin" }), undefined);
  assert.equal(surfacesDocument("a", "RAS", { skin: "skin", face: "skin", jaw: "bone" }), undefined);
});

test("of what holds a node the stronger counts: bone before what stays, that before what slides", () => {
  const inside = { wall: [1, 1, 1, 1, 0], skull: [0, 1, 1, 1, 0], jaw: [0, 0, 1, 1, 0], chin: [0, 0, 0, 1, 0] };
  const { segments, places } = heldBy({ wall: "sliding", skull: "fixed", jaw: "segment", chin: "segment" }, inside, 5);
  assert.deepEqual([segments, [...places]], [["jaw", "chin"], [1, 2, 3, 3, 0]]);
  const held = (fixed: object[]) => isHeldBySets({ segments: [{ name: "jaw", nodes: { node_set: "jaw" } }], fixed } as never);
  assert(held([{ any: [{ node_set: "skull" }, { node_set: "rim" }] }]));
  assert(!held([{ surface: "bone", within_mm: 1 }]) && !held([{ any: [{ node_set: "skull" }, { surface: "bone", within_mm: 1 }] }]));
});

test("a surface of bone moves with the segment of its name, or the only one that is called by the same bone", () => {
  assert.equal(segmentOf("subject_face_jaw", ["jaw_attached", "maxilla"]), "jaw_attached");
  assert.equal(segmentOf("mandible", ["mandible", "mandible_left"]), "mandible");
  assert.equal(segmentOf("jaw", ["jaw_left", "jaw_right"]), undefined);
  assert.equal(segmentOf("cranium", ["jaw_attached"]), undefined);
});
