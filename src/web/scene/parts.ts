// The parts of a job's glTF scene. Its axes are y up and its unit is the metre (docs/JOB_FOLDER.md).
import { Color, Mesh, MeshStandardMaterial, type Object3D } from 'three';
import { GLTFLoader } from 'three/examples/jsm/loaders/GLTFLoader.js';

export interface ScenePart {
  id: number;
  mesh: Mesh;  // with a material of its own
  colour: string;
}

export interface JobScenes {
  trays: ScenePart[];
  models: ScenePart[];
}

// page.glb: both scenes in one file.
export async function readScenes(glb: ArrayBuffer): Promise<JobScenes> {
  const { scenes } = await new GLTFLoader().parseAsync(glb, '');
  return { trays: partsOf(scenes[0]), models: partsOf(scenes[1]) };
}

// preview.glb or assembly.glb: one scene.
export async function readParts(glb: ArrayBuffer): Promise<ScenePart[]> {
  return partsOf((await new GLTFLoader().parseAsync(glb, '')).scene);
}

function partsOf(scene: Object3D | undefined): ScenePart[] {
  const parts: ScenePart[] = [];
  scene?.traverse((node) => {
    const id = Number((node.userData as { part?: number }).part ?? /\d+$/.exec(node.name)?.[0]);
    if (!(node instanceof Mesh) || !Number.isInteger(id)) return;
    const own = node.material as MeshStandardMaterial;
    const colour = own.color instanceof Color ? own.color : new Color(0.7, 0.7, 0.7);
    node.material = new MeshStandardMaterial({ color: colour, roughness: 0.62, metalness: 0 });
    parts.push({ id, mesh: node, colour: `#${colour.getHexString()}` });
  });
  return parts;
}
