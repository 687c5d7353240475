import { expect, test } from 'vitest';
import { afterArrival, bytes, count, difference, duration, grams, heaterName, jobBadge, money, percent, sentence, startInWords, storageInWords, troublesOf, troubleInWords } from '../../src/web/words';
import { ownEstimate, type Job, type Printer } from '../../src/web/daemon/types';

const plain = (text: string): string => text.replaceAll('\u00a0', ' ');

test('durations are short and never round to 60', () => {
  expect([0, 59.4, 59.6, 3569, 3599, 3600, 5 * 3600 + 300, 47.9 * 3600, 49 * 3600].map((s) => plain(duration(s)))).toEqual(
    ['0 s', '59 s', '1 min', '59 min', '1 h 00 min', '1 h 00 min', '5 h 05 min', '47 h 54 min', '2 d 1 h']);
  expect(plain(duration(-3))).toBe('0 s');
});

test('a print is at 100 % only when it is', () => {
  expect([0, 0.999, 1, 1.2, -1].map((f) => plain(percent(f)))).toEqual(['0 %', '99 %', '100 %', '100 %', '0 %']);
});

test('differences carry their sign and are silent where nothing can be compared', () => {
  expect([[62, 141], [30, 22], [22, 22], [1, 0], [null, 3], [3, null]].map(([a, b]) => plain(difference(a, b)))).toEqual(
    ['−56 %', '+36 %', '±0 %', '', '', '']);
});

test('figures', () => {
  expect([0, 1023, 1536, 1 << 30].map((n) => plain(bytes(n)))).toEqual(['0 bytes', '1,023 bytes', '1.5 KiB', '1 GiB']);
  expect([4.21, 62.3, 1410].map((g) => plain(grams(g)))).toEqual(['4.2 g', '62 g', '1.41 kg']);
  expect(money(9.7, 'EUR')).toBe('€9.70');
  expect(money(9.7, 'no currency')).toBe('9.70');
  expect([count(1, 'job'), count(0, 'job')]).toEqual(['1 job', '0 jobs']);
  expect(['tool', 'tool 1', 'bed', 'lid'].map(heaterName)).toEqual(['Nozzle', 'Nozzle 1', 'Bed', 'lid']);
});

test('phrases of the daemon become sentences', () => {
  expect(['', 'packing does not pay', 'It did not answer.', 'why?', 'bad.obj.toml:2: no', 'cancelled'].map(sentence)).toEqual(
    ['', 'Packing does not pay.', 'It did not answer.', 'why?', 'bad.obj.toml:2: no.', 'Cancelled.']);
});

test('what a job takes is what was prepared of it', () => {
  const estimates = { as_is: { cost: 1 }, solid: { cost: 2 }, packed: { cost: 3 } };
  const cost = (variant: string) => ownEstimate({ variant, estimates } as unknown as Job)?.cost;
  expect(['solid', 'packed', 'program', 'hollow'].map(cost)).toEqual([2, 3, 1, undefined]);
  expect(ownEstimate({ variant: '', estimates: null } as unknown as Job)).toBeUndefined();
});

test('a held job says so before anything else, and a printing one how it prints', () => {
  const job = { state: 'ready', held: false, waits_for: null, progress: null } as unknown as Job;
  expect(jobBadge(job).text).toBe('Ready to approve');
  expect(jobBadge({ ...job, held: true }).text).toBe('Held');
  expect(jobBadge({ ...job, held: true, state: 'failed' }).text, 'a hold ends with its job').toBe('Failed');
  expect(jobBadge({ ...job, state: 'sending', progress: { stage: 'waiting', fraction: 0 } }).text).toBe('Asks you');
  expect(jobBadge({ ...job, state: 'approved', waits_for: 'clear_bed' }).tone).toBe('attention');
});

test('the question before a print starts names what, where, and for how long', () => {
  const start = { job: 5, name: 'a.stl', printer: 'ender', tray: 1, trays: 1, time_s: 7800, doubt: null };
  expect(plain(startInWords(start).text)).toBe('a.stl (job 5) starts now on ender. It takes about 2 h 10 min.');
  const doubtful = { ...start, tray: 2, trays: 3, time_s: null, doubt: 'packing does not pay' };
  expect(startInWords(doubtful).text).toBe(
    'Tray 2 of 3 of a.stl (job 5) starts now on ender. How long it takes is not known. What speaks against it: packing does not pay.');
});

test('a trouble tells what, since when, and when it is tried next', () => {
  const trouble = { about: 'database', what: 'its disk is full', since_s: 0, tries: 1, next_s: null };
  expect(troubleInWords(trouble)).toMatch(/^Database: its disk is full\. Since .*1970.*\.$/);
  expect(troubleInWords({ ...trouble, about: undefined, tries: 7, next_s: 90 })).toMatch(/^Its disk is full\. .*, tried 7 times, next at .*\d/);
});

test('what is wrong with a printer is told as the daemon tells it, also by one of before', () => {
  const trouble = { about: 'folder', what: 'its disk hangs', since_s: 0, tries: 0, next_s: null };
  expect(troublesOf({ trouble: 'its disk hangs', troubles: [trouble] } as Printer)).toEqual([expect.stringMatching(/^Its disk hangs\. Since /)]);
  expect(troublesOf({ trouble: 'its disk hangs' } as Printer)).toEqual(['Its disk hangs.']);
  expect(troublesOf({ trouble: null } as Printer)).toEqual([]);
  expect(troublesOf({} as Printer)).toEqual([]);
});

test('a disk is spoken of only where somebody has to do something', () => {
  const storage = { free_bytes: 3 << 28, low: false, keep_days: 90, keep_jobs: 1000, announced: null };
  expect(storageInWords(storage)).toBe('');
  expect(plain(storageInWords({ ...storage, low: true }))).toMatch(/^The daemon’s disk has only 768 MiB left/);
  expect(storageInWords({ ...storage, announced: { from_s: 0, jobs: 1 } })).toMatch(/1970.* on the files of 1 ended job are deleted \(keep_days = 90/);
});

test('what is sent is not said to be printed, and what waits for nobody is not said to wait', () => {
  expect(jobBadge({ state: 'sending', progress: null } as Job).text).toBe('Sending');
  expect(afterArrival({ approve: 'auto' } as Printer)).toContain('by itself');
  expect(afterArrival({ approve: 'ask' } as Printer)).toContain('waits here for you to approve');
});
