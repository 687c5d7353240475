// The frame around every view: header, what is wrong with the connection, dialogues, messages.
import { useEffect, useRef, useState } from 'preact/hooks';
import { mayChange } from './daemon/key';
import { hasEnded, type Storage, type Trouble } from './daemon/types';
import { HistoryView } from './history/history';
import { JobPage } from './job/job_page';
import { askForKey, HowToGetAKey, KeyDialog, KeyForm } from './key_dialog';
import { DropTargets } from './now/drop';
import { NowView } from './now/now';
import { useRoute, type Route } from './route';
import { useKnown, type Known, type Link } from './store';
import { isDark, onTheme, switchTheme } from './theme';
import { AskDialog } from './ui/ask';
import { Icon, Mark } from './ui/icons';
import { Notes } from './ui/notes';
import { jobBadge, storageInWords, troubleInWords } from './words';

const LINK_WORDS: Record<Link['kind'], string> = {
  connecting: 'Connecting', live: 'Live', lost: 'No connection', key: 'Key needed',
};

function ThemeButton() {
  const [dark, setDark] = useState(isDark());
  useEffect(() => onTheme(() => setDark(isDark())), []);
  return (
    <button type="button" class="icon-button" aria-label={dark ? 'Switch to light colours' : 'Switch to dark colours'}
            onClick={switchTheme}>
      <Icon name={dark ? 'sun' : 'moon'} />
    </button>
  );
}

function Header({ route, link }: { route: Route; link: Link }) {
  const tab = (href: string, text: string, here: boolean) => (
    <a href={href} aria-current={here ? 'page' : undefined}>{text}</a>
  );
  return (
    <header class="top">
      <div class="top-inner">
        <a class="brand" href="#/" aria-label="PackMerger, to the printers"><Mark /><span>PackMerger</span></a>
        <nav aria-label="Main">
          {tab('#/', 'Now', route.view === 'now')}
          {tab('#/history', 'History', route.view === 'history')}
        </nav>
        <div class="top-end">
          <span class={`link-state ${link.kind}`} role="status"><i aria-hidden="true" /><span>{LINK_WORDS[link.kind]}</span></span>
          <button type="button" class="icon-button" aria-label="Your key"
                  onClick={() => askForKey(mayChange() ? 'This page has a key. Another one replaces it.'
                                                    : 'With a key you can upload models and approve, pause and cancel prints from here.')}>
            <Icon name="key" />
          </button>
          <ThemeButton />
        </div>
      </div>
    </header>
  );
}

function Lost({ link }: { link: Link }) {
  if (link.kind !== 'lost') return null;
  return (
    <div class="banner" role="alert">
      <Icon name="warning" />
      <div><strong>{link.refusal.what}.</strong> {link.refusal.hint} What you see is how it last stood; the page goes on trying.</div>
    </div>
  );
}

// What will be lacking, or gone, unless somebody does something.
function Disk({ storage }: { storage: Storage | null }) {
  const text = storage === null ? '' : storageInWords(storage);
  if (text === '') return null;
  return <div class="banner"><Icon name="warning" /><div>{text}</div></div>;
}

// Whom the daemon cannot tell, and what else it tries in vain.
function Failing({ troubles }: { troubles: Trouble[] }) {
  if (troubles.length === 0) return null;
  return (
    <div class="banner">
      <Icon name="warning" />
      <div>{troubles.map((trouble) => <p key={trouble.about}>{troubleInWords(trouble)}</p>)}</div>
    </div>
  );
}

function KeyPage({ link }: { link: Extract<Link, { kind: 'key' }> }) {
  return (
    <section class="card key-page">
      <h1>{link.refusal.what}</h1>
      <p>The daemon shows and does things only for those who have a key. To look from its own machine a link is
        enough: <code>packmerger keys link</code> prints one.</p>
      <HowToGetAKey />
      <KeyForm given={() => undefined} />
    </section>
  );
}

function View({ route, known }: { route: Route; known: Known }) {
  if (known.link.kind === 'key') return <KeyPage link={known.link} />;
  if (known.jobs === null)
    return known.link.kind === 'connecting' ? <p class="loading" role="status">Asking the daemon…</p> : null;
  if (route.view === 'job') return <JobPage key={route.id} id={route.id} known={known} />;
  if (route.view === 'history') return <HistoryView jobs={known.jobs} />;
  return <NowView known={known} />;
}

function titleOf(known: Known, route: Route): string {
  const shown = route.view === 'job' ? known.jobs?.find((job) => job.id === route.id)?.name : undefined;
  const title = shown ? `${shown} – PackMerger` : 'PackMerger';
  const calls = (known.jobs ?? []).filter((job) => !hasEnded(job) && jobBadge(job).tone === 'attention').length;
  return calls > 0 ? `(${calls}) ${title}` : title;
}

export function Shell() {
  const known = useKnown();
  const route = useRoute();
  useEffect(() => {
    document.title = titleOf(known, route);
  }, [known, route]);
  const first = useRef(true);
  useEffect(() => {
    if (!first.current) document.getElementById('main')?.focus({ preventScroll: true });
    first.current = false;
  }, [route]);
  return (
    <>
      <a class="skip" href="#main" onClick={(event) => {
        event.preventDefault();
        document.getElementById('main')?.focus();
      }}>To the content</a>
      <Header route={route} link={known.link} />
      <main id="main" tabIndex={-1}>
        <Lost link={known.link} />
        <Disk storage={known.link.kind === 'key' ? null : known.storage} />
        <Failing troubles={known.link.kind === 'key' ? [] : known.troubles} />
        <View route={route} known={known} />
      </main>
      <DropTargets printers={known.printers} />
      {known.asksForKey !== null ? <KeyDialog why={known.asksForKey} /> : null}
      <AskDialog />
      <Notes />
    </>
  );
}
