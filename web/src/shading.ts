// What light falls on the head, and the colours of maps as a texture.
import {
  Color, DataTexture, DirectionalLight, DoubleSide, HemisphereLight, MeshBasicMaterial, NearestFilter, ShaderMaterial, SRGBColorSpace, type MeshLambertMaterial, type Object3D, type Scene,
} from "three";
import type { Triple } from "./api.js";
import { BANDS, bands, type Scheme } from "./colours.js";

/** Whether no graphics card draws: smooth edges would cost several times as much there as everything else. */
export function isDrawnBySoftware(): boolean {
  software ??= askRenderer();
  return software;
}
let software: boolean | undefined;

function askRenderer(): boolean {
  const context = document.createElement("canvas").getContext("webgl2");
  const said = context?.getExtension("WEBGL_debug_renderer_info");
  const name = context === null || said === null || said === undefined ? "" : String(context.getParameter(said.UNMASKED_RENDERER_WEBGL));
  context?.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(name);
}

/** From above and a little aside, with the viewer. */
/** Hides what lies behind a surface without drawing it, after all that is seen through. */
export const veil = (): MeshBasicMaterial => new MeshBasicMaterial({ colorWrite: false, transparent: true, side: DoubleSide });

/** The lines where a surface turns away from the viewer, and nothing between them: what lies under it keeps its colour. */
export function contour(colour: number): ShaderMaterial {
  return new ShaderMaterial({
    side: DoubleSide, transparent: true, depthWrite: false, uniforms: { colour: { value: new Color(colour) } },
    vertexShader: `varying float facing;
      void main() {
        facing = normalize(normalMatrix * normal).z;
        gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
      }`,
    // The camera is orthographic: what faces the viewer has a normal along z everywhere. At least two pixels wide.
    fragmentShader: `uniform vec3 colour;
      varying float facing;
      void main() {
        float away = abs(facing);
        float line = 1.0 - smoothstep(0.1, 0.22, min(away, away / max(fwidth(facing), 1e-4) * 0.07));
        if (line < 0.02) discard;
        gl_FragColor = vec4(colour, 0.9 * line);
        #include <colorspace_fragment>
      }`,
  });
}

export function lights(graph: Scene, camera: Object3D): void {
  const lamp = (strength: number, place: Triple) => {
    const light = new DirectionalLight(0xffffff, strength);
    light.position.set(...place);
    camera.add(light, light.target);
  };
  lamp(1.6, [-0.9, 1.3, 1.1]);
  lamp(0.8, [1.4, 0.2, 0.8]);
  graph.add(new HemisphereLight(0xffffff, 0xc9b8ad, 1.45));
}

/** The colours of a scheme as a material's, unless they are already. */
export function setBands(material: MeshLambertMaterial, scheme: Scheme): void {
  if (material.userData.scheme === scheme) return;
  material.userData.scheme = scheme;
  const texels = new Uint8Array(bands(scheme).flatMap((colour) => [...colour, 255]));
  const texture = new DataTexture(texels, BANDS, 1);
  texture.colorSpace = SRGBColorSpace;
  texture.minFilter = NearestFilter;
  texture.magFilter = NearestFilter;
  texture.needsUpdate = true;
  material.map?.dispose();
  material.map = texture;
  material.emissiveMap = texture;
  material.needsUpdate = true;
}
