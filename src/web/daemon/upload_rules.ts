// What the daemon would refuse is told before a gigabyte was sent for nothing.
import { Refusal } from './api';
import { bytes } from '../words';
import type { UploadRules } from './types';

export function forbids(file: { name: string; size: number }, rules: UploadRules | null): Refusal | null {
  if (rules === null) return null;
  const name = file.name.toLowerCase();
  if (!rules.endings.some((ending) => name.endsWith(ending)))
    return new Refusal(415, 'This is no file that PackMerger takes', `It takes ${formatsInWords(rules)}.`);
  if (file.size > rules.most_bytes)
    return new Refusal(413, `The file has ${bytes(file.size)}, and ${bytes(rules.most_bytes)} are the most`,
                       'Raise web.most_upload_bytes in the settings, or make the model smaller.');
  if (file.size === 0) return new Refusal(422, 'The file is empty', 'Export it anew.');
  return null;
}

export function formatsInWords(rules: UploadRules | null): string {
  const formats = rules?.formats ?? ['STL', 'OBJ', 'PLY', 'OFF', '3MF'];  // before the daemon told
  return `${formats.slice(0, -1).join(', ')} or ${formats.at(-1)}`;
}
