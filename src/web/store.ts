// What the page knows, in one place; views draw themselves anew when it changes.
import { useEffect, useState } from 'preact/hooks';
import type { Refusal } from './daemon/api';
import type { Job, Printer, Storage, Trouble, UploadRules } from './daemon/types';

export type Link =
  | { kind: 'connecting' }
  | { kind: 'live' }
  | { kind: 'lost'; refusal: Refusal }
  | { kind: 'key'; refusal: Refusal };

export interface Sending {
  id: number;
  name: string;
  printer: string;
  fraction: number;
  refusal: Refusal | null;
  stop: () => void;
}

export interface Known {
  link: Link;
  jobs: Job[] | null;  // null: not told yet
  printers: Printer[];
  storage: Storage | null;
  troubles: Trouble[];
  rules: UploadRules | null;
  sending: Sending[];
  asksForKey: string | null;  // why the key is asked for
}

export class Store<T extends object> {
  private readonly listeners = new Set<() => void>();
  constructor(private value: T) {}

  get(): T {
    return this.value;
  }

  set(change: Partial<T>): void {
    this.value = { ...this.value, ...change };
    for (const listener of this.listeners) listener();
  }

  listen(listener: () => void): () => void {
    this.listeners.add(listener);
    return () => this.listeners.delete(listener);
  }
}

export const store = new Store<Known>({
  link: { kind: 'connecting' }, jobs: null, printers: [], storage: null, troubles: [], rules: null, sending: [], asksForKey: null,
});

export function useKnown(): Known {
  const [known, setKnown] = useState(store.get());
  useEffect(() => {
    setKnown(store.get());
    return store.listen(() => setKnown(store.get()));
  }, []);
  return known;
}
