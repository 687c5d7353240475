// Does what a button says: asks for the key where there is none, tells how it went.
import { complain, say } from './notes';
import { Refusal } from '../daemon/api';
import { readKey } from '../daemon/key';
import { store } from '../store';

let waiting: (() => void) | null = null;

// Runs action once there is a key; forgotten when the person closes the dialogue without giving one.
export function withKey(why: string, action: () => void): void {
  if (readKey() !== '') return action();
  waiting = action;
  store.set({ asksForKey: why });
}

export function keyGiven(): void {
  const action = waiting;
  waiting = null;
  action?.();
}

export function keyRefused(): void {
  waiting = null;
}

export function act(request: () => Promise<unknown>, done: string): void {
  const run = async (): Promise<void> => {
    try {
      await request();
      say(done);
    } catch (error) {
      if (!(error instanceof Refusal) || error.status !== 401) return complain(error);
      waiting = () => act(request, done);
      store.set({ asksForKey: `${error.what}.` });
    }
  };
  withKey('What you are about to do changes something, and that needs a key.', () => void run());
}
