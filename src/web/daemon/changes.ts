// How what the page knows follows the daemon: a state, and then only what changed (docs/API.md).
import type { Job, Printer, State, Storage, ToldState, Trouble } from './types';

// Of jobs and printers the keys that have another value; new ones are whole.
export interface Change {
  jobs?: (Partial<Job> & Pick<Job, 'id'>)[];
  printers?: (Partial<Printer> & Pick<Printer, 'name'>)[];
  storage?: Partial<Storage>;
  troubles?: Trouble[];  // all of them
  gone?: { jobs?: number[]; printers?: string[] };
}

export const whole = (told: ToldState): State => ({ storage: null, troubles: [], ...told });

export function changed(state: State, { jobs = [], printers = [], storage, troubles = state.troubles, gone = {} }: Change): State {
  return {
    jobs: merged(state.jobs, jobs, gone.jobs, (job) => job.id).sort(inOrder),
    printers: merged(state.printers, printers, gone.printers, (printer) => printer.name)
      .sort((a, b) => (a.name < b.name ? -1 : 1)),
    storage: storage === undefined ? state.storage : { ...state.storage, ...storage } as Storage,
    troubles,
  };
}

function merged<T, K>(known: T[], changes: Partial<T>[], gone: K[] = [], keyOf: (one: T) => K): T[] {
  const all = new Map(known.map((one) => [keyOf(one), one]));
  for (const change of changes) {
    const key = keyOf(change as T);
    all.set(key, { ...all.get(key), ...change } as T);
  }
  for (const key of gone) all.delete(key);
  return [...all.values()];
}

// What has not ended, then what ended last; among equals the newest first.
function inOrder(a: Job, b: Job): number {
  const ended = (job: Job): number => job.ended_s ?? Infinity;
  return ended(a) === ended(b) ? b.id - a.id : ended(b) - ended(a);
}

// Whether the event with this id comes right after that one: both are RUN.NUMBER of one run of the daemon.
export function follows(id: string, last: string): boolean {
  const [run, number] = id.split('.');
  const [lastRun, lastNumber] = last.split('.');
  return run === lastRun && Number(number) === Number(lastNumber) + 1;
}
