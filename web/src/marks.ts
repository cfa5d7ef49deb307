// Points, lines and dots over the head.
import {
  BufferAttribute, BufferGeometry, DoubleSide, Group, LineBasicMaterial, LineSegments, Mesh, MeshBasicMaterial, Points, PointsMaterial, SphereGeometry,
  Vector3, type Material,
} from "three";
import type { Triple } from "./api.js";

export interface Mark {
  at_mm: Triple;
  colour: number;
  to_mm?: Triple;
  /** Of one that is to be dragged, larger than usual. */
  radius_mm?: number;
}

/** A plane that is sawn: a square around a point, and the line where it goes through something. */
export interface Sheet {
  /** Its four corners. */
  corners_mm: [Triple, Triple, Triple, Triple];
  /** Pieces of two points of xyz each. */
  line_mm: number[][];
  colour: number;
}

const MARK_MM = 1.4;
const DOT_PIXELS = 5;
/** After skin and bone, of which nothing hides them. */
const LAST = 5;

export class Marks {
  readonly group = new Group();

  /** Points in the frame of the case in the place of those before; lines lead to where they are to be. */
  place(points: Mark[]): void {
    this.clear();
    for (const { at_mm, colour, to_mm, radius_mm = MARK_MM } of points) {
      const ball = new Mesh(new SphereGeometry(radius_mm, 16, 12), new MeshBasicMaterial({ color: colour, depthTest: false }));
      ball.position.set(...at_mm);
      this.add(ball);
      if (to_mm === undefined) continue;
      const line = new BufferGeometry().setFromPoints([new Vector3(...at_mm), new Vector3(...to_mm)]);
      this.add(new LineSegments(line, new LineBasicMaterial({ color: colour, depthTest: false })));
    }
  }

  /** Dots at those of xyz places whose number is not 0. */
  dots(places_mm: ArrayLike<number>, chosen: ArrayLike<number>, colour: number): void {
    this.clear();
    const at = Array.from({ length: chosen.length }, (_, node) => node).filter((node) => chosen[node] !== 0)
      .flatMap((node) => [places_mm[3 * node]!, places_mm[3 * node + 1]!, places_mm[3 * node + 2]!]);
    const geometry = new BufferGeometry().setAttribute("position", new BufferAttribute(new Float32Array(at), 3));
    this.add(new Points(geometry, new PointsMaterial({ color: colour, size: DOT_PIXELS, sizeAttenuation: false, depthTest: false })));
  }

  /** Planes in the place of those before. */
  sheets(sheets: Sheet[]): void {
    this.clear();
    for (const { corners_mm, line_mm, colour } of sheets) {
      const square = new BufferGeometry().setFromPoints(corners_mm.map((corner) => new Vector3(...corner)));
      square.setIndex([0, 1, 2, 0, 2, 3]);
      this.add(new Mesh(square, new MeshBasicMaterial({ color: colour, transparent: true, opacity: 0.28, side: DoubleSide, depthWrite: false })));
      const line = new BufferGeometry().setAttribute("position", new BufferAttribute(new Float32Array(line_mm.flat()), 3));
      this.add(new LineSegments(line, new LineBasicMaterial({ color: colour, depthTest: false })));
    }
  }

  clear(): void {
    for (const child of [...this.group.children] as Mesh[]) {
      child.geometry.dispose();
      (child.material as Material).dispose();
      this.group.remove(child);
    }
  }

  private add(mark: Mesh | LineSegments | Points): void {
    mark.renderOrder = LAST;
    this.group.add(mark);
  }
}
