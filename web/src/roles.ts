// What each set of nodes of a mesh is, and the case document that says so.

import type { Documents } from "../../clients/typescript/src/facies.js";

type CaseDocument = Documents["CaseDocument"];
export type Role = "none" | "skin" | "region" | "segment" | "fixed" | "sliding";
export type SetRoles = Record<string, Role>;

export interface CaseSettings {
  name: string;
  frame: string;
  units: string;
  /** The id of the volume mesh. */
  mesh: string;
}

/** Words of names, the first that fits; what attaches to bone or may move is not the bone. */
const NAMES: [string[], Role][] = [
  [["ligament", "ligaments", "free", "muscle", "muscles", "band", "muskel"], "none"],
  [["skin", "face", "haut", "gesicht"], "skin"],
  [["skull", "rim", "fixed", "neck", "cranium", "schädel"], "fixed"],
  [["sliding", "slide", "slides", "wall", "walls", "teeth"], "sliding"],
  [["mandible", "maxilla", "jaw", "genioplasty", "ramus", "condyle", "zygoma", "unterkiefer", "oberkiefer", "kiefer"], "segment"],
  [["nose", "lip", "lips", "chin", "cheek", "cheeks", "nase", "lippe", "lippen", "kinn", "wange"], "region"],
];

const wordsOf = (name: string) => name.toLowerCase().split(/[^\p{L}]+/u);

/** The segment that a surface of bone moves with: the one of its name, or else the only one that is called by the same bone. */
export function segmentOf(bone: string, segments: string[]): string | undefined {
  if (segments.includes(bone)) return bone;
  const [bones] = NAMES.find(([, role]) => role === "segment")!;
  const said = wordsOf(bone).filter((word) => bones.includes(word));
  const found = segments.filter((segment) => wordsOf(segment).some((word) => said.includes(word)));
  return found.length === 1 ? found[0] : undefined;
}

/** By the whole words of its name, to begin with; a name whose words say nothing, or several things, is left to the person. */
export function guess(set: string): Role {
  const words = wordsOf(set);
  const said = NAMES.filter(([names]) => names.some((name) => words.includes(name))).map(([, role]) => role);
  if (said.includes("none") || said.length === 0) return "none";
  const bare = words.filter((word) => word !== "");
  // "lip_skin" is a part of the skin, "skull_wall" may be either.
  if (said.length === 2 && said.includes("skin") && said.includes("region")) return "region";
  return said.length === 1 && (said[0] !== "skin" || bare.length <= 2) ? said[0]! : "none";
}

/** Soft tissue of the face, to begin with: Young's modulus 15 kPa, Poisson's ratio 0.45. */
const TISSUE = { "*": { young_modulus_kpa: 15, poisson_ratio: 0.45 } };

const nodes = (set: string) => ({ node_set: set });
const having = (roles: SetRoles, role: Role) => Object.keys(roles).filter((set) => roles[set] === role);

/** The document; a bone is drawn by its surface, and moves with the segment of its name. */
export function documentOf({ name, frame, units, mesh }: CaseSettings, roles: SetRoles, bones: string[]): object {
  const start = {
    name, units, frame, volume: mesh, ...(bones.length === 0 ? {} : { bones: bones.map((bone) => ({ name: segmentOf(bone, having(roles, "segment")) ?? bone, mesh: bone })) }),
    materials: TISSUE,
  };
  return withRoles(start as unknown as CaseDocument, roles);
}

/** A set that no mesh has: nodes on the faces of a surface that was painted. */
export interface PaintedSet {
  name: string;
  role: Role;
  selection: { surface: string; within_mm: number };
}

type Selected = { node_set?: string; any?: Selected[] };
/** The set that a selection is, by its name in the mesh. */
const setOf = (selection: unknown): string | undefined => (selection as Selected | undefined)?.node_set?.replace(/^set_/, "");
const setsIn = (selection: unknown): string[] => {
  const { any } = (selection ?? {}) as Selected;
  return any === undefined ? [setOf(selection)].filter((set) => set !== undefined) : any.flatMap(setsIn);
};

const isOfSets = (selection: unknown): boolean => {
  const { node_set, any } = (selection ?? {}) as Selected;
  return any === undefined ? node_set !== undefined && Object.keys(selection as object).length === 1 : any.every(isOfSets);
};
/** Whether sets alone say what holds the nodes of a case. */
export const isHeldBySets = ({ segments = [], fixed = [], sliding = [] }: CaseDocument): boolean =>
  [...segments.map(({ nodes: held }) => held), ...fixed, ...sliding.map(({ nodes: held }) => held)].every(isOfSets);

