import { expect, test } from 'vitest';
import { refusalOf } from '../../src/web/daemon/api';
import { changed, follows, whole, type Change } from '../../src/web/daemon/changes';
import { EventReader } from '../../src/web/daemon/sse';
import type { State, ToldState } from '../../src/web/daemon/types';
import { forbids } from '../../src/web/daemon/upload_rules';
import { routeOf } from '../../src/web/route';

test('events are whole however the stream is cut', () => {
  const text = ': still here\n\nevent: state\nid: r.4\ndata: {"a":1}\n\nevent: delta\nid: r.5\ndata: {"b":\ndata: 2}\n\n';
  for (let cut = 0; cut <= text.length; cut += 1) {
    const reader = new EventReader();
    expect([...reader.take(text.slice(0, cut)), ...reader.take(text.slice(cut))]).toEqual([
      { name: 'state', id: 'r.4', data: '{"a":1}' }, { name: 'delta', id: 'r.5', data: '{"b":\n2}' }]);
  }
});

test('changes lead from one state to the next, in the daemon’s order', () => {
  const job = (id: number, ended_s: number | null, more: object = {}) => ({ id, ended_s, progress: null, ...more });
  const state = {
    jobs: [job(9, null), job(4, null, { progress: { fraction: 0.5 } }), job(7, 50), job(3, 50), job(8, 40)],
    printers: [{ name: 'b', paused: false }, { name: 'd', paused: true }],
    storage: { free_bytes: 5, low: false },
    troubles: [],
  } as unknown as State;
  const change = {
    jobs: [{ id: 4, progress: null, ended_s: 60 }, job(10, null)],
    printers: [{ name: 'd', paused: false }, { name: 'c', paused: true }],
    storage: { free_bytes: 4 },
    troubles: [{ about: 'database' }],
    gone: { jobs: [8], printers: ['b'] },
  } as unknown as Change;
  expect(changed(state, change)).toEqual({
    jobs: [job(10, null), job(9, null), job(4, 60), job(7, 50), job(3, 50)],
    printers: [{ name: 'c', paused: true }, { name: 'd', paused: false }],
    storage: { free_bytes: 4, low: false },
    troubles: [{ about: 'database' }],
  });
  expect(changed(state, {})).toEqual(state);
  expect(changed(state, {}).jobs[0], 'what did not change is the same object').toBe(state.jobs[0]);
});

test('a daemon of before, which prints on, tells less of its state', () => {
  const told = { jobs: [], printers: [{ name: 'b' }] } as unknown as ToldState;
  expect(whole(told)).toEqual({ ...told, storage: null, troubles: [] });
  expect(changed(whole(told), {}), 'and of what changed').toEqual(whole(told));
  const full = { ...told, storage: { free_bytes: 5 }, troubles: [{ about: 'database' }] } as unknown as State;
  expect(whole(full)).toEqual(full);
});

test('a change counts only right after the one before it', () => {
  expect(follows('run.10', 'run.9')).toBe(true);
  for (const [id, last] of [['run.11', 'run.9'], ['run.9', 'run.9'], ['other.10', 'run.9'], ['run.1', ''], ['', 'run.1'], ['', '']] as const)
    expect(follows(id, last), `${id} after ${last}`).toBe(false);
});

test('refusals are told in the daemon’s words, and in some words whatever comes back', () => {
  const told = refusalOf(429, '{"error": {"what": "Too many", "hint": "Wait"}}');
  expect([told.status, told.what, told.hint]).toEqual([429, 'Too many', 'Wait']);
  for (const body of ['', '<html>Bad gateway</html>', '{}', 'null', '{"error": 3}'])
    expect(refusalOf(502, body).what).toContain('502');
});

test('what the daemon would refuse is refused before it is sent', () => {
  const rules = { most_bytes: 1 << 20, endings: ['.stl', '.obj'], formats: ['STL', 'OBJ'] };
  expect(forbids({ name: 'A.STL', size: 5 }, rules)).toBeNull();
  expect(forbids({ name: 'a.exe', size: 5 }, rules)?.status).toBe(415);
  expect(forbids({ name: 'a.stl.exe', size: 5 }, rules)?.hint).toContain('STL or OBJ');
  expect(forbids({ name: 'a.stl', size: 2 << 20 }, rules)?.status).toBe(413);
  expect(forbids({ name: 'a.stl', size: 0 }, rules)?.status).toBe(422);
  expect(forbids({ name: 'a.exe', size: 0 }, null), 'the daemon decides where its rules are not known').toBeNull();
});

test('addresses within the page', () => {
  expect(routeOf('#/jobs/12')).toEqual({ view: 'job', id: 12 });
  for (const hash of ['', '#/', '#/jobs/', '#/jobs/x', '#/jobs/1/../2', '#/jobs/99999999999999999999', '#javascript:alert(1)'])
    expect(routeOf(hash)).toEqual({ view: 'now' });
});
