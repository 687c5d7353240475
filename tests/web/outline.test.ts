import { expect, test } from 'vitest';
import { hatching, piecesWithin, sides } from '../../src/web/scene/outline';
import type { Vec2 } from '../../src/web/daemon/types';

const u: Vec2[] = [[0, 0], [30, 0], [30, 20], [20, 20], [20, 5], [10, 5], [10, 20], [0, 20]];

test('a line is drawn where it lies within the plate', () => {
  expect(piecesWithin(u, [-5, 10], [25, 10])).toEqual([[[0, 10], [10, 10]], [[20, 10], [25, 10]]]);
  expect(piecesWithin(u, [-5, 30], [25, 30])).toEqual([]);
});

test('a kept-out area is hatched within its sides', () => {
  const lines = hatching(u, 4).slice(sides(u).length);
  expect(lines.length).toBeGreaterThan(10);
  for (const [[ax, ay], [bx, by]] of lines) {
    const [x, y] = [(ax + bx) / 2, (ay + by) / 2];
    expect(x >= 0 && x <= 30 && y >= 0 && y <= 20 && !(x > 10 && x < 20 && y > 5)).toBe(true);
  }
});
