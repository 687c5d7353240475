// What the ways of printing take, each against the cheapest that is not packed, as `packmerger compare` has it.
import type { Estimate, Estimates, Variant, Way } from '../daemon/types';
import { Button } from '../ui/bits';
import { difference, duration, grams, money } from '../words';

const WAYS: readonly { way: Way; title: string }[] = [
  { way: 'as_is', title: 'As it stands' }, { way: 'solid', title: 'Solid' },
  { way: 'hollow', title: 'Hollow' }, { way: 'packed', title: 'Packed' },
];

const SOURCES = { model: 'Estimates', slicer: 'Figures of the slicer', program: 'What the program says of itself',
                  moves: 'Counted from the program’s moves, without acceleration and heating' } as const;

interface Row {
  title: string;
  value: (one: Estimate) => number | null;
  text: (value: number, one: Estimate) => string;
  compared: boolean;
  isShare?: boolean; // of the row above
}

const paid = (value: number, one: Estimate): string => money(value, one.currency);

const ROWS: readonly Row[] = [
  { title: 'Printing time', value: (one) => one.time_s, text: duration, compared: true },
  { title: 'Model', value: (one) => one.model_g, text: grams, compared: true },
  { title: 'Support', value: (one) => one.support_g, text: grams, compared: true },
  { title: 'Cost', value: (one) => one.cost, text: paid, compared: true },
  { title: 'material', value: (one) => one.material_cost ?? null, text: paid, compared: false, isShare: true },
  { title: 'machine', value: (one) => one.machine_cost ?? null, text: paid, compared: false, isShare: true },
  { title: 'hands', value: (one) => one.hands_cost ?? null, text: paid, compared: false, isShare: true },
  { title: 'Parts', value: (one) => one.parts, text: String, compared: false },
  { title: 'Trays', value: (one) => one.trays, text: String, compared: false },
  { title: 'Work by hand', value: (one) => one.assembly_min, text: (value) => (value === 0 ? 'none' : duration(60 * value)), compared: false },
];

function Cell({ row, one, base, best, kind }:
              { row: Row; one: Estimate | undefined; base: Estimate | undefined; best: number; kind: string }) {
  const value = one?.fits ? row.value(one) : null;
  if (one === undefined || value === null) return <td class={kind}><span class="quiet-text">–</span></td>;
  const change = row.compared && base !== undefined && base !== one ? difference(value, row.value(base)) : '';
  const tone = change.startsWith('−') ? 'less' : change.startsWith('+') ? 'more' : 'same';
  return (
    <td class={row.compared && value === best ? `${kind} best` : kind}>
      <span class="value">{row.text(value, one)}</span>
      {change ? <span class={`change ${tone}`}>{change}</span> : null}
    </td>
  );
}

export interface Column {
  ways: Way[];
  title: string;
  one: Estimate;
}

const shown = (row: Row, one: Estimate): string => {
  const value = row.value(one);
  return value === null ? '' : row.text(value, one);
};

// Ways whose figures all read the same are one column.
export function columnsOf(estimates: Estimates): Column[] {
  const columns: Column[] = [];
  for (const { way, title } of WAYS) {
    const one = estimates[way];
    if (one === undefined) continue;
    const same = columns.find((column) => column.one.fits && one.fits && ROWS.every((row) => shown(row, column.one) === shown(row, one)));
    if (same === undefined) columns.push({ ways: [way], title, one });
    else {
      same.ways.push(way);
      same.title += `, ${title.toLowerCase()}`;
    }
  }
  return columns;
}

// Why ways cannot be made, each reason once.
export function reasonsOf(columns: readonly Column[]): { titles: string; text: string }[] {
  const reasons = new Map<string, string[]>();
  for (const { title, one } of columns) {
    if (!one.reason) continue;
    const text = `${one.reason}. ${one.hint ?? ''}`.trim();
    reasons.set(text, [...(reasons.get(text) ?? []), title]);
  }
  return [...reasons].map(([text, titles]) => ({ titles: titles.join(', '), text }));
}

