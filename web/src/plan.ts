// A plan in a surgeon's words, with what was done before and what was taken back.
import type { Documents, Triple } from "../../clients/typescript/src/facies.js";
import { INNER_KINDS, type Inner, type InnerKind } from "./columns.js";
import { MOTIONS, ROTATIONS, isStill, motion, movement, still, type FrameName, type Motion } from "./frame.js";

/** Movements by the names of segments; growth of regions as a share of their volume, and kPa of muscles, of those that are not 0. */
export interface Plan {
  segments: Record<string, Motion>;
  inner: Inner;
}

/** The segment turns about this; its translation is that of this point. */
export type Pivots = Record<string, Triple>;

export const noInner = (): Inner => ({ growth: {}, muscle: {} });

export function atRest(segments: string[]): Plan {
  return { segments: Object.fromEntries(segments.map((name) => [name, still()])), inner: noInner() };
}

/** The plan with another amount of growth or of a muscle. */
export function withInner(plan: Plan, kind: InnerKind, name: string, value: number): Plan {
  const { [name]: _, ...others } = plan.inner[kind];
  return { ...plan, inner: { ...plan.inner, [kind]: value === 0 ? others : { ...others, [name]: value } } };
}

/** As the service takes it: segments that stay are left out. */
export function document({ segments: all, inner }: Plan, pivots: Pivots, frame: FrameName): Documents["PlanDocument"] {
  const moved = Object.entries(all).filter(([, one]) => !isStill(one));
  const segments = moved.map(([name, one]) => {
    const { translation_mm, rotation_deg } = movement(one, frame);
    const turns = rotation_deg.some((angle) => angle !== 0);
    return turns ? { name, translation_mm, rotation_deg, pivot_mm: pivots[name]! } : { name, translation_mm };
  });
  const growth = Object.entries(inner.growth).map(([region, volume_change]) => ({ region, volume_change }));
  const activations = Object.entries(inner.muscle).map(([muscle, stress_kpa]) => ({ muscle, stress_kpa }));
  return {
    segments, ...(growth.length === 0 ? {} : { growth }), ...(activations.length === 0 ? {} : { activations }),
    ...(frame === "unspecified" ? {} : { frame }),
  } as Documents["PlanDocument"];
}

/** A point in another frame; LPS and RAS differ in the signs of x and y. */
function inFrame([x, y, z]: Triple, from: FrameName, to: FrameName): Triple {
  return from === to || from === "unspecified" || to === "unspecified" ? [x, y, z] : [-x || 0, -y || 0, z];
}

/** The points about which the segments of a plan of the service turn, in the frame of the case. */
export function pivotsOf(stored: Documents["PlanDocument"], frame: FrameName): Pivots {
  const stated = stored.frame ?? frame;
  const parts = (stored.segments ?? []) as unknown as { name: string; pivot_mm?: Triple }[];
  return Object.fromEntries(parts.map(({ name, pivot_mm }) => [name, inFrame(pivot_mm ?? [0, 0, 0], stated, frame)]));
}

/** Those of segments that turn alone: of the others nothing is said. */
export function turningPivots(stored: Documents["PlanDocument"], frame: FrameName): Pivots {
  const turning = ((stored.segments ?? []) as unknown as { name: string; rotation_deg?: Triple }[])
    .filter(({ rotation_deg }) => rotation_deg?.some((angle) => angle !== 0) ?? false).map(({ name }) => name);
  return Object.fromEntries(Object.entries(pivotsOf(stored, frame)).filter(([name]) => turning.includes(name)));
}

/** The words of a plan of the service; undefined where it says more than six numbers of each segment about its pivot, growth and
 * muscles. */
export function fromDocument(stored: Documents["PlanDocument"], pivots: Pivots, frame: FrameName): Plan | undefined {
  const plan = atRest(Object.keys(pivots));
  const stated = stored.frame ?? frame;
  const { segments = [], growth = [], activations = [], loads = [], prescribed = [], osteotomy } = stored;
  if (loads.length > 0 || prescribed.length > 0 || (osteotomy ?? undefined) !== undefined) return undefined;
  for (const one of segments as unknown as Record<string, unknown>[]) {
    const name = String(one.name);
    const turned = one.rotation_deg as Triple | undefined;
    const pivot = inFrame((one.pivot_mm ?? [0, 0, 0]) as Triple, stated, frame);
    const turns = turned?.some((angle) => angle !== 0) ?? false;
    const elsewhere = turns && pivot.some((value, at) => Math.abs(value - (pivots[name]?.[at] ?? NaN)) > 1e-6);
    if (plan.segments[name] === undefined || one.sequence !== undefined || one.matrix4x4 !== undefined || elsewhere) return undefined;
    plan.segments[name] = motion((one.translation_mm ?? [0, 0, 0]) as Triple, turned ?? [0, 0, 0], stated);
  }
  for (const { region, volume_change } of growth) if (volume_change !== 0) plan.inner.growth[region] = volume_change;
  for (const { muscle, stress_kpa } of activations) if (stress_kpa !== 0) plan.inner.muscle[muscle] = stress_kpa;
  return plan;
}

/** Where a plan stands in an address: movements, growth, muscles. */
export const PLAN_STATE = ["p", "growth", "muscle"] as const;
export type PlanState = Record<(typeof PLAN_STATE)[number], string | undefined>;

/** As it stands in an address: the six numbers of each segment that moves, then the point about which it turns. */
export function written(plan: Plan, pivots: Pivots): PlanState {
  const moved = Object.entries(plan.segments).filter(([, one]) => !isStill(one));
  const about = (name: string, one: Motion) =>
    (ROTATIONS.some((word) => one[word] !== 0) ? (pivots[name] ?? []).map((value) => Number(value.toFixed(3))) : []);
  const p = moved.map(([name, one]) =>
    [encodeURIComponent(name), ...MOTIONS.map((word) => one[word]), ...about(name, one)].join(",")).join(";");
  const amounts = (kind: InnerKind) => Object.entries(plan.inner[kind]).map(([name, value]) => `${encodeURIComponent(name)},${value}`).join(";");
  return { p, growth: amounts("growth"), muscle: amounts("muscle") };
}

/** The part of an address that says the plan, to be handed on. */
export function planState(state: URLSearchParams): PlanState {
  return Object.fromEntries(PLAN_STATE.map((name) => [name, state.get(name) ?? undefined])) as PlanState;
}

/** The points about which segments turn, as far as `written` wrote them. */
export function readPivots({ p = "" }: PlanState): Pivots {
  const parts = p.split(";").map((part) => part.split(","));
  const stated = parts.map(([name = "", ...numbers]) => [safely(name), numbers.slice(MOTIONS.length).map(Number)] as const);
  return Object.fromEntries(stated.filter(([, point]) => point.length === 3 && point.every(Number.isFinite)) as [string, Triple][]);
}

/** What `written` wrote; segments that are not there and numbers that are none are left out. */
export function read(state: PlanState, segments: string[]): Plan {
  const plan = atRest(segments);
  for (const part of (state.p ?? "").split(";")) {
    const [name = "", ...numbers] = part.split(",");
    const one = plan.segments[safely(name)];
    if (one === undefined) continue;
    MOTIONS.forEach((word, at) => {
      const value = Number(numbers[at] ?? 0);
      if (Number.isFinite(value)) one[word] = value;
    });
  }
  for (const kind of INNER_KINDS) {
    for (const part of (state[kind] ?? "").split(";")) {
      const [name = "", number = ""] = part.split(",");
      const value = Number(number);
      if (name !== "" && Number.isFinite(value) && value !== 0) plan.inner[kind][safely(name)] = value;
    }
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
