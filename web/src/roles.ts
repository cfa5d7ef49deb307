// What each set of nodes of a mesh is, and the case document that says so.

export type Role = "none" | "skin" | "region" | "segment" | "fixed" | "sliding";
export type SetRoles = Record<string, Role>;

export interface CaseSettings {
  name: string;
  frame: string;
  units: string;
  /** The id of the volume mesh. */
  mesh: string;
}

const NAMES: [RegExp, Role][] = [
  [/^(skin|haut|face_skin)$/i, "skin"],
  [/skull|rim|fixed|neck|cranium|schädel/i, "fixed"],
  [/slid|wall|teeth/i, "sliding"],
  [/mandib|maxill|jaw|genio|ramus|condyl|zygom|kiefer/i, "segment"],
  [/nose|lip|chin|cheek|nase|lippe|kinn/i, "region"],
];

/** By its name, to begin with. */
export function guess(set: string): Role {
  return NAMES.find(([name]) => name.test(set))?.[1] ?? "none";
}

/** Soft tissue of the face, to begin with: Young's modulus 15 kPa, Poisson's ratio 0.45. */
const TISSUE = { "*": { young_modulus_kpa: 15, poisson_ratio: 0.45 } };

/** The document; a bone is drawn by its surface, whose file is called as it is. */
export function documentOf({ name, frame, units, mesh }: CaseSettings, roles: SetRoles, bones: string[]): object {
  const having = (role: Role) => Object.keys(roles).filter((set) => roles[set] === role);
  const nodes = (set: string) => ({ node_set: set });
  const [skin] = having("skin");
  const regions = Object.fromEntries(having("region").map((set) => [set, nodes(set)]));
  return {
    name, units, frame, volume: mesh,
    ...(skin === undefined ? {} : { skin: nodes(skin) }),
    ...(having("region").length === 0 ? {} : { skin_regions: regions }),
    ...(bones.length === 0 ? {} : { bones: bones.map((bone) => ({ name: bone, mesh: bone })) }),
    segments: having("segment").map((set) => ({ name: set, nodes: nodes(set) })),
    fixed: having("fixed").map(nodes),
    ...(having("sliding").length === 0 ? {} : { sliding: having("sliding").map((set) => ({ nodes: nodes(set), normal: "surface" })) }),
    materials: TISSUE,
  };
}
