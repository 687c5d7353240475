// One job: how it stands, what it looks like, what it takes, what happened.
import { useEffect, useState } from 'preact/hooks';
import { JobButtons } from './actions';
import { ChoiceTable } from './choice';
import { Files } from './files';
import { EstimateTable } from './table';
import { Timeline } from './timeline';
import { Views } from './views';
import { jobReport, prepareJob, Refusal, showJob } from '../daemon/api';
import { hasEnded, isPacked, type Estimates, type Job, type Report, type Variant } from '../daemon/types';
import { jobHref } from '../route';
import type { Known } from '../store';
import { act } from '../ui/act';
import { Badge, Bar, Empty } from '../ui/bits';
import { Icon } from '../ui/icons';
import { complain } from '../ui/notes';
import { duration, jobBadge, nextStep, progressText, sentence, troubleInWords, when } from '../words';

// The job as the stream tells it, with the history and the advice that only a question brings.
function useJob(id: number, known: Known): Job | Refusal | null {
  const live = known.jobs?.find((job) => job.id === id);
  const [asked, setAsked] = useState<Job | Refusal | null>(null);
  useEffect(() => {
    showJob(id).then(setAsked, (error: unknown) => (error instanceof Refusal ? setAsked(error) : complain(error)));
  }, [id, live?.state, live?.held, live?.tray, live?.reason]);
  if (live === undefined) return asked;
  if (asked === null || asked instanceof Refusal) return live;
  const { history, advice } = asked;
  return { ...live, ...(history ? { history } : {}), ...(advice ? { advice } : {}) };
}

// null: none yet; a job that holds only a program has none at all.
function useReport(job: Job | null): Report | null {
  const [report, setReport] = useState<Report | null>(null);
  const folder = job?.folder ?? '';
  useEffect(() => {
    setReport(null);
    if (job && folder !== '') jobReport(job.id).then(setReport, () => undefined);
  }, [folder]);
  return report;
}

export function JobPage({ id, known }: { id: number; known: Known }) {
  const found = useJob(id, known);
  const job = found instanceof Refusal ? null : found;
  const report = useReport(job);
  if (found instanceof Refusal)
    return <Empty title={found.what}>{found.hint} <a href="#/">Back to the queue</a></Empty>;
  if (job === null) return <p class="loading" role="status">Asking for job {id}…</p>;
  return (
    <article class="job">
      <a class="back" href="#/"><Icon name="back" />Printers and queue</a>
      <Head job={job} report={report} />
      {report && report.warnings.length > 0 ? <Warnings report={report} /> : null}
      {report && isPacked(report) ? <Views job={job} report={report} /> : null}
      {job.estimates ? (
        <section class="card" aria-labelledby="table-title">
          <h2 id="table-title">What it takes</h2>
          <EstimateTable estimates={job.kind === 'program' ? own(job.estimates) : job.estimates} prepared={job.variant}
                         advice={job.advice?.text ?? ''} take={canBeTaken(job) ? (variant) => takeWay(job, variant) : undefined} />
        </section>
      ) : null}
      {job.choice ? <ChoiceTable choice={job.choice} /> : null}
      {job.folder !== '' ? <Files job={job} dialect={report?.printer.dialect ?? ''} /> : null}
      <Timeline job={job} />
    </article>
  );
}

const canBeTaken = (job: Job): boolean =>
  job.kind === 'model' && (job.state === 'ready' || (job.state === 'approved' && job.tray === 1) || hasEnded(job));

function takeWay(job: Job, variant: Variant): void {
  act(() => prepareJob(job.id, variant), (anew) => `${anew.name} is prepared ${variant}, as job ${anew.id}`);
}

// Of a program there is only what it says of itself.
const own = ({ as_is }: Estimates): Estimates => (as_is ? { as_is } : {});

function Head({ job, report }: { job: Job; report: Report | null }) {
  const size = report?.inputs[0]?.size_mm?.map((mm) => Math.round(mm)).join(' × ');
  const next = nextStep(job);
  return (
    <section class={`card job-head ${jobBadge(job).tone}`} aria-labelledby="job-title">
      <div class="card-head">
        <h1 id="job-title">{job.name}</h1>
        <Badge badge={jobBadge(job)} />
      </div>
      <p class="quiet-text">
        Job {job.id} on {job.printer}{size ? ` · ${size} mm` : ''}{job.received_s ? ` · came ${when(job.received_s)}` : ''}
        {job.kind === 'program' ? ' · a program, printed as it is' : ''}
        {job.chosen_by ? ` · proposed by ${job.chosen_by}` : ''}
        {job.same_as && !job.again_of ? <> · the same file as <a href={jobHref(job.same_as)}>job {job.same_as}</a></> : null}
        {job.again_of ? <> · again of <a href={jobHref(job.again_of)}>job {job.again_of}</a></> : null}
      </p>
      {job.progress ? <Progress job={job} /> : null}
      {job.trouble || job.reason
        ? <p class="reason"><strong>{job.trouble ? troubleInWords(job.trouble) : sentence(job.reason)}</strong> {job.hint}</p> : null}
      {next ? <p>{next}</p> : null}
      {job.deleted_s ? <p class="quiet-text">Its files were deleted {when(job.deleted_s)}{job.filed ? <>; the model lies at <code>{job.filed}</code></> : null}.</p> : null}
      {job.state === 'handed_over' ? <p>Open it in the printer’s own software.</p> : null}
      {job.printed_s ? <p class="quiet-text">It took {duration(job.printed_s)} to print{job.predicted_s ? `, ${duration(job.predicted_s)} were predicted` : ''}.</p> : null}
      <JobButtons job={job} />
    </section>
  );
}

function Progress({ job }: { job: Job }) {
  if (job.progress === null) return null;
  return (
    <div class="printing">
      <Bar fraction={job.progress.fraction} label={`How far: ${job.progress.stage}`} tone={jobBadge(job).tone} />
      <p class="quiet-text figure">{progressText(job)}</p>
    </div>
  );
}

function Warnings({ report }: { report: Report }) {
  return (
    <section class="card warnings" aria-labelledby="warnings-title">
      <h2 id="warnings-title"><Icon name="warning" />What you should know</h2>
      <ul>{report.warnings.map((warning, index) => <li key={index}>{warning.text}</li>)}</ul>
    </section>
  );
}
