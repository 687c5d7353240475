// Asks once before what cannot be taken back, or before something moves.
import { Button } from './bits';
import { Dialog } from './dialog';
import { Store } from '../store';
import { useEffect, useState } from 'preact/hooks';

interface Question {
  title: string;
  text: string;
  yes: string;
  no: string;
  calm?: boolean;  // nothing is lost by it
  act: () => void;
}

const asked = new Store<{ question: Question | null }>({ question: null });

export const ask = (question: Question): void => asked.set({ question });

export function AskDialog() {
  const [{ question }, setAsked] = useState(asked.get());
  useEffect(() => asked.listen(() => setAsked(asked.get())), []);
  if (question === null) return null;
  const close = (): void => asked.set({ question: null });
  return (
    <Dialog title={question.title} closed={close}>
      <p>{question.text}</p>
      <div class="buttons end">
        <Button onClick={close}>{question.no}</Button>
        <Button kind={question.calm ? 'primary' : 'danger'} onClick={() => {
          close();
          question.act();
        }}>{question.yes}</Button>
      </div>
    </Dialog>
  );
}
