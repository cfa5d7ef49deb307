// The head in three dimensions: skin, bones and marks, drawn when something has changed.
//
// Everything is kept in mm in the frame of the case; one group turns that so that x is the patient's left, y up and z to the front.
// The camera is orthographic: what is seen has one scale everywhere, and a profile is a true profile.
import {
  BufferAttribute, Color, DoubleSide, Group, Matrix4, Mesh, MeshBasicMaterial, MeshLambertMaterial, OrthographicCamera, Raycaster,
  Scene as Graph, SRGBColorSpace, Vector2, Vector3, WebGLRenderer, type Material,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import type { Triple } from "./api.js";
import { share, type Rgb, type Scheme } from "./colours.js";
import { coarse } from "./coarse.js";
import { drawn, type FrameName } from "./frame.js";
import type { Part } from "./glb.js";
import { geometryOf, seenFrom, VIEWS, type Shape } from "./geometry.js";
import { Marks, type Mark, type Sheet } from "./marks.js";
import { normals } from "./normals.js";
import { BONE, hex, hexOf, MOVING_BONE, OUTLINE, SKIN } from "./palette.js";
import { contour, isDrawnBySoftware, lights, setBands, veil } from "./shading.js";

export type { Shape } from "./geometry.js";
export interface Hit {
  node: number;
  /** The triangle. */
  face: number;
  point_mm: Triple;
}
/** What surfaces are called that are no bones: the skin, another state laid over it, and that of the left half. */
export const SEEN = { skin: "skin", over: "laid_over", left: "left_half" } as const;
export type SkinLook = "solid" | "through" | "hidden";

/** Around the head there is a little room, above all for what stands over it. */
const ROOM = 1.2;
const KEY_TURN = Math.PI / 24;
/** Pixels of the picture for one of the page. */
const STILL = { ratio: () => Math.min(devicePixelRatio, 2) };
/** Without a graphics card, while something moves: fewer pixels, and of a large surface fewer triangles. */
const MOVING = { ratio: 0.5, triangles: 12_000 };
/** What follows another change within this is a movement, which ends after as long without one; in ms. */
const SETTLED = 250;

/** A matrix from its rows; none moves nothing. */
const ofRows = (rows?: number[]): Matrix4 => (rows === undefined ? new Matrix4() : new Matrix4().fromArray(rows).transpose());

/** A camera that was turned by hand: degrees to the patient's left of the front and above it, how near, and the point in the middle of the view
 * in mm (patient's left, up, front). */
export type Turned = [about: number, over: number, zoom: number, left: number, up: number, front: number];
const DEGREE = Math.PI / 180;

export class Scene {
  /** Called when the camera was turned by hand. */
  turned: () => void = () => {};
  readonly canvas: HTMLCanvasElement;
  private readonly renderer: WebGLRenderer;
  private readonly graph = new Graph();
  private readonly head = new Group();
  private readonly camera = new OrthographicCamera();
  private readonly controls: OrbitControls;
  private readonly watcher: ResizeObserver;
  private readonly bones = new Map<string, Mesh>();
  private readonly marks = new Marks();
  /** What a warning speaks of, or the pointer is over. */
  private readonly pointed = new Marks();
  private readonly planes = new Marks();
  private lit: Mesh | undefined;
  private readonly skinMaterial = new MeshLambertMaterial({ color: hexOf(SKIN), side: DoubleSide });
  /** Half of a map's colour is lit and half shines by itself, so that it is read off the legend also where there is shade. */
  private readonly mapMaterial = new MeshLambertMaterial({ side: DoubleSide, color: 0xbdbdbd, emissive: 0xb0b0b0 });
  /** Each node in a colour of its own. */
  private readonly tinted = new MeshLambertMaterial({ side: DoubleSide, vertexColors: true });
  private readonly depth = new MeshBasicMaterial({ colorWrite: false, side: DoubleSide });
  private skin: Mesh | undefined;
  private prepass: Mesh | undefined;
  private ghost: Mesh | undefined;
  /** What of the ghost is in front. */
  private veil: Mesh | undefined;
  /** The skin of the left half, where there are two. */
  private twin: Mesh | undefined;
  /** Where bones are there. */
  private twinBones: Record<string, number[]> = {};
  private rest: Shape = { points_mm: new Float32Array(), triangles: new Uint32Array() };
  private centre = new Vector3();
  private radius = 100;
  private reach = { across: 100, tall: 100 };
  private waiting = false;
  /** Over all nodes and over some, where there are many. */
  private indices: { all: BufferAttribute; few: BufferAttribute } | undefined;
  private isMoving = false;
  private changed = -Infinity;
  private settling: ReturnType<typeof setTimeout> | undefined;
  private readonly printed = () => { this.drawNow(); };

  constructor(private readonly host: HTMLElement, label: string) {
    this.renderer = new WebGLRenderer({ antialias: !isDrawnBySoftware(), alpha: true });
    this.renderer.setPixelRatio(STILL.ratio());
    this.canvas = this.renderer.domElement;
    this.canvas.tabIndex = 0;
    this.canvas.setAttribute("role", "img");
    this.canvas.setAttribute("aria-label", label);
    host.prepend(this.canvas);
    lights(this.graph, this.camera);
    this.graph.add(this.head, this.camera);
    this.head.add(this.planes.group, this.marks.group, this.pointed.group);
    this.controls = new OrbitControls(this.camera, this.canvas);
    this.controls.enableDamping = false;
    this.controls.addEventListener("change", () => this.stir());
    this.controls.addEventListener("end", () => this.turned());
    this.watcher = new ResizeObserver(() => this.resize());
    this.watcher.observe(host);
    // What a browser prints is the last picture, which it may have thrown away.
    addEventListener("beforeprint", this.printed);
    // For tests, and for whoever wants the numbers that are drawn.
    Object.assign(host, { scene: this });
  }

  /** The axes of the case as they are drawn. */
  orient(frame: FrameName): void {
    const [a, b, c] = drawn(frame);
    this.head.matrixAutoUpdate = false;
    this.head.matrix.set(...a, 0, ...b, 0, ...c, 0, 0, 0, 0, 1);
    this.head.updateMatrixWorld(true);
  }

  /** A surface in the colour of skin or another. */
  showSkin(rest: Shape, colour = hexOf(SKIN)): void {
    this.rest = rest;
    this.skinMaterial.color.setHex(colour);
    this.settle();
    for (const old of [this.skin, this.prepass]) if (old !== undefined) this.drop(old);
    const geometry = geometryOf(rest);
    geometry.setAttribute("uv", new BufferAttribute(new Float32Array((rest.points_mm.length / 3) * 2).fill(0.5), 2));
    this.skin = new Mesh(geometry, this.skinMaterial);
    this.skin.renderOrder = 2;
    this.prepass = new Mesh(geometry, this.depth);
    this.prepass.renderOrder = 1;
    this.prepass.visible = this.skinMaterial.transparent;
    this.head.add(this.prepass, this.skin);
    const few = isDrawnBySoftware() ? coarse(rest.points_mm, rest.triangles, MOVING.triangles) : undefined;
    this.indices = few === undefined ? undefined : { all: geometry.index!, few: new BufferAttribute(few, 1) };
    geometry.computeBoundingSphere();
    const sphere = geometry.boundingSphere!;
    this.centre = sphere.center.clone().applyMatrix4(this.head.matrix);
    this.radius = sphere.radius;
    this.draw();
  }

  /** The skin so far from rest: xyz for each node, in mm. */
  moveSkin(displacement_mm: Float32Array): void {
    if (this.skin === undefined) return;
    const { position, normal } = this.skin.geometry.attributes as { position: BufferAttribute; normal: BufferAttribute };
    const into = position.array as Float32Array;
    const from = this.rest.points_mm;
    for (let at = 0; at < into.length; at += 1) into[at] = from[at]! + displacement_mm[at]!;
    normals(into, this.rest.triangles, normal.array as Float32Array);
    position.needsUpdate = true;
    normal.needsUpdate = true;
    this.stir();
  }

  /** The skin at rest, as it was shown. */
  get resting(): Shape {
    return this.rest;
  }

  /** Where the nodes of the skin are drawn: xyz in mm in the frame of the case. */
  get skinPositions_mm(): Float32Array {
    return this.skin === undefined ? new Float32Array() : this.skin.geometry.attributes.position!.array as Float32Array;
  }

  /** Colours the skin by values at its nodes, or not. */
  paint(values?: ArrayLike<number>, range_mm = 1, scheme: Scheme = "length"): void {
    if (this.skin === undefined) return;
    this.skin.material = values === undefined ? this.skinMaterial : this.mapMaterial;
    if (values !== undefined) {
      setBands(this.mapMaterial, scheme);
      const uv = this.skin.geometry.attributes.uv as BufferAttribute;
      // A texture has no bands beyond its ends.
      const into = uv.array as Float32Array;
      for (let node = 0; node < uv.count; node += 1) into[2 * node] = Math.min(Math.max(share(values[node]!, range_mm, scheme), 0.001), 0.999);
      uv.needsUpdate = true;
    }
    this.draw();
  }

  /** Colours each node of the skin by the place of its colour in a list. */
  tint(places: ArrayLike<number>, colours: Rgb[]): void {
    if (this.skin === undefined) return;
    const [linear, colour] = [new Float32Array(3 * places.length), new Color()];
    const known = colours.map(([red, green, blue]) => colour.setRGB(red / 255, green / 255, blue / 255, SRGBColorSpace).toArray());
    for (let node = 0; node < places.length; node += 1) linear.set(known[places[node]!]!, 3 * node);
    this.skin.geometry.setAttribute("color", new BufferAttribute(linear, 3));
    this.skin.material = this.tinted;
    this.draw();
  }

  look(look: SkinLook): void {
    for (const material of [this.skinMaterial, this.mapMaterial, this.tinted]) {
      material.transparent = look === "through";
      material.opacity = look === "through" ? 0.42 : 1;
    }
    if (this.skin !== undefined) this.skin.visible = look !== "hidden";
    // Only what is seen through needs to know what lies in front.
    if (this.prepass !== undefined) this.prepass.visible = look === "through";
    this.draw();
  }

  /** Another state of the skin as its outline over this one, or none. Two skins so near to each other would fight for what is in
   * front, and a shell would tint the colours of a map. */
  overlay(shape: Shape | undefined): void {
    for (const old of [this.ghost, this.veil]) if (old !== undefined) this.drop(old);
    this.ghost = this.veil = undefined;
    if (shape !== undefined) {
      const geometry = geometryOf(shape);
      // Of the outline only that is left out which the other skin itself hides.
      this.veil = new Mesh(geometry, veil());
      this.veil.renderOrder = 3;
      this.veil.onBeforeRender = () => this.renderer.clearDepth();
      this.ghost = new Mesh(geometry, contour(hexOf(OUTLINE)));
      this.ghost.renderOrder = 4;
      this.head.add(this.veil, this.ghost);
    }
    this.draw();
  }

  /** Some triangles of the skin under a light colour, or none. */
  cover(part: Shape | undefined, colour: number): void {
    this.overlay(undefined);
    if (part === undefined) return;
    const material = new MeshLambertMaterial({ color: colour, transparent: true, opacity: 0.75, side: DoubleSide, depthWrite: false, polygonOffset: true, polygonOffsetFactor: -1, polygonOffsetUnits: -1 });
    this.ghost = new Mesh(geometryOf(part), material);
    this.ghost.renderOrder = 3;
    this.head.add(this.ghost);
  }

  /** Another state of the skin in the left half, with bones at rest or where row-major matrices bring them, seen by the same camera; or the
   * whole view for one. */
  beside(shape: Shape | undefined, bones: Record<string, number[]> = {}): void {
    if (this.twin !== undefined) this.drop(this.twin);
    this.twinBones = bones;
    this.twin = shape === undefined ? undefined : new Mesh(geometryOf(shape), this.skinMaterial);
    if (this.twin !== undefined) {
      this.twin.visible = false;
      this.twin.renderOrder = 2;
      this.head.add(this.twin);
    }
    this.resize();
  }

  addBone(name: string, shape: Shape, moves: boolean): void {
    const material = new MeshLambertMaterial({ color: hex(moves ? MOVING_BONE : BONE), side: DoubleSide });
    const bone = new Mesh(geometryOf(shape), material);
    bone.matrixAutoUpdate = false;
    this.bones.set(name, bone);
    this.head.add(bone);
    this.draw();
  }

  /** A movement as a row-major 4x4 matrix in the frame of the case. */
  moveBone(name: string, matrix: number[]): void {
    const bone = this.bones.get(name);
    if (bone === undefined) return;
    bone.matrix.copy(ofRows(matrix));
    bone.matrixWorldNeedsUpdate = true;
    this.draw();
  }

  showBones(shown: boolean): void {
    for (const bone of this.bones.values()) bone.visible = shown;
    this.draw();
  }

  /** Points in the frame of the case; lines lead to where they are to be. */
  mark(points: Mark[]): void {
    this.marks.place(points);
    this.draw();
  }

  /** Planes that are sawn. */
  saw(sheets: Sheet[]): void {
    this.planes.sheets(sheets);
    this.draw();
  }

  /** Points out places, beside the marks. */
  point(points: Mark[]): void {
    this.pointed.place(points);
    this.draw();
  }

  /** Points out nodes of the skin: those whose number is not 0. */
  pointNodes(chosen: ArrayLike<number>, colour: number): void {
    this.pointed.dots(this.skinPositions_mm, chosen, colour);
    this.draw();
  }

  hasBone(name: string): boolean {
    return this.bones.has(name);
  }

  /** A bone in another colour. */
  pointBone(name: string, colour: number): void {
    this.lit = this.bones.get(name);
    (this.lit?.material as MeshLambertMaterial | undefined)?.emissive.setHex(colour);
    this.draw();
  }

  /** Takes away what was pointed out. */
  unpoint(): void {
    this.pointed.clear();
    (this.lit?.material as MeshLambertMaterial | undefined)?.emissive.setHex(0);
    this.lit = undefined;
    this.draw();
  }

  /** A standard view by its key. */
  view(key: string): void {
    const from = VIEWS[key];
    if (from === undefined) return;
    this.camera.zoom = 1;
    this.camera.up.set(0, 1, 0);
    const { target, reach } = seenFrom(this.rest.points_mm, this.head.matrix, this.centre, new Vector3(...from).normalize());
    this.reach = reach;
    this.controls.target.copy(target);
    this.camera.position.copy(this.controls.target).addScaledVector(new Vector3(...from).normalize(), 4 * this.radius);
    this.resize();
    this.controls.update();
    this.draw();
  }

  /** Arrow keys turn the head, plus and minus come nearer and go away. */
  turnByKey(event: KeyboardEvent): void {
    const turns: Record<string, [number, number]> = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
    const [about, over] = turns[event.key] ?? [0, 0];
    const nearer = { "+": 1.1, "-": 1 / 1.1 }[event.key] ?? 1;
    if (about === 0 && over === 0 && nearer === 1) return;
    event.preventDefault();
    const arm = this.camera.position.clone().sub(this.controls.target);
    const side = new Vector3(0, 1, 0).cross(arm).normalize();
    arm.applyAxisAngle(new Vector3(0, 1, 0), about * KEY_TURN).applyAxisAngle(side, over * KEY_TURN);
    this.camera.position.copy(this.controls.target).add(arm);
    this.camera.zoom *= nearer;
    this.camera.updateProjectionMatrix();
    this.controls.update();
    this.stir();
    this.turned();
  }

  /** The camera beside the last standard view, of which it keeps how much is seen. */
  get turnedTo(): Turned {
    const { x, y, z } = this.camera.position.clone().sub(this.controls.target).normalize();
    const round = (value: number) => Number(value.toFixed(2));
    return [round(Math.atan2(x, z) / DEGREE), round(Math.asin(Math.min(Math.max(y, -1), 1)) / DEGREE), Number(this.camera.zoom.toFixed(4)), ...this.controls.target.toArray().map(round) as Triple];
  }

  /** As `turnedTo` told it, after `view`. */
  turnTo([about, over, zoom, ...target]: Turned): void {
    const from = new Vector3(Math.sin(about * DEGREE) * Math.cos(over * DEGREE), Math.sin(over * DEGREE), Math.cos(about * DEGREE) * Math.cos(over * DEGREE));
    this.controls.target.set(...target);
    this.camera.position.copy(this.controls.target).addScaledVector(from, 4 * this.radius);
    this.camera.zoom = zoom;
    this.camera.updateProjectionMatrix();
    this.controls.update();
    this.draw();
  }

  /** The node of the skin under the pointer. */
  pick(event: PointerEvent | MouseEvent): Hit | undefined {
    if (this.skin === undefined || !this.skin.visible) return undefined;
    if (this.isMoving) this.settle();
    const ray = this.ray(event);
    const seen = this.twin !== undefined && this.isLeft(event) ? this.twin : this.skin;
    const [hit] = ray.intersectObject(seen, false);
    if (hit?.face === undefined || hit.face === null) return undefined;
    const point = this.head.worldToLocal(hit.point.clone());
    const at = seen.geometry.attributes.position!.array;
    const away = (node: number) => point.distanceTo(new Vector3(at[3 * node], at[3 * node + 1], at[3 * node + 2]));
    const node = [hit.face.a, hit.face.b, hit.face.c].reduce((nearest, next) => (away(next) < away(nearest) ? next : nearest));
    return { node, face: hit.faceIndex!, point_mm: point.toArray() };
  }

  /** The node of the skin in the middle of the view, or of its right half. */
  middle(): Hit | undefined {
    const { left, top, width, height } = this.canvas.getBoundingClientRect();
    const across = this.twin === undefined ? 0.5 : 0.75;
    return this.pick(new MouseEvent("click", { clientX: left + across * width, clientY: top + height / 2 }));
  }

  /** Where the pointer is in the plane through a point that faces the viewer. */
  drag(event: PointerEvent, through_mm: Triple): Triple {
    const { ray } = this.ray(event);
    const point = this.head.localToWorld(new Vector3(...through_mm));
    const along = point.sub(ray.origin).dot(ray.direction);
    return this.head.worldToLocal(ray.origin.clone().addScaledVector(ray.direction, along)).toArray();
  }

  /** Where a point is seen, in pixels of the window. */
  seenAt(point_mm: Triple): [number, number] {
    const { left, top, width, height } = this.canvas.getBoundingClientRect();
    this.camera.updateMatrixWorld();
    const { x, y } = this.head.localToWorld(new Vector3(...point_mm)).project(this.camera);
    return [left + ((x + 1) / 2) * width, top + ((1 - y) / 2) * height];
  }

  turnable(on: boolean): void {
    this.controls.enabled = on;
  }

  /** Pixels of a millimetre, for a scale beside the picture. */
  get pixelsPerMm(): number {
    return (this.canvas.clientHeight * this.camera.zoom) / (this.camera.top - this.camera.bottom);
  }

  /** Something moves, if it did a moment ago. */
  private stir(): void {
    this.draw();
    if (!isDrawnBySoftware()) return;
    const now = performance.now();
    if (now - this.changed < SETTLED && !this.isMoving) this.hasten(true);
    this.changed = now;
    clearTimeout(this.settling);
    this.settling = setTimeout(() => this.settle(), SETTLED);
  }

  private settle(): void {
    if (this.isMoving) this.hasten(false);
  }

  /** Draws as while something moves, or all there is. */
  private hasten(on: boolean): void {
    this.isMoving = on;
    const { indices, skin, twin, ghost } = this;
    for (const mesh of [skin, twin, ghost]) {
      const now = mesh?.geometry.index;
      // Another state of the skin has the same triangles.
      if (indices === undefined || mesh === undefined || (now?.count !== indices.all.count && now !== indices.few)) continue;
      mesh.geometry.setIndex(on ? indices.few : indices.all);
    }
    this.renderer.setPixelRatio(on ? MOVING.ratio : STILL.ratio());
    this.draw();
  }

  draw(): void {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      this.render();
    });
  }

  private render(): void {
    const { renderer, twin, host: { clientWidth: width, clientHeight: height } } = this;
    renderer.setScissorTest(twin !== undefined);
    if (twin === undefined) {
      renderer.setViewport(0, 0, width, height);
      renderer.render(this.graph, this.camera);
      return;
    }
    for (const half of [0, 1]) {
      const place = [Math.round((half * width) / 2), 0, Math.round(width / 2), height] as const;
      renderer.setViewport(...place);
      renderer.setScissor(...place);
      if (half === 1) renderer.render(this.graph, this.camera); else this.renderTwin(twin);
    }
  }

  /** The left half: the other skin, and bones where they were. */
  private renderTwin(twin: Mesh): void {
    const hidden = [this.skin, this.prepass, this.ghost, this.veil, this.marks.group, this.pointed.group].filter((one) => one?.visible);
    const moved = [...this.bones].map(([name, bone]) => [name, bone, bone.matrix.clone()] as const);
    const place = (bone: Mesh, matrix: Matrix4) => { bone.matrix.copy(matrix); bone.matrixWorldNeedsUpdate = true; };
    twin.visible = this.skin?.visible ?? true;
    for (const one of hidden) one!.visible = false;
    for (const [name, bone] of moved) place(bone, ofRows(this.twinBones[name]));
    this.renderer.render(this.graph, this.camera);
    for (const [, bone, matrix] of moved) place(bone, matrix);
    for (const one of hidden) one!.visible = true;
    twin.visible = false;
  }

  /** The surfaces that are seen, the skin first where it is: each in the frame of the case, bones with the matrices that bring them there. */
  seen(): Part[] {
    this.settle();
    const { skin, ghost, twin, bones } = this;
    const part = (name: string, mesh: Mesh, matrix?: ArrayLike<number>): Part => {
      const { position, normal } = mesh.geometry.attributes as { position: BufferAttribute; normal: BufferAttribute };
      const { r, g, b } = ("color" in mesh.material ? mesh.material.color as Color : new Color(hexOf(OUTLINE))).getRGB({ r: 0, g: 0, b: 0 }, SRGBColorSpace);
      return {
        name, points_mm: position.array as Float32Array, normals: normal.array as Float32Array, triangles: mesh.geometry.index!.array as Uint32Array,
        colour: [r, g, b].map((share) => Math.round(255 * share)) as Rgb, ...(matrix === undefined ? {} : { matrix: Array.from(matrix) }),
      };
    };
    return [
      ...(skin?.visible ? [part(SEEN.skin, skin)] : []),
      ...(ghost === undefined ? [] : [part(SEEN.over, ghost)]),
      ...(twin === undefined || !(skin?.visible ?? true) ? [] : [part(SEEN.left, twin)]),
      ...[...bones].filter(([, bone]) => bone.visible).map(([name, bone]) => part(name, bone, bone.matrix.clone().transpose().toArray())),
    ];
  }

  /** The rows that turn the frame of the case to the patient's left, up and front. */
  get axes(): Triple[] {
    const { elements } = this.head.matrix;
    return [0, 1, 2].map((row) => [elements[row]!, elements[row + 4]!, elements[row + 8]!]);
  }

  /** At once, for a picture. */
  drawNow(): HTMLCanvasElement {
    this.settle();
    this.render();
    return this.canvas;
  }

  leave(): void {
    clearTimeout(this.settling);
    removeEventListener("beforeprint", this.printed);
    this.watcher.disconnect();
    this.controls.dispose();
    this.graph.traverse((object) => {
      if (!(object instanceof Mesh)) return;
      object.geometry.dispose();
      (object.material as Material).dispose();
    });
    this.mapMaterial.map?.dispose();
    this.renderer.dispose();
    this.renderer.forceContextLoss();
    this.canvas.remove();
  }

  private isLeft(event: MouseEvent): boolean {
    const box = this.canvas.getBoundingClientRect();
    return event.clientX < box.left + box.width / 2;
  }

  private ray(event: PointerEvent | MouseEvent): Raycaster {
    const box = this.canvas.getBoundingClientRect();
    const halves = this.twin === undefined ? 1 : 2;
    const across = (((event.clientX - box.left) / box.width) * halves) % 1;
    const place = new Vector2(2 * across - 1, 1 - (2 * (event.clientY - box.top)) / box.height);
    const ray = new Raycaster();
    // A camera that was turned since the last frame has its old place until the next.
    this.camera.updateMatrixWorld();
    ray.setFromCamera(place, this.camera);
    return ray;
  }

  private resize(): void {
    const { clientWidth, clientHeight: height } = this.host;
    if (clientWidth === 0 || height === 0) return;
    this.renderer.setSize(clientWidth, height, false);
    const width = this.twin === undefined ? clientWidth : clientWidth / 2;
    const tall = ROOM * Math.max(this.reach.tall, (this.reach.across * height) / width);
    const across = (tall * width) / height;
    Object.assign(this.camera, { left: -across, right: across, top: tall, bottom: -tall, near: 0.1, far: 10 * this.radius });
    this.camera.updateProjectionMatrix();
    this.draw();
  }

  private drop(mesh: Mesh): void {
    this.head.remove(mesh);
    // Triangles that are the skin's stay in use.
    const { indices, skin } = this;
    if (mesh.geometry !== skin?.geometry && indices !== undefined && [indices.all, indices.few].includes(mesh.geometry.index!)) mesh.geometry.index = null;
    mesh.geometry.dispose();
    const kept: unknown[] = [this.skinMaterial, this.mapMaterial, this.tinted, this.depth];
    if (!kept.includes(mesh.material)) (mesh.material as Material).dispose();
  }
}
