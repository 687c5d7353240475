// Jobs that have ended, newest first.
import { useEffect, useState } from 'preact/hooks';
import { listJobs } from '../daemon/api';
import { hasEnded, type Job } from '../daemon/types';
import { JobButtons } from '../job/actions';
import { jobHref } from '../route';
import { Badge, Button, Empty } from '../ui/bits';
import { complain } from '../ui/notes';
import { duration, jobBadge, money, when } from '../words';

const TOLD = 100;   // jobs that the stream tells
const MOST = 1000;  // that the daemon lists

export function HistoryView({ jobs }: { jobs: Job[] }) {
  const [older, setOlder] = useState<Job[]>([]);
  const [words, setWords] = useState('');
  const oldest = jobs.at(-1)?.id ?? 0;
  useEffect(() => setOlder((known) => known.filter((job) => job.id < oldest)), [oldest]);
  const ended = [...jobs, ...older.filter((job) => job.id < oldest)].filter(hasEnded);
  const shown = ended.filter((job) => fits(job, words));
  const more = jobs.length >= TOLD && older.length === 0;
  return (
    <section aria-labelledby="history-title">
      <div class="history-head">
        <h1 id="history-title">History</h1>
        {ended.length > 0 ? (
          <label class="field inline" for="find">Find
            <input id="find" type="search" value={words} placeholder="name, printer or number" onInput={(event) => setWords(event.currentTarget.value)} />
          </label>
        ) : null}
      </div>
      {ended.length === 0 ? (
        <Empty title="Nothing has ended yet">Prints that are done, failed or cancelled are listed here, to be looked at and printed again.</Empty>
      ) : null}
      {ended.length > 0 && shown.length === 0 ? <Empty title="No such job">Nothing that ended is called so.</Empty> : null}
      <ul class="history">{shown.map((job) => <Row key={job.id} job={job} />)}</ul>
      {more ? (
        <Button onClick={() => void listJobs(MOST).then((all) => setOlder(all.filter((job) => job.id < oldest)), complain)}>
          Show older jobs
        </Button>
      ) : null}
    </section>
  );
}

const fits = (job: Job, words: string): boolean =>
  words.toLowerCase().split(/\s+/).every((word) => `${job.name} ${job.printer} ${job.id}`.toLowerCase().includes(word));

function Row({ job }: { job: Job }) {
  const packed = job.estimates?.packed;
  const took = job.state === 'done' && job.sending_s && job.ended_s ? duration(job.ended_s - job.sending_s) : '';
  const cost = packed?.fits && packed.cost !== null ? money(packed.cost, packed.currency) : '';
  const ended = job.ended_s ? when(job.ended_s) : '';
  return (
    <li class="card row ended" data-job={job.id}>
      <div class="row-words">
        <div class="card-head">
          <h2><a href={jobHref(job.id)}>{job.name}</a></h2>
          <Badge badge={jobBadge(job)} />
        </div>
        <p class="quiet-text">{[`Job ${job.id} on ${job.printer}`, ended, took, cost].filter(Boolean).join(' · ')}</p>
        {job.state === 'failed' ? <p class="reason"><strong>{job.reason}</strong> {job.hint}</p> : null}
      </div>
      <JobButtons job={job} />
    </li>
  );
}
