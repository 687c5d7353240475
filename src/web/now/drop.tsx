// A file dragged over the page may be dropped on any of the printers.
import { useEffect, useState } from 'preact/hooks';
import { sendFiles } from './send_files';
import type { Printer } from '../daemon/types';
import { Icon } from '../ui/icons';

const carriesFiles = (event: DragEvent): boolean => [...(event.dataTransfer?.types ?? [])].includes('Files');

export function DropTargets({ printers }: { printers: Printer[] }) {
  const [over, setOver] = useState(false);
  useEffect(() => {
    const drag = (event: DragEvent): void => {
      if (!carriesFiles(event)) return;
      event.preventDefault();
      setOver(true);
    };
    const leave = (event: DragEvent): void => {
      if (event.relatedTarget === null) setOver(false);
    };
    const drop = (event: DragEvent): void => {
      if (carriesFiles(event)) event.preventDefault();  // a file beside a target must not replace the page
      setOver(false);
    };
    addEventListener('dragenter', drag);
    addEventListener('dragover', drag);
    addEventListener('dragleave', leave);
    addEventListener('drop', drop);
    return () => {
      removeEventListener('dragenter', drag);
      removeEventListener('dragover', drag);
      removeEventListener('dragleave', leave);
      removeEventListener('drop', drop);
    };
  }, []);
  if (!over || printers.length === 0) return null;
  return (
    <div class="drop-layer">
      <p>Drop it on the printer that is to make it</p>
      <div class="drop-targets">
        {printers.map((printer) => <Target key={printer.name} printer={printer} />)}
      </div>
    </div>
  );
}

function Target({ printer }: { printer: Printer }) {
  const [over, setOver] = useState(false);
  return (
    <div class={over ? 'drop-target over' : 'drop-target'} data-printer={printer.name}
         onDragEnter={() => setOver(true)} onDragLeave={() => setOver(false)}
         onDrop={(event) => {
           event.preventDefault();
           if (event.dataTransfer) sendFiles(event.dataTransfer.files, printer.name);
         }}>
      <Icon name="upload" />
      <strong>{printer.name}</strong>
      <small>{printer.profile}</small>
    </div>
  );
}
