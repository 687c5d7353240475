// Choosing a file and a printer, and the files that are on their way.
import { useRef, useState } from 'preact/hooks';
import { sendFiles } from './send_files';
import { dismiss } from '../daemon/upload';
import { formatsInWords } from '../daemon/upload_rules';
import type { Printer } from '../daemon/types';
import type { Known, Sending } from '../store';
import { Bar, Button } from '../ui/bits';
import { Icon } from '../ui/icons';
import { bytes } from '../words';

export function Uploads({ known }: { known: Known }) {
  const { printers, rules, sending } = known;
  return (
    <section class="send" aria-labelledby="send-title">
      <div class="send-words">
        <h2 id="send-title"><Icon name="upload" />Send a model</h2>
        <p class="quiet-text">
          Drop {formatsInWords(rules)} files anywhere on this page, or choose them here.
          {rules ? ` ${bytes(rules.most_bytes)} each at most.` : ''}
        </p>
      </div>
      <Chooser printers={printers} endings={rules?.endings ?? []} />
      {sending.length > 0 ? (
        <ul class="sending" aria-label="Files on their way">
          {sending.map((one) => <Row key={one.id} one={one} />)}
        </ul>
      ) : null}
    </section>
  );
}

function Chooser({ printers, endings }: { printers: Printer[]; endings: string[] }) {
  const input = useRef<HTMLInputElement>(null);
  const [chosen, setChosen] = useState('');
  const printer = printers.some((one) => one.name === chosen) ? chosen : printers[0]?.name ?? '';
  return (
    <div class="chooser">
      <label class="field inline" for="printer">Printer
        <select id="printer" value={printer} onChange={(event) => setChosen(event.currentTarget.value)}>
          {printers.map((one) => <option key={one.name} value={one.name}>{one.name}</option>)}
        </select>
      </label>
      <input ref={input} type="file" multiple hidden accept={endings.join(',')} aria-label="Files to send" tabIndex={-1}
             onChange={(event) => {
               sendFiles(event.currentTarget.files ?? [], printer);
               event.currentTarget.value = '';
             }} />
      <Button kind="primary" onClick={() => input.current?.click()}>Choose files…</Button>
    </div>
  );
}

function Row({ one }: { one: Sending }) {
  return (
    <li class={one.refusal ? 'refused' : ''}>
      <span class="name">{one.name}</span>
      <span class="quiet-text">to {one.printer}</span>
      {one.refusal ? (
        <p class="trouble" role="alert">{one.refusal.what}. {one.refusal.hint}</p>
      ) : (
        <Bar fraction={one.fraction} label={`${one.name} on its way`} />
      )}
      <button type="button" class="icon-button" onClick={() => (one.refusal ? dismiss(one.id) : one.stop())}
              aria-label={one.refusal ? `Close what is said about ${one.name}` : `Stop sending ${one.name}`}>
        <Icon name="close" />
      </button>
    </li>
  );
}
