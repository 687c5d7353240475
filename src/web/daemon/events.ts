// Keeps the store up to date: one stream of events, begun again whenever it ends.
import { noAnswer, Refusal, request } from './api';
import { parsed } from './shown';
import { EventReader } from './sse';
import { store } from '../store';
import type { State } from './types';

const SILENCE_MS = 25_000;  // the daemon says something every ten seconds
const LONGEST_WAIT_MS = 8_000;

let running: AbortController | null = null;
let again: number | undefined;
let failures = 0;

// Begins, or begins anew with another key.
export function watch(): void {
  clearTimeout(again);
  running?.abort();
  failures = 0;
  void listen();
}

function rest(): void {
  clearTimeout(again);
  running?.abort();
}

// A page that nobody sees leaves its connection to those that are seen.
export function watchWhileVisible(): void {
  document.addEventListener('visibilitychange', () => (document.hidden ? rest() : watch()));
  watch();
}

async function listen(): Promise<void> {
  const control = new AbortController();
  running = control;
  try {
    await read(control);
    throw noAnswer();  // the daemon ended the stream
  } catch (error) {
    if (running !== control || document.hidden) return;
    lost(error instanceof Refusal ? error : noAnswer());
  }
}

async function read(control: AbortController): Promise<void> {
  let guard = setTimeout(() => control.abort(), SILENCE_MS);
  const reply = await request('events', { signal: control.signal });
  const stream = reply.body?.pipeThrough(new TextDecoderStream()).getReader();
  const events = new EventReader();
  for (;;) {
    const piece = await stream?.read();
    if (piece === undefined || piece.done) break;
    clearTimeout(guard);
    guard = setTimeout(() => control.abort(), SILENCE_MS);
    for (const data of events.take(piece.value)) {
      failures = 0;
      const { result } = parsed<{ result: State }>(data);
      store.set({ ...result, link: { kind: 'live' } });
    }
  }
  clearTimeout(guard);
}

// A wrong key, also one of too many (429), is not tried again by itself.
function lost(refusal: Refusal): void {
  if (refusal.status === 401 || refusal.status === 429) return store.set({ link: { kind: 'key', refusal } });
  failures += 1;
  store.set({ link: { kind: 'lost', refusal } });
  again = setTimeout(() => void listen(), Math.min(LONGEST_WAIT_MS, 500 * 2 ** Math.min(failures, 5)));
}
