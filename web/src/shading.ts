// What light falls on the head, and the colours of maps as a texture.
import {
  DataTexture, DirectionalLight, HemisphereLight, NearestFilter, SRGBColorSpace, type MeshLambertMaterial, type Object3D, type Scene,
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
