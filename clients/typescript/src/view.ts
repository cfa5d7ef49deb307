// A surface in WebGL 2, lit from the viewer, coloured by the length of its displacement; dragging turns it.
import type { Surface } from "./surface.js";

/** The displacement at which colours end, in mm, as in the files of the service. */
export const RANGE_MM = 10;
/** Red, green and blue of skin that stays, and of skin that moves so far; between them linearly. */
export const COLOURS = [[0.92, 0.78, 0.68], [0.75, 0.1, 0.15]] as const;
const RADIANS_PER_PIXEL = 0.01;

const VERTEX = `#version 300 es
in vec3 position;
in vec3 displacement;
uniform mat3 turn;
uniform vec3 centre;
uniform vec2 scale;
out vec3 place;
out float length_mm;
void main() {
  place = turn * (position + displacement - centre);
  length_mm = length(displacement);
  gl_Position = vec4(place.xy * scale, -place.z * scale.y * 0.1, 1.0);
}`;

const FRAGMENT = `#version 300 es
precision highp float;
in vec3 place;
in float length_mm;
uniform float range_mm;
out vec4 colour;
void main() {
  vec3 normal = normalize(cross(dFdx(place), dFdy(place)));
  float light = 0.25 + 0.75 * abs(normal.z);
  vec3 moved = mix(vec3(${COLOURS[0]}), vec3(${COLOURS[1]}), clamp(length_mm / range_mm, 0.0, 1.0));
  colour = vec4(moved * light, 1.0);
}`;

type Corner = [number, number, number];

export class View {
  private readonly gl: WebGL2RenderingContext;
  private readonly program: WebGLProgram;
  private readonly displacement: WebGLBuffer;
  private readonly centre: Corner;
  private readonly radius: number;
  private angles = { about: 0, up: 0 };

  constructor(private readonly canvas: HTMLCanvasElement, private readonly rest: Surface) {
    const gl = canvas.getContext("webgl2");
    if (gl === null) throw new Error("this browser has no WebGL 2");
    this.gl = gl;
    this.program = program(gl);
    gl.useProgram(this.program);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, rest.triangles, gl.STATIC_DRAW);
    this.attribute("position", rest.points_mm);
    this.displacement = this.attribute("displacement", new Float32Array(rest.points_mm.length));
    gl.enable(gl.DEPTH_TEST);
    const { low, high } = box(rest.points_mm);
    this.centre = low.map((value, axis) => (value + high[axis]!) / 2) as Corner;
    this.radius = Math.hypot(...low.map((value, axis) => high[axis]! - value)) / 2;
    canvas.onpointermove = (event) => {
      if (event.buttons === 0) return;
      this.angles.about += event.movementX * RADIANS_PER_PIXEL;
      this.angles.up += event.movementY * RADIANS_PER_PIXEL;
      this.draw();
    };
    window.onresize = () => this.draw();
  }

  /** The surface with its points so far from rest, xyz for each in mm. */
  show(displacement: Float32Array): void {
    this.gl.bindBuffer(this.gl.ARRAY_BUFFER, this.displacement);
    this.gl.bufferSubData(this.gl.ARRAY_BUFFER, 0, displacement);
    this.draw();
  }

  private draw(): void {
    const { gl, canvas } = this;
    [canvas.width, canvas.height] = [canvas.clientWidth, canvas.clientHeight];
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    const least = Math.min(canvas.width, canvas.height) / this.radius;
    gl.uniform2f(this.uniform("scale"), least / canvas.width, least / canvas.height);
    gl.uniform3f(this.uniform("centre"), ...this.centre);
    gl.uniform1f(this.uniform("range_mm"), RANGE_MM);
    gl.uniformMatrix3fv(this.uniform("turn"), false, this.turn());
    gl.drawElements(gl.TRIANGLES, this.rest.triangles.length, gl.UNSIGNED_INT, 0);
  }

  /** Column by column: superior is up, and the face looks at the viewer, in LPS; of a case in RAS the other way round. */
  private turn(): number[] {
    const facing = this.rest.extras.frame === "RAS" ? -1 : 1;
    const [sa, ca] = [Math.sin(this.angles.about), Math.cos(this.angles.about)];
    const [su, cu] = [Math.sin(this.angles.up), Math.cos(this.angles.up)];
    // The axes of the case in those of glTF, (x, z, -y), then about the vertical, then about the horizontal.
    const seen = (x: number, y: number, z: number) => {
      const [right, depth] = [ca * x + sa * z, -sa * x + ca * z];
      return [right, cu * y - su * depth, su * y + cu * depth];
    };
    return [...seen(facing, 0, 0), ...seen(0, 0, -facing), ...seen(0, 1, 0)];
  }

  private attribute(name: string, values: Float32Array): WebGLBuffer {
    const { gl } = this;
    const buffer = gl.createBuffer();
    const place = gl.getAttribLocation(this.program, name);
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.bufferData(gl.ARRAY_BUFFER, values, gl.DYNAMIC_DRAW);
    gl.enableVertexAttribArray(place);
    gl.vertexAttribPointer(place, 3, gl.FLOAT, false, 0, 0);
    return buffer;
  }

  private uniform(name: string): WebGLUniformLocation | null {
    return this.gl.getUniformLocation(this.program, name);
  }
}

function program(gl: WebGL2RenderingContext): WebGLProgram {
  const made = gl.createProgram();
  for (const [kind, source] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]] as const) {
    const shader = gl.createShader(kind)!;
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    gl.attachShader(made, shader);
  }
  gl.linkProgram(made);
  if (!gl.getProgramParameter(made, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(made) ?? "no program");
  return made;
}

function box(points: Float32Array): { low: Corner; high: Corner } {
  const [low, high]: [Corner, Corner] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
  points.forEach((value, at) => {
    const axis = at % 3;
    low[axis] = Math.min(low[axis]!, value);
    high[axis] = Math.max(high[axis]!, value);
  });
  return { low, high };
}
