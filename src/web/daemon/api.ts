// Requests to the daemon, and what went wrong with one in words.
import { readKey } from './key';
import type { Job, Report, UploadRules } from './types';

const BASE = '/api/v1/';

// status 0: no answer came.
export class Refusal extends Error {
  constructor(readonly status: number, readonly what: string, readonly hint: string,
              readonly retryAfter_s = 0) {
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
export function refusalOf(status: number, body: string, retryAfter: string | null): Refusal {
  const wait_s = Number(retryAfter ?? 0) || 0;
  const unknown = new Refusal(status, `The request was refused (${status})`, 'Try again in a moment.', wait_s);
  try {
    const { what, hint } = (JSON.parse(body) as { error: Record<string, unknown> }).error;
    return typeof what === 'string' && typeof hint === 'string' ? new Refusal(status, what, hint, wait_s) : unknown;
  } catch {
    return unknown;
  }
}

export async function request(path: string, init: RequestInit = {}): Promise<Response> {
  let reply: Response;
  try {
    reply = await fetch(BASE + path, { ...init, headers: keyHeaders(), cache: 'no-store' });
  } catch (error) {
    if (error instanceof DOMException && error.name === 'AbortError') throw error;
    throw noAnswer();
  }
  if (reply.ok) return reply;
  throw refusalOf(reply.status, await reply.text().catch(() => ''), reply.headers.get('Retry-After'));
}

async function json<T>(path: string, init?: RequestInit): Promise<T> {
  return (await request(path, init)).json() as Promise<T>;
}

const filePath = (id: number, file: string): string => `jobs/${id}/files/${encodeURIComponent(file)}`;

export const jobFile = async (id: number, file: string): Promise<Response> => request(filePath(id, file));
export const jobReport = (id: number): Promise<Report> => json(filePath(id, 'job.json'));
export const showJob = (id: number): Promise<Job> => json(`jobs/${id}`);
export const jobsBefore = (id: number, limit: number): Promise<Job[]> => json(`jobs?before=${id}&limit=${limit}`);
export const uploadRules = (): Promise<UploadRules> => json('uploads');

export type JobVerb = 'approve' | 'hold' | 'cancel' | 'again';
export const changeJob = (id: number, verb: JobVerb): Promise<Job> =>
  json(`jobs/${id}/${verb}`, { method: 'POST' });

export type PrinterVerb = 'clear' | 'pause' | 'resume' | 'stop' | `answer?choice=${number}`;
export const changePrinter = (name: string, verb: PrinterVerb): Promise<unknown> =>
  json(`printers/${encodeURIComponent(name)}/${verb}`, { method: 'POST' });
