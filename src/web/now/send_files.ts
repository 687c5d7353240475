// Files somebody chose or dropped, on their way to a printer.
import { send } from '../daemon/upload';
import { jobHref } from '../route';
import { withKey } from '../ui/act';
import { say } from '../ui/notes';

export function sendFiles(files: FileList | readonly File[], printer: string): void {
  const list = [...files];
  if (list.length === 0) return;
  withKey('Sending a model needs a key.', () =>
    send(list, printer, (job) => say(`${job.name} is job ${job.id}`, jobHref(job.id))));
}
