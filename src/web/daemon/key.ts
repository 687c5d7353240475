// The key a person pasted: kept for this tab, or on this device when they ask for it.
const NAME = 'packmerger-key';

export const readKey = (): string => sessionStorage.getItem(NAME) ?? localStorage.getItem(NAME) ?? '';

// A key of a link from the daemon's own machine sees everything and changes nothing.
export const mayChange = (): boolean => readKey() !== '' && !readKey().startsWith('pm_look_');

export const isRemembered = (): boolean => localStorage.getItem(NAME) !== null;

export function keepKey(key: string, remember: boolean): void {
  forgetKey();
  (remember ? localStorage : sessionStorage).setItem(NAME, key);
}

export function forgetKey(): void {
  sessionStorage.removeItem(NAME);
  localStorage.removeItem(NAME);
}
