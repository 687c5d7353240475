// Printers and queue: what happens now, and what waits for a person.
import { PrinterCard } from './printer_card';
import { QueueRow } from './queue';
import { Uploads } from './uploads';
import { hasEnded, type Job } from '../daemon/types';
import type { Known } from '../store';
import { Empty } from '../ui/bits';
import { afterArrival, count, jobBadge } from '../words';

// Those that wait for a person first, then those at work, then the others in the order they came.
function inOrder(jobs: Job[]): Job[] {
  const rank = (job: Job): number => ['attention', 'busy'].indexOf(jobBadge(job).tone) + 1 || 3;
  return jobs.filter((job) => !hasEnded(job)).sort((a, b) => rank(a) - rank(b) || (b.turn ?? 0) - (a.turn ?? 0) || a.id - b.id);
}

export function NowView({ known }: { known: Known }) {
  const jobs = known.jobs ?? [];
  const queue = inOrder(jobs);
  return (
    <>
      <h1 class="unseen">Printers and queue</h1>
      {known.printers.length > 0 ? <Uploads known={known} /> : null}
      <div class="now">
        <section aria-labelledby="printers-title">
          <h2 id="printers-title">Printers</h2>
          {known.printers.length === 0 ? <NoPrinters /> : (
            <ul class="printers">
              {known.printers.map((printer) => (
                <PrinterCard key={printer.name} printer={printer} job={jobs.find((job) => job.id === printer.job)} />
              ))}
            </ul>
          )}
        </section>
        <section aria-labelledby="queue-title">
          <h2 id="queue-title">Queue <span class="quiet-text">{queue.length > 0 ? count(queue.length, 'job') : ''}</span></h2>
          {queue.length === 0 ? <NoJobs known={known} /> : (
            <ul class="queue">{queue.map((job) => <QueueRow key={job.id} job={job} />)}</ul>
          )}
        </section>
      </div>
    </>
  );
}

function NoPrinters() {
  return (
    <Empty title="No printer yet">
      Name one in the daemon’s settings, <code>/etc/packmerger/packmergerd.toml</code>, then reload them with{' '}
      <code>systemctl reload packmergerd</code>. <code>packmerger devices</code> shows what is connected.
    </Empty>
  );
}

function NoJobs({ known }: { known: Known }) {
  const first = known.printers[0];
  if (first === undefined) return <Empty title="Nothing to do">Jobs appear here once there is a printer.</Empty>;
  return (
    <Empty title="Nothing to do">
      Drop a model on this page, or copy it into <code>{first.folder}</code>: {afterArrival(first)}
    </Empty>
  );
}
