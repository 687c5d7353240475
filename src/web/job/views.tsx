// The model and the packed tray side by side. three.js is loaded here, and only here.
import { useEffect, useRef, useState } from 'preact/hooks';
import { modelLooks, stepInWords, trayCount, trayLooks } from './looks';
import { Parts } from './parts';
import { Preview } from './preview';
import { jobFile, Refusal } from '../daemon/api';
import type { Job, PackedReport } from '../daemon/types';
import type { JobScenes } from '../scene/parts';
import type { Scene } from '../scene/scene';
import { onTheme } from '../theme';

interface Scenes {
  model: Scene;
  tray: Scene;
}

type Standing = 'loading' | 'drawn' | 'flat';

async function bytesOf(job: Job, file: string): Promise<ArrayBuffer> {
  return (await jobFile(job.id, file)).arrayBuffer();
}

// Jobs that an earlier version prepared have no small scene.
async function scenesOf(job: Job): Promise<JobScenes> {
  const parts = import('../scene/parts');
  try {
    return await (await parts).readScenes(await bytesOf(job, 'page.glb'));
  } catch (error) {
    if (!(error instanceof Refusal) || error.status !== 404) throw error;
  }
  const { readParts } = await parts;
  const [models, trays] = await Promise.all([bytesOf(job, 'assembly.glb').then(readParts), bytesOf(job, 'preview.glb').then(readParts)]);
  return { models, trays };
}

export function Views({ job, report }: { job: Job; report: PackedReport }) {
  const modelCanvas = useRef<HTMLCanvasElement>(null);
  const trayCanvas = useRef<HTMLCanvasElement>(null);
  const scenes = useRef<Scenes | null>(null);
  const [standing, setStanding] = useState<Standing>('loading');
  const [why, setWhy] = useState('');
  const [colours, setColours] = useState(new Map<number, string>());
  const [taken, setTaken] = useState(0);
  const [chosen, setChosen] = useState<number | null>(null);

  useEffect(() => {
    let gone = false;
    const open = async (): Promise<void> => {
      const [{ Scene }, { models: modelParts, trays: trayParts }] = await Promise.all([import('../scene/scene'), scenesOf(job)]);
      if (gone || !modelCanvas.current || !trayCanvas.current) return;
      setColours(new Map(trayParts.map((part) => [part.id, part.colour])));
      const model = new Scene(modelCanvas.current, modelParts, setChosen);
      scenes.current = { model, tray: new Scene(trayCanvas.current, trayParts, setChosen, report) };
      setStanding('drawn');
    };
    open().catch((error: unknown) => {
      if (gone) return;
      setStanding('flat');
      setWhy(error instanceof Refusal ? error.what : 'This browser draws no 3D (WebGL is off or missing)');
    });
    const recolour = onTheme(() => {
      scenes.current?.model.recolour();
      scenes.current?.tray.recolour();
    });
    return () => {
      gone = true;
      recolour();
      scenes.current?.model.close();
      scenes.current?.tray.close();
      scenes.current = null;
    };
  }, [job.id]);

  useEffect(() => {
    scenes.current?.model.show(modelLooks(report.removal_order, taken, chosen));
    scenes.current?.tray.show(trayLooks(report.removal_order, taken, chosen));
  }, [standing, taken, chosen]);

  const letGo = (event: KeyboardEvent): void => {
    if (event.key === 'Escape') setChosen(null);
  };
  const alone = report.parts.length === 1;
  const trayTitle = `${report.variant === 'packed' && !alone ? 'Packed tray' : 'Tray'}${trayCount(report) > 1 ? 's' : ''}`;
  const keys = 'Arrow keys turn it, plus and minus zoom, Home goes back.';
  return (
    <section class="card views" aria-labelledby="views-title" onKeyDown={letGo}>
      <h2 id="views-title">Model and tray</h2>
      {standing === 'flat' ? (
        <figure class="flat"><Preview job={job} /><figcaption class="quiet-text">{why}; this is the picture of the job instead.</figcaption></figure>
      ) : (
        <div class={`scenes ${standing}`} aria-busy={standing === 'loading'}>
          <figure>
            <canvas ref={modelCanvas} tabIndex={0} role="img" aria-label={`The ${alone ? '' : 'assembled '}model. ${keys}`} />
            <figcaption>{alone ? 'Model' : 'Assembled model'}</figcaption>
          </figure>
          <figure>
            <canvas ref={trayCanvas} tabIndex={0} role="img" aria-label={`${trayTitle}. ${keys}`} />
            <figcaption>{trayTitle}</figcaption>
          </figure>
        </div>
      )}
      {alone ? <p class="quiet-text in-one-piece">It is printed in one piece: nothing has to be glued.</p> : (
        <>
          <div class="unpack">
            <label for="taken">Taking the parts out</label>
            <input id="taken" type="range" min={0} max={report.removal_order.length} step={1} value={taken}
                   aria-valuetext={stepInWords(report, taken)} onInput={(event) => setTaken(Number(event.currentTarget.value))} />
            <output for="taken">{stepInWords(report, taken)}</output>
          </div>
          <Parts report={report} colours={colours} chosen={chosen} choose={setChosen} />
        </>
      )}
    </section>
  );
}
