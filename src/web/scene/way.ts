// The way a part takes off its tray: along the job's steps, then straight up until nothing is in its way.
import { Vector3 } from 'three';
import type { Vec3 } from '../daemon/types';

const METRES_PER_MM = 1e-3;

// From the tray's mm, z up, to the scene's metres, y up.
export const inScene = ([x, y, z]: Vec3): Vector3 => new Vector3(x, z, -y).multiplyScalar(METRES_PER_MM);

export class Way {
  private readonly corners: Vector3[] = [new Vector3()];

  constructor(steps: readonly Vec3[], lift: number) {
    for (const step of steps) this.corners.push(this.end().add(inScene(step)));
    this.corners.push(this.end().add(new Vector3(0, lift, 0)));
  }

  private end(): Vector3 {
    return (this.corners.at(-1) ?? new Vector3()).clone();
  }

  // Where the part is after a fraction of its whole way.
  at(fraction: number): Vector3 {
    const lengths = this.corners.slice(1).map((corner, i) => corner.distanceTo(this.corners[i] ?? corner));
    let rest = fraction * lengths.reduce((sum, length) => sum + length, 0);
    for (const [i, length] of lengths.entries()) {
      const [from, to] = [this.corners[i], this.corners[i + 1]];
      if (from && to && rest <= length) return from.clone().lerp(to, length > 0 ? rest / length : 1);
      rest -= length;
    }
    return this.end();
  }
}
