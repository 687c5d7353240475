import { expect, test } from 'vitest';
import { cheaperWay } from '../../src/web/job/table';
import type { Estimates } from '../../src/web/daemon/types';

const costs = (way: Record<string, number | null>): Estimates =>
  Object.fromEntries(Object.entries(way).map(([name, cost]) => [name, { fits: cost !== null, cost }])) as unknown as Estimates;

test('a cheaper way is named only where there is one that fits', () => {
  expect(cheaperWay(costs({ as_is: 9, solid: 8, hollow: 4, packed: 5 }), 'packed')).toBe('hollow');
  expect(cheaperWay(costs({ as_is: 9, solid: 8, hollow: null, packed: 5 }), 'packed')).toBe('');
  expect(cheaperWay(costs({ as_is: null, solid: null, hollow: null, packed: 5 }), 'packed')).toBe('');
  expect(cheaperWay(costs({ solid: 5, packed: 5 }), 'packed')).toBe('');
  expect(cheaperWay(costs({ solid: 5 }), ''), 'a program that somebody else made').toBe('');
  expect(cheaperWay(null, 'packed')).toBe('');
});
