// The key a person pasted: kept for this tab, or on this device when they ask for it.
const NAME = 'packmerger-key';

export const readKey = (): string => sessionStorage.getItem(NAME) ?? localStorage.getItem(NAME) ?? '';

export const isRemembered = (): boolean => localStorage.getItem(NAME) !== null;

export function keepKey(key: string, remember: boolean): void {
  forgetKey();
  (remember ? localStorage : sessionStorage).setItem(NAME, key);
}

export function forgetKey(): void {
  sessionStorage.removeItem(NAME);
  localStorage.removeItem(NAME);
}
