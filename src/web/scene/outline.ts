// Polygons on a plate, in mm of the tray.
import type { Vec2 } from '../daemon/types';

export type Stretch = [Vec2, Vec2];

// The sides, the last of which leads back to the first corner.
export const sides = (polygon: readonly Vec2[]): Stretch[] =>
  polygon.map((corner, i) => [corner, polygon[(i + 1) % polygon.length] ?? corner]);

const between = ([ax, ay]: Vec2, [bx, by]: Vec2, share: number): Vec2 => [ax + share * (bx - ax), ay + share * (by - ay)];

const contains = (polygon: readonly Vec2[], [x, y]: Vec2): boolean =>
  sides(polygon).filter(([[ax, ay], [bx, by]]) =>
    (ay > y) !== (by > y) && x < ax + ((y - ay) / (by - ay)) * (bx - ax)).length % 2 === 1;

// What of a stretch lies within the polygon, in order.
export function piecesWithin(polygon: readonly Vec2[], from: Vec2, to: Vec2): Stretch[] {
  const [dx, dy] = [to[0] - from[0], to[1] - from[1]];
  const cuts = [0, 1];
  for (const [[ax, ay], [bx, by]] of sides(polygon)) {
    const across = dx * (by - ay) - dy * (bx - ax);
    if (across === 0) continue;
    const along = ((ax - from[0]) * (by - ay) - (ay - from[1]) * (bx - ax)) / across;
    const onSide = ((ax - from[0]) * dy - (ay - from[1]) * dx) / across;
    if (along > 0 && along < 1 && onSide >= 0 && onSide <= 1) cuts.push(along);
  }
  cuts.sort((a, b) => a - b);
  return cuts.slice(1).flatMap((end, i): Stretch[] => {
    const begin = cuts[i] ?? 0;
    return contains(polygon, between(from, to, (begin + end) / 2)) ? [[between(from, to, begin), between(from, to, end)]] : [];
  });
}

// Slanting lines all over the polygon, and its sides.
export function hatching(polygon: readonly Vec2[], every: number): Stretch[] {
  const sums = polygon.map(([x, y]) => x + y);
  const ys = polygon.map(([, y]) => y);
  const [low, high] = [Math.min(...ys), Math.max(...ys)];
  const lines = sides(polygon);
  for (let sum = Math.min(...sums) + every / 2; sum < Math.max(...sums); sum += every)
    lines.push(...piecesWithin(polygon, [sum - low, low], [sum - high, high]));
  return lines;
}
