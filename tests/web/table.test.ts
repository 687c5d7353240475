import { expect, test } from 'vitest';
import { columnsOf } from '../../src/web/job/table';
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
