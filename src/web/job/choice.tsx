// How the printers were compared for a model that named none.
import type { Choice } from '../daemon/types';
import { duration, money } from '../words';

export function ChoiceTable({ choice }: { choice: Choice }) {
  const time = (seconds: number | null): string => (seconds === null ? '–' : duration(seconds));
  return (
    <section class="card" aria-labelledby="choice-title">
      <h2 id="choice-title">Why this printer</h2>
      <table class="estimates">
        <caption class="quiet-text">The {choice.prefer === 'soonest' ? 'one that is ready soonest' : 'cheapest'} is proposed.</caption>
        <thead>
          <tr>{['Printer', 'Printing time', 'Cost', 'Ready in'].map((title) => <th key={title} scope="col">{title}</th>)}</tr>
        </thead>
        <tbody>
          {choice.printers.map((one) => (
            <tr key={one.printer}>
              <th scope="row">{one.printer}{one.printer === choice.chosen ? <span class="tag">proposed</span> : null}
                {one.reason ? <span class="tag quiet">{one.reason}</span> : null}</th>
              <td>{one.fits ? time(one.time_s) : 'does not fit'}</td>
              <td>{one.fits && one.cost !== null ? money(one.cost, one.currency) : '–'}</td>
              <td>{one.fits ? time(one.ready_in_s) : '–'}</td>
            </tr>
          ))}
        </tbody>
      </table>
    </section>
  );
}
