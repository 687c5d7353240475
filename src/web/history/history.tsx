// Jobs that have ended, newest first.
import { useEffect, useState } from 'preact/hooks';
import { jobsBefore } from '../daemon/api';
import { hasEnded, ownEstimate, type Job } from '../daemon/types';
import { JobButtons } from '../job/actions';
import { jobHref } from '../route';
import { Badge, Button, Empty } from '../ui/bits';
import { complain } from '../ui/notes';
import { duration, jobBadge, money, sentence, when } from '../words';

const TOLD = 100;   // ended jobs that the stream tells
const MORE = 200;   // asked for at a time

export function HistoryView({ jobs }: { jobs: Job[] }) {
  const [seen, setSeen] = useState<Job[]>([]);
  const [words, setWords] = useState('');
  const [complete, setComplete] = useState(false);
  const known = merged(seen, jobs);
  useEffect(() => setSeen((before) => merged(before, jobs)), [jobs]);
  const ended = known.filter(hasEnded);
  const showOlder = async () => {
    const older = await jobsBefore(ended.at(-1)?.id ?? 1, MORE);
    setSeen((before) => merged(before, older));
    setComplete(older.length < MORE);
  };
  const shown = ended.filter((job) => fits(job, words));
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
      {!complete && ended.length >= TOLD ? (
        <Button onClick={() => void showOlder().catch(complain)}>Show older jobs</Button>
      ) : null}
    </section>
  );
}

// What was seen before stays when newer jobs push it out of the stream; what ended last first.
const merged = (seen: Job[], told: Job[]): Job[] =>
  [...new Map([...seen, ...told].map((job) => [job.id, job])).values()]
    .sort((a, b) => (b.ended_s ?? 0) - (a.ended_s ?? 0) || b.id - a.id);

const fits = (job: Job, words: string): boolean =>
  words.toLowerCase().split(/\s+/).every((word) => `${job.name} ${job.printer} ${job.id}`.toLowerCase().includes(word));

function Row({ job }: { job: Job }) {
  const own = ownEstimate(job);
  const took = job.state === 'done' && job.printed_s !== null ? duration(job.printed_s) : '';
  const cost = own?.fits && own.cost !== null ? money(own.cost, own.currency) : '';
  const ended = job.ended_s ? when(job.ended_s) : '';
  return (
    <li class={`card row ended ${jobBadge(job).tone}`} data-job={job.id}>
      <div class="row-words">
        <div class="card-head">
          <h2><a href={jobHref(job.id)}>{job.name}</a></h2>
          <Badge badge={jobBadge(job)} />
        </div>
        <p class="quiet-text">{[`Job ${job.id} on ${job.printer}`, ended, took, cost].filter(Boolean).join(' · ')}</p>
        {job.state === 'failed' ? <p class="reason"><strong>{sentence(job.reason)}</strong> {job.hint}</p> : null}
      </div>
      <JobButtons job={job} />
    </li>
  );
}
