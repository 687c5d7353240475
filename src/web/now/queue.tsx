// A job that has not ended, as a row of the queue.
import { ownEstimate, type Job } from '../daemon/types';
import { JobButtons } from '../job/actions';
import { Preview } from '../job/preview';
import { jobHref } from '../route';
import { Badge, Bar } from '../ui/bits';
import { duration, jobBadge, money, nextStep, progressText, sentence, troubleInWords } from '../words';

export function QueueRow({ job }: { job: Job }) {
  const next = nextStep(job);
  return (
    <li class={`card row ${jobBadge(job).tone}`} data-job={job.id}>
      <a class="thumb" href={jobHref(job.id)} tabIndex={-1} aria-hidden="true"><Preview job={job} /></a>
      <div class="row-words">
        <div class="card-head">
          <h3><a href={jobHref(job.id)}>{job.name}</a></h3>
          <Badge badge={jobBadge(job)} />
        </div>
        <p class="quiet-text">Job {job.id} on {job.printer}{figures(job)}</p>
        {job.progress
          ? <><Bar fraction={job.progress.fraction} label={`Job ${job.id}: ${job.progress.stage}`} tone={jobBadge(job).tone} />
              <p class="quiet-text figure">{progressText(job)}</p></>
          : <p>{[job.trouble ? troubleInWords(job.trouble) : sentence(job.reason), next || (job.trouble ? '' : sentence(job.status))]
              .filter(Boolean).join(' ')}</p>}
        <JobButtons job={job} />
      </div>
    </li>
  );
}

// What printing it takes.
function figures(job: Job): string {
  const own = ownEstimate(job);
  const time_s = job.predicted_s ?? own?.time_s ?? null;
  if (!own?.fits || time_s === null) return '';
  return ` · ${duration(time_s)}${own.cost === null ? '' : ` · ${money(own.cost, own.currency)}`}`;
}
