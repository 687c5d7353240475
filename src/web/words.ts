// Figures and states as people read them.
import { hasEnded, type Job, type Printer, type Start, type Storage, type Trouble } from './daemon/types';

const rounded = (value: number, digits: number): string =>
  value.toLocaleString('en', { maximumFractionDigits: digits, minimumFractionDigits: digits });

// A figure and its unit stay on one line.
const UNBROKEN = '\u00a0';
const figure = (value: number | string, unit: string): string => `${value}${UNBROKEN}${unit}`;

export function duration(seconds: number): string {
  const whole = Math.max(0, Math.round(seconds));
  if (whole < 60) return figure(whole, 's');
  const minutes = Math.round(whole / 60);
  if (minutes < 60) return figure(minutes, 'min');
  const hours = Math.floor(minutes / 60);
  if (hours < 48) return `${figure(hours, 'h')} ${figure(String(minutes % 60).padStart(2, '0'), 'min')}`;
  return `${figure(Math.floor(hours / 24), 'd')} ${figure(hours % 24, 'h')}`;
}

export const percent = (fraction: number): string => figure(Math.floor(100 * Math.min(1, Math.max(0, fraction))), '%');

export const grams = (g: number): string =>
  (g < 1000 ? figure(rounded(g, g < 10 ? 1 : 0), 'g') : figure(rounded(g / 1000, 2), 'kg'));

export const degrees = (c: number): string => figure(Math.round(c), '°C');

export function money(amount: number, currency: string | null): string {
  try {
    return new Intl.NumberFormat('en', { style: 'currency', currency: currency ?? '' }).format(amount);
  } catch {
    return rounded(amount, 2);
  }
}

export function bytes(count: number): string {
  const units = ['bytes', 'KiB', 'MiB', 'GiB', 'TiB'];
  let unit = 0;
  let value = count;
  for (; value >= 1024 && unit < units.length - 1; unit += 1) value /= 1024;
  return figure(rounded(value, unit === 0 || value >= 100 || Number.isInteger(value) ? 0 : 1), units[unit] ?? '');
}

// "−38 %" of value against what it is compared with; '' where that says nothing.
export function difference(value: number | null | undefined, against: number | null | undefined): string {
  if (value == null || against == null || against === 0) return '';
  const change = Math.round((100 * (value - against)) / against);
  if (change === 0) return figure('±0', '%');
  return figure(`${change < 0 ? '−' : '+'}${Math.abs(change)}`, '%');
}

const clock = (date: Date): string => date.toLocaleTimeString(undefined, { hour: '2-digit', minute: '2-digit' });

export function when(unix_s: number): string {
  const date = new Date(1000 * unix_s);
  const time = clock(date);
  if (date.toDateString() === new Date().toDateString()) return `today, ${time}`;
  return `${date.toLocaleDateString(undefined, { day: 'numeric', month: 'short', year: 'numeric' })}, ${time}`;
}

// The daemon's phrases as sentences; what begins with the name of a file keeps it.
export function sentence(text: string): string {
  const begun = text.replace(/^[a-z]+(?=[ ,:]|$)/, (word) => word.charAt(0).toUpperCase() + word.slice(1));
  return text === '' || /[.!?…]$/.test(text) ? begun : `${begun}.`;
}

export const count = (number: number, one: string): string => `${number} ${one}${number === 1 ? '' : 's'}`;

export type Tone = 'calm' | 'busy' | 'good' | 'attention' | 'bad';

export interface Badge {
  tone: Tone;
  text: string;
}

const JOB_BADGES: Record<Job['state'], Badge> = {
  claiming: { tone: 'busy', text: 'Arriving' },
  received: { tone: 'calm', text: 'Waiting' },
  preparing: { tone: 'busy', text: 'Preparing' },
  ready: { tone: 'attention', text: 'Ready to approve' },
  approved: { tone: 'calm', text: 'Approved' },
  sending: { tone: 'busy', text: 'Sending' },
  handed_over: { tone: 'good', text: 'Handed over' },
  done: { tone: 'good', text: 'Printed' },
  failed: { tone: 'bad', text: 'Failed' },
  cancelled: { tone: 'calm', text: 'Cancelled' },
};

const STAGE_BADGES: Record<string, Badge> = {
  connecting: { tone: 'busy', text: 'Connecting' },
  heating: { tone: 'busy', text: 'Heating' },
  printing: { tone: 'busy', text: 'Printing' },
  paused: { tone: 'attention', text: 'Paused' },
  waiting: { tone: 'attention', text: 'Asks you' },
  cancelling: { tone: 'attention', text: 'Cancelling' },
  done: { tone: 'good', text: 'Finishing' },
};

