// What happened to a job, step by step.
import type { Job } from '../daemon/types';
import { jobBadge, when } from '../words';

export function Timeline({ job }: { job: Job }) {
  const events = job.history ?? [];
  if (events.length === 0) return null;
  return (
    <section class="card" aria-labelledby="timeline-title">
      <h2 id="timeline-title">What happened</h2>
      <ol class="timeline">
        {events.map((event, index) => {
          const badge = jobBadge({ ...job, state: event.state, held: false, waits_for: null, progress: null });
          return (
            <li key={index} class={badge.tone}>
              <time dateTime={new Date(1000 * event.at_s).toISOString()}>{when(event.at_s)}</time>
              <Step badge={badge.text} note={event.note} />
            </li>
          );
        })}
      </ol>
    </section>
  );
}

// A note that begins with what the badge says stands alone.
function Step({ badge, note }: { badge: string; note: string }) {
  if (note.toLowerCase().startsWith(badge.toLowerCase())) return <span>{badge}{note.slice(badge.length)}</span>;
  return <span>{badge}{note ? <span class="quiet-text">: {note}</span> : null}</span>;
}
