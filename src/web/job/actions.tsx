// What may be done with a job in its present state.
import { changeJob, changePrinter, type JobVerb, type PrinterVerb } from '../daemon/api';
import { hasEnded, type Job } from '../daemon/types';
import { act } from '../ui/act';
import { ask } from '../ui/ask';
import { Button } from '../ui/bits';

export type Deed = JobVerb | 'clear' | 'resume';

// In the order of their weight; the first is what most people want next.
export function deedsFor(job: Job): Deed[] {
  if (hasEnded(job)) return ['again'];
  const deeds: Deed[] = [];
  if (job.waits_for === 'clear_bed') deeds.push('clear');
  if (job.waits_for === 'paused') deeds.push('resume');
  if (job.state === 'ready' || job.held) deeds.push('approve');
  if (job.state !== 'sending' && job.state !== 'claiming' && !job.held) deeds.push('hold');
  if (job.state === 'received' || (job.state === 'approved' && !job.held)) deeds.push('first');
  if (job.state !== 'claiming') deeds.push('cancel');
  return deeds;
}

function askToCancel(job: Job): void {
  const prints = job.state === 'sending';
  ask({
    title: `Cancel job ${job.id}?`,
    text: prints ? `The print of ${job.name} ends, and cannot be taken up again where it was.`
                 : `${job.name} is not printed. You can print it again later from the history.`,
    yes: 'Cancel the job', no: prints ? 'Let it print' : 'Keep it',
    act: () => act((starts) => changeJob(job.id, 'cancel', starts), `Job ${job.id} is cancelled`),
  });
}

const queuedAgain = (job: Job): string =>
  (job.waits_for === 'approval' ? `${job.name} is job ${job.id} now, and waits for your approval` : `${job.name} is queued again, as job ${job.id}`);

function DeedButton({ deed, job, first }: { deed: Deed; job: Job; first: boolean }) {
  const about = `job ${job.id}, ${job.name}`;
  const primary = first ? { kind: 'primary' as const } : {};
  const change = (verb: JobVerb, done: string) => () => act((starts) => changeJob(job.id, verb, starts), done);
  const printer = (verb: PrinterVerb, done: string) => () => act((starts) => changePrinter(job.printer, verb, starts), done);
  switch (deed) {
    case 'clear':
      return <Button {...primary} icon="bed" label={`The bed of ${job.printer} is clear`}
                     onClick={printer('clear', `The bed of ${job.printer} is clear`)}>Bed is clear</Button>;
    case 'resume':
      return <Button {...primary} icon="play" label={`Resume ${job.printer}`}
                     onClick={printer('resume', `${job.printer} goes on`)}>Resume the printer</Button>;
    case 'approve': {
      const word = job.state === 'ready' ? 'Approve' : 'Let it go on';
      return <Button {...primary} icon="check" label={`${word}: ${about}`}
                     onClick={change('approve', job.state === 'ready' ? `Job ${job.id} is approved` : `Job ${job.id} goes on`)}>{word}</Button>;
    }
    case 'hold':
      return <Button icon="hold" label={`Hold ${about}`} onClick={change('hold', `Job ${job.id} is held`)}>Hold</Button>;
    case 'first':
      return <Button icon="first" label={`Put first: ${about}`} onClick={change('first', `Job ${job.id} goes first`)}>Put first</Button>;
    case 'cancel':
      return <Button icon="close" kind="danger" label={`Cancel ${about}`} onClick={() => askToCancel(job)}>Cancel</Button>;
    case 'again':
      return <Button icon="again" label={`Print again: ${about}`} onClick={() => act((starts) => changeJob(job.id, 'again', starts), queuedAgain)}>Again</Button>;
  }
}

export function JobButtons({ job }: { job: Job }) {
  const primary = new Set<Deed>(['clear', 'resume', 'approve']);
  return (
    <div class="buttons">
      {deedsFor(job).map((deed, index) => (
        <DeedButton key={deed} deed={deed} job={job} first={index === 0 && primary.has(deed)} />
      ))}
    </div>
  );
}
