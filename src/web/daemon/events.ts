// Keeps the store up to date: one stream of events, begun again whenever it ends.
import { noAnswer, Refusal, request } from './api';
import { changed, follows, whole, type Change } from './changes';
import { parsed } from './shown';
import { EventReader, type ServerEvent } from './sse';
import { store } from '../store';
import type { State, ToldState } from './types';

const SILENCE_MS = 25_000;  // the daemon says something every ten seconds
const LONGEST_WAIT_MS = 8_000;

let running: AbortController | null = null;
let again: number | undefined;
let failures = 0;
let known: State | null = null;
let last = '';  // the id of the event that led to it

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
  const headers = last === '' ? {} : { 'Last-Event-ID': last };
  const reply = await request('events?deltas=1', { signal: control.signal, headers });
  const stream = reply.body?.pipeThrough(new TextDecoderStream()).getReader();
  const events = new EventReader();
  for (;;) {
    const piece = await stream?.read();
    if (piece === undefined || piece.done) break;
    clearTimeout(guard);
    guard = setTimeout(() => control.abort(), SILENCE_MS);
    for (const event of events.take(piece.value)) take(event);
    if (known === null) continue;
    failures = 0;
    store.set({ ...known, link: { kind: 'live' } });
  }
  clearTimeout(guard);
}

// A change that does not follow what is known is none that can be taken: then all is asked for again.
function take({ name, id, data }: ServerEvent): void {
  if (name === 'state') {
    known = whole(parsed<{ result: ToldState }>(data).result);
  } else if (name === 'delta') {
    const before = known;
    const missed = before === null || !follows(id, last);
    known = null;
    last = '';
    if (missed) throw noAnswer();
    known = changed(before, parsed<Change>(data));
  } else {
    return;
  }
  last = id;
}

// A wrong key, also one of too many (429), is not tried again by itself.
function lost(refusal: Refusal): void {
  if (refusal.status === 401 || refusal.status === 429) return store.set({ link: { kind: 'key', refusal } });
  failures += 1;
  store.set({ link: { kind: 'lost', refusal } });
  again = setTimeout(() => void listen(), Math.min(LONGEST_WAIT_MS, 500 * 2 ** Math.min(failures, 5)));
}