/** What holds each of so many nodes by the roles of the sets that it is in, as a place in `FREE`, sliding, fixed, and the sets that move: where it is
 * in several, the stronger holds. */
export function heldBy(roles: SetRoles, inside: Record<string, ArrayLike<number>>, count: number): { segments: string[]; places: Uint8Array } {
  const segments = having(roles, "segment");
  const places = new Uint8Array(count);
  const order = [...having(roles, "sliding").map((set) => [set, 1] as const), ...having(roles, "fixed").map((set) => [set, 2] as const),
    ...segments.map((set, at) => [set, 3 + at] as const).reverse()];
  for (const [set, place] of order) {
    for (let node = 0; node < count; node += 1) if (inside[set]?.[node]) places[node] = place;
  }
  return { segments, places };
}

/** What a case says that each of these sets is. */
export function rolesOf(document: CaseDocument, sets: string[]): SetRoles {
  const parts: [Role, unknown[]][] = [
    ["segment", (document.segments ?? []).map(({ nodes: held }) => held)], ["fixed", document.fixed ?? []],
    ["sliding", (document.sliding ?? []).map(({ nodes: held }) => held)], ["skin", [document.skin]], ["region", Object.values(document.skin_regions ?? {})],
  ];
  const role = (set: string) => parts.find(([, held]) => held.some((one) => setsIn(one).includes(set)))?.[0];
  return Object.fromEntries(sets.map((set) => [set, role(set) ?? "none"]));
}

/** The document with sets that were painted; what it says already stays. */
export function withPainted(document: CaseDocument, sets: PaintedSet[]): CaseDocument {
  return sets.reduce((made, { name, role, selection }): CaseDocument => {
    const whole = (made.skin ?? undefined) === undefined ? selection : { any: [...partsOf(made.skin), selection] };
    const added: Record<Role, object> = {
      none: {}, skin: { skin: whole }, region: { skin_regions: { ...made.skin_regions, [name]: selection } },
      segment: { segments: [...(made.segments ?? []), { name, nodes: selection }] }, fixed: { fixed: [...(made.fixed ?? []), selection] },
      sliding: { sliding: [...(made.sliding ?? []), { nodes: selection, normal: "surface" }] },
    };
    return { ...made, ...added[role] } as CaseDocument;
  }, document);
}
/** What a union is of. */
const partsOf = (selection: unknown): Selected[] => (selection as Selected).any ?? [selection as Selected];

/** The document with other roles: what it says of sets that keep theirs, and of nodes that are no set, stays as it is. */
export function withRoles(document: CaseDocument, roles: SetRoles): CaseDocument {
  const before = rolesOf(document, Object.keys(roles));
  const changed = (selection: unknown) => setsIn(selection).some((set) => roles[set] !== undefined && roles[set] !== before[set]);
  const added = (role: Role) => having(roles, role).filter((set) => before[set] !== role);
  const kept = <One>(list: One[] | undefined, held: (one: One) => unknown) => (list ?? []).filter((one) => !changed(held(one)));
  const segments = [...kept(document.segments, (one) => one.nodes), ...added("segment").map((set) => ({ name: set, nodes: nodes(set) }))];
  const names = new Set(segments.map(({ name }) => name));
  const carried = kept(document.sliding, (one) => one.nodes).map((one) => {
    const { segment, ...wall } = one;
    return segment === undefined || segment === null || names.has(segment) ? one : wall;
  });
  const sliding = [...carried, ...added("sliding").map((set) => ({ nodes: nodes(set), normal: "surface" }))];
  const regions = { ...Object.fromEntries(Object.entries(document.skin_regions ?? {}).filter(([, held]) => !changed(held))),
    ...Object.fromEntries(added("region").map((set) => [set, nodes(set)])) };
  // Painted parts of the skin stay whatever becomes of its sets.
  const unnamed = document.skin === undefined || document.skin === null ? [] : partsOf(document.skin).filter((part) => setsIn(part).length === 0);
  const skin = [...having(roles, "skin").map(nodes), ...unnamed];
  const { skin: _, skin_regions: __, sliding: ___, ...rest } = document;
  const sameSkin = document.skin !== undefined && !changed(document.skin) && added("skin").length === 0;
  return {
    ...rest, ...(sameSkin ? { skin: document.skin } : skin.length === 0 ? {} : { skin: skin.length === 1 ? skin[0]! : { any: skin } }),
    ...(Object.keys(regions).length === 0 ? {} : { skin_regions: regions }), segments,
    fixed: [...kept(document.fixed, (one) => one), ...added("fixed").map(nodes)],
    ...(sliding.length === 0 ? {} : { sliding }),
  } as CaseDocument;
}
