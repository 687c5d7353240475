import { expect, test } from 'vitest';
import { refusalOf } from '../../src/web/daemon/api';
import { EventReader } from '../../src/web/daemon/sse';
import { forbids } from '../../src/web/daemon/upload_rules';
import { routeOf } from '../../src/web/route';

test('events are whole however the stream is cut', () => {
  const text = ': still here\n\nevent: state\ndata: {"a":1}\n\nevent: state\ndata: {"b":\ndata: 2}\n\n';
  for (let cut = 0; cut <= text.length; cut += 1) {
    const reader = new EventReader();
    expect([...reader.take(text.slice(0, cut)), ...reader.take(text.slice(cut))]).toEqual(['{"a":1}', '{"b":\n2}']);
  }
});

test('refusals are told in the daemon’s words, and in some words whatever comes back', () => {
  const told = refusalOf(429, '{"error": {"what": "Too many", "hint": "Wait"}}');
  expect([told.status, told.what, told.hint]).toEqual([429, 'Too many', 'Wait']);
  for (const body of ['', '<html>Bad gateway</html>', '{}', 'null', '{"error": 3}'])
    expect(refusalOf(502, body).what).toContain('502');
});

test('what the daemon would refuse is refused before it is sent', () => {
  const rules = { most_bytes: 1 << 20, endings: ['.stl', '.obj'] };
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
