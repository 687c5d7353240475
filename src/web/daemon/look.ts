// The code in a link that the daemon printed (#look=…), given for a key that lets this browser look.
import { noAnswer, refusalOf } from './api';
import { keepKey, mayChange } from './key';

// Takes the code out of the address, so that it stands in no bookmark; '' where there is none.
function takeCode(): string {
  const code = /^#look=([\w-]{1,100})$/.exec(location.hash)?.[1] ?? '';
  if (code !== '') history.replaceState(null, '', '#/');
  return code;
}

// Whether there is a new key now. Throws a Refusal where the code is no longer good. A key that may
// change something is better, and kept.
export async function lookByLink(): Promise<boolean> {
  const code = takeCode();
  if (code === '' || mayChange()) return false;
  const reply = await fetch('/api/v1/look', { method: 'POST', body: code, cache: 'no-store' }).catch(() => null);
  if (reply === null) throw noAnswer();
  const text = await reply.text();
  if (!reply.ok) throw refusalOf(reply.status, text);
  keepKey((JSON.parse(text) as { key: string }).key, true);
  return true;
}
