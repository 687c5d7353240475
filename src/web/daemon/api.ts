// Requests to the daemon, and what went wrong with one in words.
import { readKey } from './key';
import { parsed } from './shown';
import type { Job, Report, Start, UploadRules, Variant } from './types';

const BASE = '/api/v1/';

// status 0: no answer came. starts: it is only refused because it starts that print at once.
export class Refusal extends Error {
  constructor(readonly status: number, readonly what: string, readonly hint: string,
              readonly starts: Start | null = null) {
    super(what);
  }
}

export const noAnswer = (): Refusal =>
  new Refusal(0, 'The daemon does not answer', 'Look whether it runs and this device is in its network.');

export function keyHeaders(): Record<string, string> {
  const key = readKey();
  return key === '' ? {} : { 'X-Api-Key': key };
}

// What the daemon's error body says; a proxy's own page says nothing useful.
export function refusalOf(status: number, body: string): Refusal {
  const unknown = new Refusal(status, `The request was refused (${status})`, 'Try again in a moment.');
  try {
    const { what, hint, starts } = parsed<{ error: Record<string, unknown> }>(body).error;
    if (typeof what !== 'string' || typeof hint !== 'string') return unknown;
    return new Refusal(status, what, hint, typeof starts === 'object' ? starts as Start | null : null);
  } catch {
    return unknown;
  }
}

export async function request(path: string, init: RequestInit = {}): Promise<Response> {
  let reply: Response;
  try {
    reply = await fetch(BASE + path, { ...init, headers: { ...init.headers, ...keyHeaders() } });
  } catch (error) {
    if (error instanceof DOMException && error.name === 'AbortError') throw error;
    throw noAnswer();
  }
  if (reply.ok) return reply;
  throw refusalOf(reply.status, await reply.text().catch(() => ''));
}

async function json<T>(path: string, init?: RequestInit): Promise<T> {
  return parsed<T>(await (await request(path, init)).text());
}

const filePath = (id: number, file: string): string => `jobs/${id}/files/${encodeURIComponent(file)}`;

export const jobFile = async (id: number, file: string): Promise<Response> => request(filePath(id, file));
export const jobReport = (id: number): Promise<Report> => json(filePath(id, 'job.json'));
export const showJob = (id: number): Promise<Job> => json(`jobs/${id}`);
export const jobsBefore = (id: number, limit: number): Promise<Job[]> => json(`jobs?before=${id}&limit=${limit}`);
export const uploadRules = (): Promise<UploadRules> => json('uploads');

export type JobVerb = 'approve' | 'hold' | 'first' | 'cancel' | 'again' | 'delete';
// starts: the job that this may start at once, 0 for none; refused where it would start another.
export const changeJob = (id: number, verb: JobVerb, starts: number): Promise<Job> =>
  json(`jobs/${id}/${verb}?starts=${starts}`, { method: 'POST' });

export const prepareJob = (id: number, variant: Variant): Promise<Job> =>
  json(`jobs/${id}/prepare?variant=${variant}`, { method: 'POST' });

export type PrinterVerb = 'clear' | 'pause' | 'resume' | 'stop';
export const changePrinter = (name: string, verb: PrinterVerb, starts: number): Promise<unknown> =>
  json(`printers/${encodeURIComponent(name)}/${verb}?starts=${starts}`, { method: 'POST' });
export const answerPrinter = (name: string, choice: number): Promise<unknown> =>
  json(`printers/${encodeURIComponent(name)}/answer?choice=${choice}`, { method: 'POST' });
