// The job folder's files, to be kept. The page fetches them: a plain link could not send the key.
import { changeJob, jobFile } from '../daemon/api';
import { hasEnded, type Job } from '../daemon/types';
import { act } from '../ui/act';
import { ask } from '../ui/ask';
import { Button } from '../ui/bits';
import { complain } from '../ui/notes';

async function save(job: Job, file: string): Promise<void> {
  try {
    const url = URL.createObjectURL(await (await jobFile(job.id, file)).blob());
    const link = document.createElement('a');
    link.href = url;
    link.download = `job-${job.id}-${file}`;
    link.click();
    setTimeout(() => URL.revokeObjectURL(url), 60_000);
  } catch (error) {
    complain(error);
  }
}

// Of jobs that earlier versions prepared: those do not tell what their printer is given.
const PROGRAMS: Record<string, string> = { gcode: 'gcode', s3g: 'x3g' };

// Null where the printer is given a document.
function programOf(job: Job, dialect: string, tray: number): string | null {
  const given = job.tray_files?.[tray - 1]?.file;
  if (given) return given.startsWith('program') ? given : null;
  const ending = PROGRAMS[dialect];
  return ending ? `program${tray === 1 ? '' : `-${tray}`}.${ending}` : null;
}

export function filesOf(job: Job, dialect: string): { file: string; title: string }[] {
  const files: { file: string; title: string }[] = [];
  for (let tray = 1; tray <= job.trays; tray += 1) {
    const number = tray === 1 ? '' : `-${tray}`;
    const which = job.trays > 1 ? ` ${tray}` : '';
    if (job.kind !== 'program')
      files.push({ file: `tray${number}.3mf`, title: `Tray${which}, 3MF` }, { file: `tray${number}.stl`, title: `Tray${which}, STL` });
    const program = programOf(job, dialect, tray);
    if (program) files.push({ file: program, title: `Program${which}, ${program.split('.').pop()}` });
  }
  if (job.kind !== 'program') files.push({ file: 'preview.png', title: 'Picture' });
  return [...files, { file: 'job.json', title: 'Report, JSON' }];
}

function askToDelete(job: Job): void {
  ask({
    title: `Delete the files of job ${job.id}?`,
    text: `Trays, programs and pictures of ${job.name} go. What is known of the job stays, and so does the model; printed again, it is prepared anew.`,
    yes: 'Delete the files', no: 'Keep them',
    act: () => act((starts) => changeJob(job.id, 'delete', starts), `The files of job ${job.id} are being deleted`),
  });
}

// The bytes that the printer is given, or was.
function Hashes({ job }: { job: Job }) {
  if (!job.tray_files) return <p class="hashes">SHA-256 of what is sent: not known</p>;
  return <>{job.tray_files.map(({ file, sha256 }) => <p key={file} class="hashes">{file}: SHA-256 {sha256}</p>)}</>;
}

export function Files({ job, dialect }: { job: Job; dialect: string }) {
  return (
    <section class="card" aria-labelledby="files-title">
      <h2 id="files-title">Files</h2>
      <div class="buttons">
        {filesOf(job, dialect).map(({ file, title }) => (
          <Button key={file} icon="download" onClick={() => void save(job, file)}>{title}</Button>
        ))}
        {hasEnded(job) ? (
          <Button kind="danger" icon="close" label={`Delete the files of job ${job.id}`} onClick={() => askToDelete(job)}>Delete them</Button>
        ) : null}
      </div>
      <Hashes job={job} />
    </section>
  );
}
