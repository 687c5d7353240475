// What the daemon would refuse is told before a gigabyte was sent for nothing.
import { Refusal } from './api';
import { bytes } from '../words';
import type { UploadRules } from './types';

export function forbids(file: { name: string; size: number }, rules: UploadRules | null): Refusal | null {
  if (rules === null) return null;
  const name = file.name.toLowerCase();
  if (!rules.endings.some((ending) => name.endsWith(ending)))
    return new Refusal(415, 'This is no file that PackMerger takes', `It takes ${endingsInWords(rules)}.`);
  if (file.size > rules.most_bytes)
    return new Refusal(413, `The file has ${bytes(file.size)}, and ${bytes(rules.most_bytes)} are the most`,
                       'Raise web.most_upload_bytes in the settings, or make the model smaller.');
  if (file.size === 0) return new Refusal(422, 'The file is empty', 'Export it anew.');
  return null;
}

const SHORT_FORMS = ['.gco', '.g', '.s3g', '.gcode.3mf'];  // of what is named already
const NAMES: Record<string, string> = { '.gcode': 'G-code', '.x3g': 'x3g' };

export function endingsInWords(rules: UploadRules | null): string {
  const endings = (rules?.endings ?? ['.stl', '.obj', '.ply', '.off', '.3mf']).filter((one) => !SHORT_FORMS.includes(one));
  const names = endings.map((one) => NAMES[one] ?? one.slice(1).toUpperCase());
  return `${names.slice(0, -1).join(', ')} or ${names.at(-1)}`;
}
