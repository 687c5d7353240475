import { render } from 'preact';
import './styles/base.css';
import './styles/pieces.css';
import './styles/now.css';
import './styles/job.css';
import { uploadRules } from './daemon/api';
import { watchWhileVisible } from './daemon/events';
import { Shell } from './shell';
import { store } from './store';
import { restoreTheme } from './theme';

restoreTheme();
const page = document.getElementById('page');
if (page) render(<Shell />, page);
watchWhileVisible();

// Once the daemon answers: without the rules the daemon itself still refuses what it must.
const stop = store.listen(() => {
  if (store.get().link.kind !== 'live') return;
  stop();
  uploadRules().then((rules) => store.set({ rules }), () => undefined);
});
