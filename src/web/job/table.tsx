// What the ways of printing take, each against the cheapest that is not packed, as `packmerger compare` has it.
import type { Estimate, Estimates, Way } from '../daemon/types';
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
}

const ROWS: readonly Row[] = [
  { title: 'Printing time', value: (one) => one.time_s, text: duration, compared: true },
  { title: 'Model', value: (one) => one.model_g, text: grams, compared: true },
  { title: 'Support', value: (one) => one.support_g, text: grams, compared: true },
  { title: 'Cost', value: (one) => one.cost, text: (value, one) => money(value, one.currency), compared: true },
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

// The way that costs less than the prepared one and fits too; '' where there is none.
export function cheaperWay(estimates: Estimates | null, prepared: string): string {
  const cost = (way: Way): number => (estimates?.[way]?.fits ? estimates[way].cost ?? Infinity : Infinity);
  const own = WAYS.find(({ way }) => way === prepared);
  const best = WAYS.reduce((least, one) => (cost(one.way) < cost(least.way) ? one : least));
  return own && cost(best.way) < cost(own.way) ? best.title.toLowerCase() : '';
}

export function EstimateTable({ estimates, prepared }: { estimates: Estimates; prepared: string }) {
  const ways = WAYS.filter(({ way }) => estimates[way] !== undefined);
  const fitting = (way: Way): Estimate | undefined => (estimates[way]?.fits ? estimates[way] : undefined);
  const base = (['as_is', 'solid', 'hollow'] as const).map(fitting)
    .reduce((best, one) => (one && (!best || (one.cost ?? 0) < (best.cost ?? 0)) ? one : best), undefined);
  const baseTitle = WAYS.find(({ way }) => estimates[way] === base)?.title ?? '';
  const source = Object.values(estimates).find((one) => one.source !== null)?.source ?? 'model';
  return (
    <table class="estimates">
      <caption class="quiet-text">
        {SOURCES[source]}{baseTitle && ways.length > 1 ? `; differences are against “${baseTitle}”, the cheapest way that is not packed` : ''}.
      </caption>
      <thead>
        <tr>
          <th scope="col"><span class="unseen">Figure</span></th>
          {ways.map(({ way, title }) => (
            <th key={way} scope="col" class={way === prepared ? 'prepared' : ''}>
              {title}
              {way === prepared ? <span class="tag">prepared</span> : null}
              {estimates[way]?.fits === false ? <span class="tag bad">does not fit</span> : null}
            </th>
          ))}
        </tr>
      </thead>
      <tbody>
        {ROWS.map((row) => {
          const values = ways.map(({ way }) => fitting(way)).flatMap((one) => (one ? [row.value(one) ?? Infinity] : []));
          return (
            <tr key={row.title}>
              <th scope="row">{row.title}</th>
              {ways.map(({ way }) => (
                <Cell key={way} row={row} one={estimates[way]} base={base} best={values.length > 1 ? Math.min(...values) : NaN}
                      kind={way === prepared ? 'prepared' : ''} />
              ))}
            </tr>
          );
        })}
      </tbody>
    </table>
  );
}
