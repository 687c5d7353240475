// The plate with lines every 10 mm and the edges of the build volume, one for each tray.
import { BoxGeometry, BufferGeometry, EdgesGeometry, Group, LineBasicMaterial, LineSegments, Vector3 } from 'three';
import { inScene } from './way';
import type { Vec3 } from '../daemon/types';

const LINE_EVERY_MM = 10;
const STRONG_EVERY = 5;  // lines
const APART = 1.1;       // build widths between two trays, as the scene has them

export class Plates extends Group {
  private readonly fine = new LineBasicMaterial({ transparent: true, opacity: 0.22 });
  private readonly strong = new LineBasicMaterial({ transparent: true, opacity: 0.55 });

  constructor(build: Vec3, trays: number) {
    super();
    for (let tray = 0; tray < trays; tray += 1) this.add(this.plate(build).translateX(tray * APART * inScene(build).x));
  }

  private plate([width, depth, height]: Vec3): Group {
    const group = new Group();
    const fine: Vector3[] = [];
    const strong: Vector3[] = [];
    const lines = (length: number, end: (mm: number) => [Vec3, Vec3]): void => {
      for (let i = 0; i * LINE_EVERY_MM <= length; i += 1)
        (i % STRONG_EVERY === 0 ? strong : fine).push(...end(i * LINE_EVERY_MM).map(inScene));
    };
    lines(width, (mm) => [[mm, 0, 0], [mm, depth, 0]]);
    lines(depth, (mm) => [[0, mm, 0], [width, mm, 0]]);
    const size = inScene([width, -depth, height]);
    const volume = new LineSegments(new EdgesGeometry(new BoxGeometry(size.x, size.y, size.z)), this.strong);
    volume.position.copy(inScene([width / 2, depth / 2, height / 2]));
    group.add(new LineSegments(new BufferGeometry().setFromPoints(fine), this.fine),
              new LineSegments(new BufferGeometry().setFromPoints(strong), this.fine), volume);
    return group;
  }

  colour(css: string): void {
    this.fine.color.set(css);
    this.strong.color.set(css);
  }
}