export function jobBadge(job: Job): Badge {
  if (job.held && job.state !== 'sending' && !hasEnded(job)) return { tone: 'attention', text: 'Held' };
  if (job.state === 'sending') return STAGE_BADGES[job.progress?.stage ?? ''] ?? JOB_BADGES.sending;
  if (job.state === 'approved' && job.waits_for === 'clear_bed') return { tone: 'attention', text: 'Clear the bed' };
  return JOB_BADGES[job.state];
}

export function printerBadge(printer: Printer): Badge {
  if (printer.print) return STAGE_BADGES[printer.print.stage] ?? JOB_BADGES.sending;
  if (printer.job !== null) return { tone: 'busy', text: 'Handing over' };
  if (printer.prefer !== null) return { tone: 'calm', text: 'Chooses' };
  if (printer.paused) return { tone: 'attention', text: 'Paused' };
  if (printer.connected === false) return { tone: 'bad', text: 'Not connected' };
  if (printer.bed === 'not clear') return { tone: 'attention', text: 'Bed not clear' };
  return { tone: 'good', text: 'Ready' };
}

// How far a job has come, in words; the bar beside it tells how much.
export function progressText(job: Job): string {
  const { progress } = job;
  if (progress === null) return '';
  if (job.state !== 'sending') return `${progress.stage.charAt(0).toUpperCase()}${progress.stage.slice(1)}`;
  const left = progress.remaining_s != null && progress.done ? `${duration(progress.remaining_s)} left` : '';
  return [job.trays > 1 ? `Tray ${job.tray} of ${job.trays}` : '', progress.text ?? '', left].filter(Boolean).join(' · ');
}

// What a person does next about a job that waits; '' where nothing is to be done.
export function nextStep(job: Job): string {
  switch (job.waits_for) {
    case 'approval': return 'Look at it, then approve it.';
    case 'hold': return 'It stays here until somebody lets it go on.';
    case 'no_printer': return `The settings name no printer “${job.printer}” any more: add it again, or cancel the job.`;
    case 'paused': return 'The printer is paused: resume it to go on.';
    case 'printer_busy': return 'It starts when the print before it has ended.';
    case 'clear_bed': return 'Take the last print off the printer, then say that the bed is clear.';
    case 'not_connected': return 'Connect the printer and switch it on; the job then starts by itself.';
    case null: return '';
  }
}

// What becomes of a model that arrives.
export const afterArrival = ({ approve }: Printer): string => `it is prepared, and then ${
  approve === 'auto' ? 'goes to the printer by itself where nothing speaks against it' : 'waits here for you to approve it'}.`;

// The question before a tap starts a print.
export function startInWords({ job, name, printer, tray, trays, time_s, doubt }: Start) {
  const which = trays > 1 ? `Tray ${tray} of ${trays} of ${name}` : name;
  return {
    title: `Start printing on ${printer}?`,
    text: [`${which} (job ${job}) starts now on ${printer}.`,
           time_s === null ? 'How long it takes is not known.' : `It takes about ${duration(time_s)}.`,
           doubt === null ? '' : `What speaks against it: ${doubt}.`].filter(Boolean).join(' '),
    yes: 'Start the print', no: 'Not yet', calm: true,
  };
}

// '' where nobody has to do anything.
export function storageInWords({ free_bytes, low, announced, keep_days, keep_jobs }: Storage): string {
  return [
    low && free_bytes !== null ? `The daemon’s disk has only ${bytes(free_bytes)} left. Make room, or delete the files of jobs that are not needed.` : '',
    announced ? `From ${when(announced.from_s)} on the files of ${count(announced.jobs, 'ended job')} are deleted (keep_days = ${keep_days}, keep_jobs = ${keep_jobs}). Set these to 0 in the settings to keep them as long as there is room.` : '',
  ].filter(Boolean).join(' ');
}

// "Nobody answers. Since today, 14:05, tried 7 times, next at 14:21."
export function troubleInWords({ about, what, since_s, tries, next_s }: Trouble): string {
  const told = [`since ${when(since_s)}`, tries > 1 ? `tried ${count(tries, 'time')}` : '',
                next_s === null ? '' : `next at ${clock(new Date(1000 * next_s))}`];
  return `${sentence(about ? `${about}: ${what}` : what)} ${sentence(told.filter(Boolean).join(', '))}`;
}

// What is wrong with a printer and its folders. Daemons of before tell it in words alone.
export function troublesOf({ trouble, troubles }: Printer): string[] {
  if (troubles) return troubles.map((one) => troubleInWords({ ...one, about: undefined }));
  return trouble ? [sentence(trouble)] : [];
}

const HEATERS: Record<string, string> = { tool: 'Nozzle', bed: 'Bed', chamber: 'Chamber' };
export function heaterName(name: string): string {
  const [kind = '', ...rest] = name.split(' ');
  return [HEATERS[kind] ?? kind, ...rest].join(' ');
}
