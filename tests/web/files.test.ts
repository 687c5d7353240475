import { expect, test } from 'vitest';
import type { Job } from '../../src/web/daemon/types';
import { filesOf } from '../../src/web/job/files';

const names = (job: Partial<Job>, dialect: string) =>
  filesOf({ kind: 'program', trays: 2, ...job } as Job, dialect).map(({ file }) => file);

test('the program is the one that the daemon tells, whatever the dialect', () => {
  const tray_files = [{ file: 'program.abc', sha256: '' }, { file: 'program-2.abc', sha256: '' }];
  expect(names({ tray_files }, 'new')).toEqual(['program.abc', 'program-2.abc', 'job.json']);
});

test('a printer that is given documents has none', () => {
  expect(names({ tray_files: [{ file: 'tray.stl', sha256: '' }] }, 'usb')).toEqual(['job.json']);
});

test('jobs of earlier versions have it by their dialect', () => {
  expect(names({ tray_files: null }, 's3g')).toEqual(['program.x3g', 'program-2.x3g', 'job.json']);
  expect(names({ tray_files: null }, 'handoff')).toEqual(['job.json']);
});
