// The parts as a list: chosen here or in the scenes, and what is known of the chosen one.
import { ordinal, trayCount, wayOut } from './looks';
import type { PackedReport } from '../daemon/types';

interface Props {
  report: PackedReport;
  colours: Map<number, string>;
  chosen: number | null;
  choose: (id: number | null) => void;
}

export function Parts({ report, colours, chosen, choose }: Props) {
  return (
    <div class="parts">
      <h3 id="parts-title">Parts</h3>
      <ul aria-labelledby="parts-title">
        {report.parts.map(({ id }) => (
          <li key={id}>
            <button type="button" class="part" aria-pressed={id === chosen} aria-label={`Part ${id}`}
                    onClick={() => choose(id === chosen ? null : id)}>
              <i class="swatch" style={{ background: colours.get(id) ?? 'currentColor' }} aria-hidden="true" />{id}
            </button>
          </li>
        ))}
      </ul>
      <p class="quiet-text" role="status">{about(report, chosen)}</p>
    </div>
  );
}

function about(report: PackedReport, id: number | null): string {
  const part = report.parts.find((one) => one.id === id);
  if (part === undefined) return 'Choose a part here or in a picture to see where it belongs. Escape lets go of it.';
  const place = report.removal_order.indexOf(part.id) + 1;
  const glued = part.neighbours.map((one) => one.id);
  return [
    `Part ${part.id}: ${(part.volume_mm3 / 1000).toLocaleString('en', { maximumFractionDigits: 1 })} cm³`,
    trayCount(report) > 1 ? `on tray ${part.tray}` : '',
    `taken out ${ordinal(place)}, ${wayOut(report, part.id)}`,
    glued.length > 0 ? `glued to ${glued.length === 1 ? 'part' : 'parts'} ${glued.join(', ')}` : 'not glued to any other',
  ].filter(Boolean).join('; ') + '.';
}
