import { render } from 'preact';
import './styles/base.css';
import './styles/pieces.css';
import './styles/now.css';
import './styles/job.css';
import { uploadRules } from './daemon/api';
import { watch, watchWhileVisible } from './daemon/events';
import { lookByLink } from './daemon/look';
import { Shell } from './shell';
import { store } from './store';
import { restoreTheme } from './theme';
import { complain } from './ui/notes';

restoreTheme();
const page = document.getElementById('page');
if (page) render(<Shell />, page);
void lookByLink().catch(complain).finally(watchWhileVisible);
// a link pasted over the page that is open
addEventListener('hashchange', () => void lookByLink().then((looks) => looks && watch(), complain));

// Once the daemon answers: without the rules the daemon itself still refuses what it must.
const stop = store.listen(() => {
  if (store.get().link.kind !== 'live') return;
  stop();
  uploadRules().then((rules) => store.set({ rules }), () => undefined);
});
