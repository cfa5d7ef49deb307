// How a real skin is brought onto a predicted one before they are measured.
import type { CaseDocument, Documents } from "../api.js";
import type { Words } from "../words/en.js";

export type Registration = "none" | "surfaces" | "icp";

/** Bones that no plan moves: their surface decides where a scan lies, whatever the operation did to the face. */
export function stayingBones({ bones = [], segments = [] }: CaseDocument): { name: string; mesh: string }[] {
  const moving = new Set(segments.map(({ name }) => name));
  return bones.filter(({ name }) => !moving.has(name));
}

/** What is offered, the first by itself: skins fitted to each other hide what the prediction errs. */
export function registrations(words: Words, document: CaseDocument): [Registration, string][] {
  return [["none", words.alignNone], ...(stayingBones(document).length === 0 ? [] : [["surfaces", words.alignBone] as [Registration, string]]), ["icp", words.alignIcp]];
}

/** As the service takes it; `moving` is the bone of the scan, `fixed` that of the case. */
export function alignDocument(how: Registration, fixed?: string, moving?: string): Documents["AlignReference"] {
  return (how === "surfaces" ? { method: how, fixed: { mesh: fixed! }, moving: { mesh: moving! } } : how) as Documents["AlignReference"];
}
