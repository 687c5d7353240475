// One printer: how it stands, how hot it is, what it prints, and what it may be told.
import { answerPrinter, changePrinter, type PrinterVerb } from '../daemon/api';
import type { Heater, Job, Print, Printer } from '../daemon/types';
import { jobHref } from '../route';
import { act } from '../ui/act';
import { ask } from '../ui/ask';
import { Badge, Bar, Button } from '../ui/bits';
import { degrees, duration, heaterName, printerBadge, troublesOf } from '../words';

function tell(printer: Printer, verb: PrinterVerb, done: string): void {
  act((starts) => changePrinter(printer.name, verb, starts), done);
}

export function PrinterCard({ printer, job }: { printer: Printer; job: Job | undefined }) {
  const badge = printerBadge(printer);
  return (
    <li class={`card printer ${badge.tone}`} data-printer={printer.name}>
      <div class="card-head">
        <div>
          <h3>{printer.name}</h3>
          <p class="quiet-text">{printer.prefer === null ? printer.profile : 'chooses a printer'}{printer.simulated ? ', simulated' : ''}</p>
        </div>
        <Badge badge={badge} />
      </div>
      {printer.print ? <Printing print={printer.print} job={job} printer={printer} /> : <p class="standing">{standing(printer, job)}</p>}
      {troublesOf(printer).map((text, index) => <p key={index} class="standing">{text}</p>)}
      {printer.print && printer.print.heaters.length > 0 ? <Heaters heaters={printer.print.heaters} /> : null}
      {printer.print?.stage === 'waiting' ? <Question printer={printer} print={printer.print} /> : null}
      {printer.prefer === null ? <Controls printer={printer} /> : null}
    </li>
  );
}

function standing(printer: Printer, job: Job | undefined): string {
  if (job) return `${job.name} is being handed over.`;
  if (printer.prefer !== null)
    return `A model sent here is compared on every printer, and the ${printer.prefer === 'soonest' ? 'soonest ready' : 'cheapest'} is proposed.`;
  if (printer.paused) return 'Paused: no new print starts until it is resumed.';
  if (printer.connected === false) return `Nothing is connected at ${printer.port}. Connect it and switch it on.`;
  if (printer.bed === 'not clear') return 'Take the last print off, then say that the bed is clear.';
  if (printer.handoff_folder !== '') return `Finished trays are put into ${printer.handoff_folder}.`;
  return printer.approve === 'auto' ? 'Waits for a job.' : 'Waits for an approved job.';
}

function Printing({ print, job, printer }: { print: Print; job: Job | undefined; printer: Printer }) {
  const left = print.remaining_s !== null && print.done > 0 ? `${duration(print.remaining_s)} left` : '';
  const tray = job && job.trays > 1 ? `tray ${job.tray} of ${job.trays}` : '';
  const text = print.stage === 'waiting' ? '' : print.text;
  return (
    <div class="printing">
      <p>
        {job ? <a href={jobHref(job.id)}>{job.name}</a> : null}
        <span class="quiet-text figure">{[tray, left].filter(Boolean).join(', ')}</span>
      </p>
      <Bar fraction={print.fraction} label={`${printer.name}: how much is printed`}
           tone={printerBadge(printer).tone} />
      <p class="quiet-text figure">{[`${duration(print.elapsed_s)} so far`, text].filter(Boolean).join(' · ')}</p>
    </div>
  );
}

function Heaters({ heaters }: { heaters: Heater[] }) {
  return (
    <dl class="heaters">
      {heaters.map((heater) => (
        <div key={heater.name}>
          <dt>{heaterName(heater.name)}</dt>
          <dd><strong>{degrees(heater.actual_c)}</strong>
            <span class="quiet-text">{heater.target_c ? ` of ${Math.round(heater.target_c)}` : ' off'}</span></dd>
        </div>
      ))}
    </dl>
  );
}

// The printer stands still until somebody answers.
function Question({ printer, print }: { printer: Printer; print: Print }) {
  const choices = print.choices.length > 0 ? print.choices : ['Go on'];
  return (
    <div class="question" role="group" aria-label={`${printer.name} asks`}>
      <p>{print.text || 'The printer waits for you.'}</p>
      <div class="buttons">
        {choices.map((choice, index) => (
          <Button key={index} kind={index === 0 ? 'primary' : 'quiet'}
                  onClick={() => act(() => answerPrinter(printer.name, index), `${printer.name}: ${choice}`)}>{choice}</Button>
        ))}
      </div>
    </div>
  );
}

function Controls({ printer }: { printer: Printer }) {
  const { name } = printer;
  const prints = printer.print !== null && printer.handoff_folder === '';
  return (
    <div class="buttons">
      {printer.bed === 'not clear' && printer.job === null ? (
        <Button kind="primary" icon="bed" label={`The bed of ${name} is clear`}
                onClick={() => tell(printer, 'clear', `The bed of ${name} is clear`)}>Bed is clear</Button>
      ) : null}
      {printer.paused || printer.print?.stage === 'paused' ? (
        <Button icon="play" label={`Resume ${name}`} onClick={() => tell(printer, 'resume', `${name} goes on`)}>Resume</Button>
      ) : (
        <Button icon="pause" label={`Pause ${name}`} onClick={() => tell(printer, 'pause', `${name} pauses`)}>Pause</Button>
      )}
      {prints ? (
        <Button icon="stop" kind="danger" label={`Stop ${name} at once`} onClick={() => ask({
          title: `Stop ${name} at once?`,
          text: 'An emergency stop: the printer halts where it is, the print is lost, and somebody has to look at the machine. To end a print in good order, cancel its job.',
          yes: 'Stop at once', no: 'Let it print',
          act: () => tell(printer, 'stop', `${name} is stopped`),
        })}>Stop</Button>
      ) : null}
    </div>
  );
}
