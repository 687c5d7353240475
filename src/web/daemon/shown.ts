// Texts from the daemon as they may be shown: names of files are chosen by others, and some characters turn the
// direction of what follows or are not seen at all.
const HIDDEN =
  /[\u0000-\u0008\u000b-\u001f\u007f-\u009f\u00ad\u061c\u115f\u1160\u180e\u200b-\u200f\u2028-\u202e\u2060-\u206f\u3164\ufeff\ufff0-\ufffb\u{e0000}-\u{e0fff}]/gu;

export const shown = (text: string): string => text.replace(HIDDEN, '\ufffd');

// JSON with every text in it as it may be shown.
export const parsed = <T>(json: string): T =>
  JSON.parse(json, (_, value: unknown) => (typeof value === 'string' ? shown(value) : value)) as T;