// What of a column can be prepared: the way with the least work by hand.
const variantOf = ({ ways }: Column): Variant | undefined =>
  (['solid', 'hollow', 'packed'] as const).find((way) => ways.includes(way));

interface Props {
  estimates: Estimates;
  prepared: string;
  advice?: string;
  take?: ((variant: Variant) => void) | undefined;  // has another way prepared; left out where that cannot be
}

// What weighs something and stands below nothing is no support: powder that cannot be used again.
export const isInPowder = (estimates: Estimates): boolean => {
  const held = Object.values(estimates).filter((one) => (one.support_g ?? 0) > 0);
  return held.length > 0 && held.every((one) => one.support_mm3 === 0);
};

export function EstimateTable({ estimates, prepared, advice, take }: Props) {
  const columns = columnsOf(estimates);
  const isPrepared = ({ ways }: Column): boolean => ways.some((way) => way === prepared);
  const offered = (column: Column): Variant | undefined => (column.one.fits && !isPrepared(column) ? variantOf(column) : undefined);
  const fitting = (way: Way): Estimate | undefined => (estimates[way]?.fits ? estimates[way] : undefined);
  const base = (['as_is', 'solid', 'hollow'] as const).map(fitting)
    .reduce((best, one) => (one && (!best || (one.cost ?? 0) < (best.cost ?? 0)) ? one : best), undefined);
  const baseColumn = columns.find(({ ways }) => ways.some((way) => estimates[way] === base));
  const rows = ROWS.filter((row) => columns.some(({ one }) => one.fits && row.value(one) !== null));
  const titleOf = ({ title }: Row): string => (title === 'Support' && isInPowder(estimates) ? 'Lost powder' : title);
  const source = Object.values(estimates).find((one) => one.source !== null)?.source ?? 'model';
  return (
    <>
      {advice ? <p class="advice">{advice}</p> : null}
      <table class="estimates">
        <caption class="quiet-text">
          {SOURCES[source]}{baseColumn && columns.length > 1 ? `; differences are against “${baseColumn.title}”, the cheapest way that is not packed` : ''}.
        </caption>
        <thead>
          <tr>
            <th scope="col"><span class="unseen">Figure</span></th>
            {columns.map((column) => (
              <th key={column.title} scope="col" class={isPrepared(column) ? 'prepared' : ''}>
                {column.title}
                {isPrepared(column) ? <span class="tag">prepared</span> : null}
                {column.one.fits ? null : <span class="tag bad">{column.one.reason ? 'cannot be made' : 'does not fit'}</span>}
              </th>
            ))}
          </tr>
        </thead>
        <tbody>
          {rows.map((row) => {
            const values = columns.flatMap(({ one }) => (one.fits ? [row.value(one) ?? Infinity] : []));
            return (
              <tr key={row.title}>
                <th scope="row" class={row.isShare ? 'share' : ''}>{titleOf(row)}</th>
                {columns.map((column) => (
                  <Cell key={column.title} row={row} one={column.one} base={baseColumn?.one} best={values.length > 1 ? Math.min(...values) : NaN}
                        kind={isPrepared(column) ? 'prepared' : ''} />
                ))}
              </tr>
            );
          })}
        </tbody>
        {take && columns.some(offered) ? (
          <tfoot>
            <tr>
              <th scope="row"><span class="unseen">Another way</span></th>
              {columns.map((column) => {
                const variant = offered(column);
                return (
                  <td key={column.title} class={isPrepared(column) ? 'prepared' : ''}>
                    {variant ? <Button label={`Prepare it ${variant}`} onClick={() => take(variant)}>Prepare</Button> : null}
                  </td>
                );
              })}
            </tr>
          </tfoot>
        ) : null}
      </table>
      {reasonsOf(columns).map(({ titles, text }) => <p key={titles} class="quiet-text">{titles}: {text}</p>)}
    </>
  );
}
