// What the page makes of documents: roles of sets, places that warnings name, results of any kind, words in both languages.
import assert from "node:assert/strict";
import { test } from "node:test";
import type { Documents } from "../../../clients/typescript/src/facies.js";
import { documentOf, rolesOf, withRoles, type SetRoles } from "../../src/roles.js";
import { called } from "../../src/views/anything.js";
import { names } from "../../src/views/places.js";
import { appliedLines, resultLines } from "../../src/views/trusted.js";
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
  assert.deepEqual(of({ nonlinearity_mm: { skin: { mean: 0.1, p95: 0.2 } }, numerical_error_mm: { mean: 0.6, p95: 2 } }), ["good", "good", "heed", "good"]);
  assert.deepEqual(of({ provenance: { method: "fem_nonlinear" } }), ["good", "good", "unknown", "good"]);
});

test("both languages have the same words, and none is empty", () => {
  const members = (words: object, path = ""): string[] => Object.entries(words).flatMap(([name, value]) =>
    (typeof value === "object" ? members(value as object, `${path}${name}.`) : [`${path}${name}${typeof value === "string" && value.trim() === "" ? " is empty" : ""}`]));
  assert.deepEqual(members(de).sort(), members(en).sort());
  const kept = new Set(["°", "mm", "s", "p95", "p95 mm", "max", "rms", "Jobs", "Plan", "JSON", "Linear", "Material", "Segment", "Name"]);
  const same = Object.entries(en).filter(([name, value]) => typeof value === "string" && value.length > 8 && (de as Record<string, unknown>)[name] === value && !kept.has(value));
  assert.deepEqual(same.map(([name]) => name), []);
});
