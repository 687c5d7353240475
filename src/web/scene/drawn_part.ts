// A part on its way from one look to another.
import type { Mesh, MeshStandardMaterial, Vector3 } from 'three';
import type { Way } from './way';
import type { Look } from '../job/looks';

const OPACITY: Record<Look, number> = { solid: 1, chosen: 1, dim: 0.3, ghost: 0.1, gone: 0 };
const SETTLED = 0.004;
const FADES_FROM = 0.55;  // of the way out

export class DrawnPart {
  private look: Look = 'solid';
  private opacity = 1;
  private out = 0;  // of the way off the tray
  private readonly place: Vector3;

  constructor(readonly id: number, readonly mesh: Mesh, private readonly way: Way | null) {
    this.place = mesh.position.clone();
  }

  get solid(): boolean {
    return this.look === 'solid' || this.look === 'chosen';
  }

  get present(): boolean {
    return this.look !== 'gone';
  }

  show(look: Look): void {
    this.look = look;
  }

  // Moves on by a fraction of what is left to do; false once nothing is.
  step(fraction: number): boolean {
    const goal = this.look === 'gone' ? 1 : 0;
    // a part leaves in its own colour and fades at the end of its way
    const opacity = this.look === 'gone' ? Math.min(1, (1 - this.out) / (1 - FADES_FROM)) : OPACITY[this.look];
    this.out = settle(this.out, goal, fraction);
    this.opacity = settle(this.opacity, opacity, this.look === 'gone' ? 1 : fraction);
    this.draw();
    return this.out !== goal || this.opacity !== OPACITY[this.look];
  }

  private draw(): void {
    const material = this.mesh.material as MeshStandardMaterial;
    const through = this.opacity < 1;
    if (material.transparent !== through) material.needsUpdate = true;
    material.transparent = through;
    material.opacity = this.opacity;
    material.depthWrite = this.opacity > 0.5;
    material.emissive.copy(material.color).multiplyScalar(this.look === 'chosen' ? 0.22 : 0);
    this.mesh.visible = this.opacity > 0;
    this.mesh.renderOrder = through ? 1 : 0;
    this.mesh.position.copy(this.place);
    if (this.way && this.out > 0) this.mesh.position.add(this.way.at(this.out));
  }
}

function settle(value: number, goal: number, fraction: number): number {
  const next = value + (goal - value) * fraction;
  return Math.abs(goal - next) < SETTLED ? goal : next;
}
