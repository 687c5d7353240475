import { expect, test } from 'vitest';
import { columnsOf, isInPowder, reasonsOf } from '../../src/web/job/table';
import type { Estimates } from '../../src/web/daemon/types';

const costs = (way: Record<string, number | null>): Estimates =>
  Object.fromEntries(Object.entries(way).map(([name, cost]) => [name, { ...FIGURES, fits: cost !== null, cost }])) as unknown as Estimates;
const FIGURES = { time_s: 60, model_g: 1, support_g: 1, currency: 'EUR', parts: 1, trays: 1, assembly_min: 10 };

test('ways that are equal are one column', () => {
  const titles = (way: Record<string, number | null>) => columnsOf(costs(way)).map((column) => column.title);
  expect(titles({ as_is: 5, solid: 5, hollow: 4, packed: 4 })).toEqual(['As it stands, solid', 'Hollow, packed']);
  expect(titles({ hollow: 4, packed: 4.001 })).toEqual(['Hollow, packed']);
  expect(titles({ as_is: null, solid: null, hollow: 4, packed: 5 })).toEqual(['As it stands', 'Solid', 'Hollow', 'Packed']);
});

test('what weighs something and holds nothing up is powder', () => {
  const holding = (support_mm3: number | null) => Object.fromEntries(Object.entries(costs({ solid: 5, packed: 4 }))
    .map(([way, one]) => [way, { ...one, support_mm3 }])) as unknown as Estimates;
  expect([0, 20, null].map((mm3) => isInPowder(holding(mm3)))).toEqual([true, false, false]);
});

test('why ways cannot be made is told once', () => {
  const ways = costs({ as_is: null, solid: 5, hollow: null, packed: null });
  for (const way of ['hollow', 'packed'] as const) Object.assign(ways[way]!, { reason: 'No wall is kept', hint: 'Raise wall_mm.' });
  expect(reasonsOf(columnsOf(ways))).toEqual([{ titles: 'Hollow, Packed', text: 'No wall is kept. Raise wall_mm.' }]);
});
