// Models on their way to the daemon, one after the other. XMLHttpRequest, because fetch tells no progress.
import { keyHeaders, noAnswer, Refusal, refusalOf } from './api';
import { parsed, shown } from './shown';
import { forbids } from './upload_rules';
import { store, type Sending } from '../store';
import type { Job } from './types';

let last = 0;
let queue: Promise<void> = Promise.resolve();

function change(id: number, what: Partial<Sending>): void {
  store.set({ sending: store.get().sending.map((one) => (one.id === id ? { ...one, ...what } : one)) });
}

export function dismiss(id: number): void {
  store.set({ sending: store.get().sending.filter((one) => one.id !== id) });
}

// Calls arrived with each job that came of it.
export function send(files: readonly File[], printer: string, arrived: (job: Job) => void): void {
  for (const file of files) {
    last += 1;
    const id = last;
    const form = new XMLHttpRequest();
    const refusal = forbids(file, store.get().rules);
    const stop = (): void => {
      form.abort();
      dismiss(id);
    };
    store.set({ sending: [...store.get().sending, { id, name: shown(file.name), printer, fraction: 0, refusal, stop }] });
    if (refusal) continue;
    queue = queue.then(async () => {
      if (!store.get().sending.some((one) => one.id === id)) return;
      try {
        arrived(await post(form, file, printer, (fraction) => change(id, { fraction })));
        dismiss(id);
      } catch (error) {
        change(id, { refusal: error instanceof Refusal ? error : noAnswer() });
      }
    });
  }
}

function post(form: XMLHttpRequest, file: File, printer: string,
              progress: (fraction: number) => void): Promise<Job> {
  return new Promise((resolve, reject) => {
    const body = new FormData();
    body.append('printer', printer);
    body.append('file', file, file.name);
    form.open('POST', '/api/v1/jobs');
    for (const [name, value] of Object.entries(keyHeaders())) form.setRequestHeader(name, value);
    form.upload.onprogress = (event) => progress(event.total > 0 ? event.loaded / event.total : 0);
    form.onload = () => {
      if (form.status === 201) resolve(parsed<Job>(form.responseText));
      else reject(refusalOf(form.status, form.responseText));
    };
    form.onerror = () => reject(noAnswer());
    form.onabort = () => reject(new Refusal(0, 'Stopped', ''));
    form.send(body);
  });
}
