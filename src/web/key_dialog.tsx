// Where a person pastes a key, sees whether it is right, and forgets it again.
import { useState } from 'preact/hooks';
import { Refusal, request } from './daemon/api';
import { watch } from './daemon/events';
import { forgetKey, isRemembered, keepKey, readKey } from './daemon/key';
import { store } from './store';
import { keyGiven, keyRefused } from './ui/act';
import { Button } from './ui/bits';
import { Dialog } from './ui/dialog';
import { complain, say } from './ui/notes';

export const askForKey = (why: string): void => store.set({ asksForKey: why });

export function HowToGetAKey() {
  return (
    <p class="quiet-text">
      On the machine where the daemon runs, <code>packmerger keys add NAME</code> makes one and shows it once.
      It goes to that daemon with every request, and nowhere else.
    </p>
  );
}

// Tries a key against the daemon and keeps it only when it is right.
async function tried(key: string, remember: boolean): Promise<Refusal | null> {
  const before = { key: readKey(), remember: isRemembered() };
  keepKey(key, remember);
  try {
    await request('printers');
    return null;
  } catch (error) {
    forgetKey();
    if (before.key !== '') keepKey(before.key, before.remember);
    return error instanceof Refusal ? error : new Refusal(0, String(error), '');
  }
}

export function KeyForm({ given }: { given: () => void }) {
  const [key, setKey] = useState('');
  const [remember, setRemember] = useState(isRemembered());
  const [busy, setBusy] = useState(false);
  const [refusal, setRefusal] = useState<Refusal | null>(null);
  const submit = async (event: Event): Promise<void> => {
    event.preventDefault();
    setBusy(true);
    const wrong = await tried(key.trim(), remember);
    setBusy(false);
    setRefusal(wrong);
    if (wrong) return;
    say('The key is right');
    watch();
    given();
  };
  return (
    <form onSubmit={(event) => void submit(event)}>
      <label class="field" for="key">Key
        <input id="key" type="password" autocomplete="off" spellcheck={false} required value={key} placeholder="pm_…"
               aria-describedby="key-trouble" aria-invalid={refusal !== null}
               onInput={(event) => setKey(event.currentTarget.value)} />
      </label>
      <p id="key-trouble" class="trouble" role="alert">{refusal ? `${refusal.what}. ${refusal.hint}` : ''}</p>
      <label class="choice">
        <input type="checkbox" checked={remember} onChange={(event) => setRemember(event.currentTarget.checked)} />
        <span>Remember it on this device <small>otherwise it is forgotten with this tab</small></span>
      </label>
      <div class="buttons end">
        {readKey() === '' ? null : <Button onClick={forget}>Forget the key</Button>}
        <button type="submit" class="button primary" disabled={busy || key.trim() === ''}>Use this key</button>
      </div>
    </form>
  );
}

function forget(): void {
  forgetKey();
  keyRefused();
  store.set({ asksForKey: null });
  say('The key is forgotten');
  watch();
}

export function KeyDialog({ why }: { why: string }) {
  const close = (): void => {
    keyRefused();
    store.set({ asksForKey: null });
  };
  return (
    <Dialog title="Your key" closed={close}>
      <p>{why}</p>
      <HowToGetAKey />
      <KeyForm given={() => {
        store.set({ asksForKey: null });
        try {
          keyGiven();
        } catch (error) {
          complain(error);
        }
      }} />
    </Dialog>
  );
}
