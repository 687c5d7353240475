// Does what a button says: asks for the key where there is none, and before a print starts; tells how it went.
import { ask } from './ask';
import { complain, say } from './notes';
import { Refusal } from '../daemon/api';
import { mayChange } from '../daemon/key';
import { store } from '../store';
import { startInWords } from '../words';

let waiting: (() => void) | null = null;

// Runs action once there is a key that may change something; forgotten when the person closes the dialogue without giving one.
export function withKey(why: string, action: () => void): void {
  if (mayChange()) return action();
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

// request is given the job that it may start at once; 0: none yet, since nobody was asked.
export function act<T>(request: (starts: number) => Promise<T>, done: string | ((reply: T) => string), starts = 0): void {
  const run = async (): Promise<void> => {
    try {
      const reply = await request(starts);
      say(typeof done === 'string' ? done : done(reply));
    } catch (error) {
      if (!(error instanceof Refusal)) return complain(error);
      const start = error.starts;
      if (start !== null) return ask({ ...startInWords(start), act: () => act(request, done, start.job) });
      if (error.status !== 401) return complain(error);
      waiting = () => act(request, done, starts);
      store.set({ asksForKey: `${error.what}.` });
    }
  };
  withKey('What you are about to do changes something, and that needs a key.', () => void run());
}
