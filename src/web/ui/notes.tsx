// What happened, said at the edge of the page and to those who listen. Troubles stay until they are closed.
import { useEffect, useState } from 'preact/hooks';
import { Icon } from './icons';
import { Refusal } from '../daemon/api';
import { Store } from '../store';

interface Note {
  id: number;
  bad: boolean;
  text: string;
  hint: string;
  href: string;
}

const GOOD_MS = 7_000;
const MOST = 4;
const notes = new Store<{ list: Note[] }>({ list: [] });
let last = 0;

function close(id: number): void {
  notes.set({ list: notes.get().list.filter((note) => note.id !== id) });
}

function add(note: Omit<Note, 'id'>): number {
  last += 1;
  notes.set({ list: [...notes.get().list, { ...note, id: last }].slice(-MOST) });
  return last;
}

export function say(text: string, href = ''): void {
  const id = add({ bad: false, text, hint: '', href });
  setTimeout(() => close(id), GOOD_MS);
}

export function complain(error: unknown): void {
  if (error instanceof Refusal) add({ bad: true, text: error.what, hint: error.hint, href: '' });
  else add({ bad: true, text: 'The page made a mistake', hint: String(error), href: '' });
}

export function Notes() {
  const [{ list }, setNotes] = useState(notes.get());
  useEffect(() => notes.listen(() => setNotes(notes.get())), []);
  return (
    <div class="notes" role="log" aria-live="polite" aria-label="Messages">
      {list.map((note) => (
        <div key={note.id} class={note.bad ? 'note bad' : 'note good'}>
          <Icon name={note.bad ? 'warning' : 'check'} />
          <div>
            <strong>{note.text}</strong>
            {note.hint ? <div>{note.hint}</div> : null}
            {note.href ? <>{' '}<a href={note.href}>Open it</a></> : null}
          </div>
          <button type="button" class="icon-button" aria-label="Close this message" onClick={() => close(note.id)}>
            <Icon name="close" />
          </button>
        </div>
      ))}
    </div>
  );
}
