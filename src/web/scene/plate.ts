// The plate with lines every 10 mm, the areas that are kept out of it and the edges of the build volume, one for each tray.
import { BufferGeometry, Group, LineBasicMaterial, LineSegments, Vector3 } from 'three';
import { hatching, piecesWithin, sides } from './outline';
import { inScene } from './way';
import type { Stretch } from './outline';
import type { Report, Vec2 } from '../daemon/types';

const LINE_EVERY_MM = 10;
const HATCH_EVERY_MM = 4;
const STRONG_EVERY = 5;  // lines
const MOST_UPRIGHT = 12; // edges: of a round plate more would be a curtain
const APART = 1.1;       // build widths between two trays, as the scene has them

export class Plates extends Group {
  private readonly fine = new LineBasicMaterial({ transparent: true, opacity: 0.22 });
  private readonly strong = new LineBasicMaterial({ transparent: true, opacity: 0.55 });

  constructor(printer: Report['printer'], trays: number) {
    super();
    for (let tray = 0; tray < trays; tray += 1)
      this.add(this.plate(printer).translateX(tray * APART * inScene(printer.build_mm).x));
  }

  private plate({ build_mm: [width, depth, height], plate_mm, keep_out_mm }: Report['printer']): Group {
    const rectangle: Vec2[] = [[0, 0], [width, 0], [width, depth], [0, depth]];
    const outline = plate_mm?.length ? plate_mm : rectangle;
    const fine: Vector3[] = [];
    const strong: Vector3[] = [];
    const edges: Vector3[] = [];
    const add = (points: Vector3[], stretches: Stretch[], z: number): void => {
      for (const ends of stretches) points.push(...ends.map(([x, y]) => inScene([x, y, z])));
    };
    const lines = (length: number, end: (mm: number) => Stretch): void => {
      for (let i = 1; i * LINE_EVERY_MM < length; i += 1)
        add(i % STRONG_EVERY === 0 ? strong : fine, piecesWithin(outline, ...end(i * LINE_EVERY_MM)), 0);
    };
    lines(width, (mm) => [[mm, 0], [mm, depth]]);
    lines(depth, (mm) => [[0, mm], [width, mm]]);
    for (const area of keep_out_mm ?? []) add(strong, hatching(area, HATCH_EVERY_MM), 0);
    for (const z of [0, height]) add(edges, sides(outline), z);
    const every = Math.ceil(outline.length / MOST_UPRIGHT);
    for (const [x, y] of outline.filter((_, i) => i % every === 0)) edges.push(inScene([x, y, 0]), inScene([x, y, height]));
    const group = new Group();
    group.add(this.drawn(fine, this.fine), this.drawn(strong, this.fine), this.drawn(edges, this.strong));
    return group;
  }

  private drawn(points: Vector3[], material: LineBasicMaterial): LineSegments {
    return new LineSegments(new BufferGeometry().setFromPoints(points), material);
  }

  colour(css: string): void {
    this.fine.color.set(css);
    this.strong.color.set(css);
  }
}
