// How each part is drawn in the two scenes, from what is chosen and how far the tray is emptied.
import type { PackedReport, Vec3 } from '../daemon/types';

// gone: taken off the tray; ghost: hardly visible; dim: visible, but not what is meant.
export type Look = 'solid' | 'chosen' | 'dim' | 'ghost' | 'gone';
export type Looks = Map<number, Look>;

// The first `taken` parts of the removal order are off the tray; those are what the model shows.
export function trayLooks(order: readonly number[], taken: number, chosen: number | null): Looks {
  const away = new Set(order.slice(0, taken));
  const meant = chosen !== null && !away.has(chosen) ? chosen : null;
  return new Map(order.map((id) => {
    if (away.has(id)) return [id, 'gone'];
    if (meant === null) return [id, 'solid'];
    return [id, id === meant ? 'chosen' : 'dim'];
  }));
}

export function modelLooks(order: readonly number[], taken: number, chosen: number | null): Looks {
  const away = new Set(order.slice(0, taken));
  return new Map(order.map((id) => {
    if (id === chosen) return [id, 'chosen'];
    if (taken > 0) return [id, !away.has(id) ? 'ghost' : chosen === null ? 'solid' : 'dim'];
    return [id, chosen === null ? 'solid' : 'ghost'];
  }));
}

const LEAST_MM = 0.5;  // of a move worth a word
const AXES = [['to the right', 'to the left'], ['to the back', 'to the front'], ['up', 'down']] as const;

function moveInWords(step: Vec3): string {
  const words = step.flatMap((mm, axis) =>
    Math.abs(mm) < LEAST_MM ? [] : [`${Math.round(Math.abs(mm)) || 1} mm ${AXES[axis]?.[mm > 0 ? 0 : 1]}`]);
  return words.join(' and ');
}

// "lifted straight up", or how it is moved first.
export function wayOut(report: PackedReport, id: number): string {
  const moves = (report.removal_path?.[String(id)] ?? []).map(moveInWords).filter(Boolean);
  if (moves.length === 0) return 'lifted straight up';
  if (moves.length > 3) return `moved in ${moves.length} steps, first ${moves[0]}, then lifted`;
  return `moved ${moves.join(', then ')}, then lifted`;
}

export const trayCount = (report: PackedReport): number => new Set(report.parts.map((part) => part.tray)).size;

export function stepInWords(report: PackedReport, taken: number): string {
  const order = report.removal_order;
  const id = order[taken - 1];
  const several = trayCount(report) > 1;
  if (id === undefined) return `All ${order.length} parts are on the tray${several ? 's' : ''}.`;
  const empty = several ? ' The trays are empty.' : ' The tray is empty.';
  return `Step ${taken} of ${order.length}: part ${id}, ${wayOut(report, id)}.${taken === order.length ? empty : ''}`;
}

export function ordinal(number: number): string {
  const tens = number % 100;
  const ending = tens >= 11 && tens <= 13 ? 'th' : ['th', 'st', 'nd', 'rd'][number % 10] ?? 'th';
  return `${number}${ending}`;
}
