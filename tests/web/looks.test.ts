import { expect, test } from 'vitest';
import { modelLooks, ordinal, stepInWords, trayLooks, wayOut } from '../../src/web/job/looks';
import type { PackedReport } from '../../src/web/daemon/types';

const ORDER = [3, 1, 2];
const onTrays = (...trays: number[]) => trays.map((tray, index) => ({ id: index + 1, tray }));
const report = { removal_order: ORDER, parts: onTrays(1, 1, 1), removal_path: { 1: [[12.4, 0, 0], [0, -3, 0.1]], 2: [[0, 0, 0.2]] } } as unknown as PackedReport;
const list = (looks: Map<number, string>): string => [1, 2, 3].map((id) => looks.get(id)).join(' ');

test('the tray shows what is still on it, and what is chosen', () => {
  expect(list(trayLooks(ORDER, 0, null))).toBe('solid solid solid');
  expect(list(trayLooks(ORDER, 2, null))).toBe('gone solid gone');
  expect(list(trayLooks(ORDER, 1, 2))).toBe('dim chosen gone');
  expect(list(trayLooks(ORDER, 1, 3)), 'the chosen part is away').toBe('solid solid gone');
});

test('the model shows what was taken out, and where the chosen part belongs', () => {
  expect(list(modelLooks(ORDER, 0, null))).toBe('solid solid solid');
  expect(list(modelLooks(ORDER, 0, 2))).toBe('ghost chosen ghost');
  expect(list(modelLooks(ORDER, 2, null))).toBe('solid ghost solid');
  expect(list(modelLooks(ORDER, 2, 1))).toBe('chosen ghost dim');
});

test('ways out are told as a hand would take them', () => {
  expect(wayOut(report, 3)).toBe('lifted straight up');
  expect(wayOut(report, 2), 'a fraction of a millimetre is no move').toBe('lifted straight up');
  expect(wayOut(report, 1)).toBe('moved 12 mm to the right, then 3 mm to the front, then lifted');
  expect(stepInWords(report, 0)).toBe('All 3 parts are on the tray.');
  expect(stepInWords(report, 3)).toBe('Step 3 of 3: part 2, lifted straight up. The tray is empty.');
  const spread = { ...report, parts: onTrays(1, 2, 1) } as unknown as PackedReport;
  expect(stepInWords(spread, 0)).toBe('All 3 parts are on the trays.');
  expect(stepInWords(spread, 3)).toMatch(/The trays are empty\.$/);
  expect([1, 2, 3, 4, 11, 12, 13, 21, 102].map(ordinal)).toEqual(
    ['1st', '2nd', '3rd', '4th', '11th', '12th', '13th', '21st', '102nd']);
});
