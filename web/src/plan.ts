// A plan in a surgeon's words, with what was done before and what was taken back.
import type { Documents, Triple } from "../../clients/typescript/src/facies.js";
import { MOTIONS, ROTATIONS, isStill, motion, movement, still, type FrameName, type Motion } from "./frame.js";

/** Movements by the names of segments. */
export type Plan = Record<string, Motion>;

/** The segment turns about this; its translation is that of this point. */
export type Pivots = Record<string, Triple>;

export function atRest(segments: string[]): Plan {
  return Object.fromEntries(segments.map((name) => [name, still()]));
}

/** As the service takes it: segments that stay are left out. */
export function document(plan: Plan, pivots: Pivots, frame: FrameName): Documents["PlanDocument"] {
  const moved = Object.entries(plan).filter(([, one]) => !isStill(one));
  const segments = moved.map(([name, one]) => {
    const { translation_mm, rotation_deg } = movement(one, frame);
    const turns = rotation_deg.some((angle) => angle !== 0);
    return turns ? { name, translation_mm, rotation_deg, pivot_mm: pivots[name]! } : { name, translation_mm };
  });
  return { segments, ...(frame === "unspecified" ? {} : { frame }) } as Documents["PlanDocument"];
}

/** The words of a plan of the service; undefined where a segment moves in another way than by six numbers about its pivot. */
export function fromDocument(stored: Documents["PlanDocument"], pivots: Pivots, frame: FrameName): Plan | undefined {
  const plan = atRest(Object.keys(pivots));
  const stated = (stored as { frame?: FrameName }).frame ?? frame;
  for (const one of (stored.segments ?? []) as Record<string, unknown>[]) {
    const name = String(one.name);
    const turned = one.rotation_deg as Triple | undefined;
    const pivot = (one.pivot_mm ?? [0, 0, 0]) as Triple;
    const turns = turned?.some((angle) => angle !== 0) ?? false;
    const elsewhere = turns && pivot.some((value, at) => Math.abs(value - (pivots[name]?.[at] ?? NaN)) > 1e-6);
    if (plan[name] === undefined || one.sequence !== undefined || one.matrix4x4 !== undefined || elsewhere) return undefined;
    plan[name] = motion((one.translation_mm ?? [0, 0, 0]) as Triple, turned ?? [0, 0, 0], stated);
  }
  return plan;
}

/** As it stands in an address: the six numbers of each segment that moves, then the point about which it turns. */
export function written(plan: Plan, pivots: Pivots): string {
  const moved = Object.entries(plan).filter(([, one]) => !isStill(one));
  const about = (name: string, one: Motion) =>
    (ROTATIONS.some((word) => one[word] !== 0) ? (pivots[name] ?? []).map((value) => Number(value.toFixed(3))) : []);
  return moved.map(([name, one]) =>
    [encodeURIComponent(name), ...MOTIONS.map((word) => one[word]), ...about(name, one)].join(",")).join(";");
}

/** The points about which segments turn, as far as `written` wrote them. */
export function readPivots(text: string): Pivots {
  const parts = text.split(";").map((part) => part.split(","));
  const stated = parts.map(([name = "", ...numbers]) => [safely(name), numbers.slice(MOTIONS.length).map(Number)] as const);
  return Object.fromEntries(stated.filter(([, point]) => point.length === 3 && point.every(Number.isFinite)) as [string, Triple][]);
}

/** What `written` wrote; segments that are not there and numbers that are none are left out. */
export function read(text: string, segments: string[]): Plan {
  const plan = atRest(segments);
  for (const part of text.split(";")) {
    const [name = "", ...numbers] = part.split(",");
    const one = plan[safely(name)];
    if (one === undefined) continue;
    MOTIONS.forEach((word, at) => {
      const value = Number(numbers[at] ?? 0);
      if (Number.isFinite(value)) one[word] = value;
    });
  }
  return plan;
}

function safely(name: string): string {
  try {
    return decodeURIComponent(name);
  } catch {
    return name;
  }
}

/** States one after the other, with a way back and forth. */
export class History<State> {
  private readonly past: string[] = [];
  private readonly future: string[] = [];
  private now: string;

  constructor(state: State) {
    this.now = JSON.stringify(state);
  }

  get canUndo(): boolean { return this.past.length > 0; }
  get canRedo(): boolean { return this.future.length > 0; }

  /** Notes a state, unless it is the one that there is. */
  note(state: State): void {
    const next = JSON.stringify(state);
    if (next === this.now) return;
    this.past.push(this.now);
    this.future.length = 0;
    this.now = next;
  }

  undo(): State | undefined { return this.step(this.past, this.future); }
  redo(): State | undefined { return this.step(this.future, this.past); }

  private step(from: string[], to: string[]): State | undefined {
    const state = from.pop();
    if (state === undefined) return undefined;
    to.push(this.now);
    this.now = state;
    return JSON.parse(state) as State;
  }
}
