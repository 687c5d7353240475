import { expect, test } from 'vitest';
import { parsed, shown } from '../../src/web/daemon/shown';

test('what turns the writing direction or is not seen is shown as a mark', () => {
  expect(shown('bär 熊 🐻.stl')).toBe('bär 熊 🐻.stl');
  expect(shown('cat\u202elts.gcode')).toBe('cat\ufffdlts.gcode');
  expect(shown('\u2066a\u200b\ufeff\u2028\u0085\u0007')).toBe('\ufffda\ufffd\ufffd\ufffd\ufffd\ufffd');
  expect(shown('a line\nand\tanother')).toBe('a line\nand\tanother');
  expect(shown('\u{e0041}')).toBe('\ufffd');
});

test('in an answer every text is so', () => {
  expect(parsed('{"jobs":[{"name":"a\\u202eb","id":3}],"left":null}')).toEqual(
    { jobs: [{ name: 'a\ufffdb', id: 3 }], left: null });
});
