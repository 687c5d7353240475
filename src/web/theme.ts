// Dark or light: as the system says until somebody chooses.
const NAME = 'packmerger-theme';

const systemIsDark = matchMedia('(prefers-color-scheme: dark)');

export function isDark(): boolean {
  const chosen = document.documentElement.dataset['theme'];
  return chosen === undefined ? systemIsDark.matches : chosen === 'dark';
}

export function restoreTheme(): void {
  const chosen = localStorage.getItem(NAME);
  if (chosen === 'dark' || chosen === 'light') document.documentElement.dataset['theme'] = chosen;
}

export function switchTheme(): void {
  const chosen = isDark() ? 'light' : 'dark';
  document.documentElement.dataset['theme'] = chosen;
  localStorage.setItem(NAME, chosen);
  dispatchEvent(new Event('theme'));
}

// Calls back whenever the colours change, whoever changed them.
export function onTheme(changed: () => void): () => void {
  addEventListener('theme', changed);
  systemIsDark.addEventListener('change', changed);
  return () => {
    removeEventListener('theme', changed);
    systemIsDark.removeEventListener('change', changed);
  };
}
