// The picture of a prepared job. Fetched by the page, because an image alone could not send the key.
import { useEffect, useState } from 'preact/hooks';
import { jobFile } from '../daemon/api';
import type { Job } from '../daemon/types';
import { Icon } from '../ui/icons';

const MOST_KEPT = 60;
const kept = new Map<string, Promise<string>>();

function pictureOf(job: Job): Promise<string> {
  const known = kept.get(job.folder);
  if (known) return known;
  const picture = jobFile(job.id, 'preview.png').then((reply) => reply.blob()).then((blob) => URL.createObjectURL(blob));
  kept.set(job.folder, picture);
  picture.catch(() => kept.delete(job.folder));
  for (const [folder, old] of kept) {
    if (kept.size <= MOST_KEPT) break;
    kept.delete(folder);
    void old.then((url) => URL.revokeObjectURL(url), () => undefined);
  }
  return picture;
}

export function Preview({ job }: { job: Job }) {
  const [url, setUrl] = useState('');
  useEffect(() => {
    let gone = false;
    setUrl('');
    if (job.folder !== '' && job.kind !== 'program') pictureOf(job).then((picture) => !gone && setUrl(picture), () => undefined);
    return () => {
      gone = true;
    };
  }, [job.folder]);
  if (url === '') return <span class="no-picture"><Icon name="cube" /></span>;
  return <img class="picture" src={url} alt={`${job.name}: the model, and what lies on the tray`} />;
}
