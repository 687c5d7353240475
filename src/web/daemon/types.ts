// What the daemon tells (docs/DAEMON.md, docs/JOB_FOLDER.md). Unix times and durations in seconds. A daemon of an earlier
// version that still prints serves this page too, and may not tell what is optional here.

export type JobState =
  | 'claiming' | 'received' | 'preparing' | 'ready' | 'approved' | 'sending'
  | 'handed_over' | 'done' | 'failed' | 'cancelled';

export type Waits =
  | 'approval' | 'hold' | 'no_printer' | 'paused' | 'printer_busy' | 'clear_bed' | 'not_connected';

export interface Heater {
  name: string;
  actual_c: number;
  target_c: number | null;
}

// What fails again and again.
export interface Trouble {
  about?: string | undefined;  // only in lists
  what: string;
  since_s: number;
  tries: number;
  next_s: number | null;  // null: nobody knows when it is tried next
}

export interface Print {
  stage: string;
  fraction: number;
  done: number;
  total: number;
  text: string;
  choices: string[];
  heaters: Heater[];
  elapsed_s: number;
  remaining_s: number | null;
}

export interface Estimate {
  fits: boolean;
  time_s: number | null;
  model_g: number | null;
  support_g: number | null;
  support_mm3: number | null;
  cost: number | null;
  material_cost?: number | null;  // the three sums of the cost; earlier versions do not tell them
  machine_cost?: number | null;
  hands_cost?: number | null;
  currency: string | null;
  parts: number | null;
  trays: number | null;
  assembly_min: number | null;
  source: 'model' | 'slicer' | 'program' | 'moves' | null;
  reason?: string | null;  // why it cannot be made; left out where it can, or only does not fit
  hint?: string | null;
}

export type Way = 'as_is' | 'solid' | 'hollow' | 'packed';
export type Variant = Exclude<Way, 'as_is'>;
export type Estimates = Partial<Record<Way, Estimate>>;

// How the printers were compared for a model that named none.
export interface Choice {
  prefer: 'cheapest' | 'soonest';
  chosen: string;
  printers: {
    printer: string;
    fits: boolean;
    time_s: number | null;
    cost: number | null;
    currency: string | null;
    ready_in_s: number | null;
    reason: string;
  }[];
}

export interface JobEvent {
  at_s: number;
  state: JobState;
  note: string;
}

export interface Job {
  id: number;
  printer: string;
  name: string;
  state: JobState;
  held: boolean;
  turn?: number;
  waits_for: Waits | null;
  status: string;
  progress: (Partial<Print> & { stage: string; fraction: number }) | null;
  trays: number;
  tray: number;
  variant: Variant | 'program' | '';  // what was prepared; '' before, and in old jobs
  pays: boolean;
  advice?: { variant: Variant | null; text: string } | null;  // which way is best; only where one job is asked for
  doubt?: string | null;  // what speaks against printing what was prepared
  approved?: boolean;
  estimates: Estimates | null;
  reason: string;
  hint: string;
  told: { done: number; total: number } | null;
  trouble?: Trouble | null;  // why it cannot be taken, begun or filed, although it is tried
  folder: string;
  tray_files?: { file: string; sha256: string }[] | null;  // null: not prepared yet, or by an earlier version
  kind: 'model' | 'program';
  chosen_by: string | null;
  choice: Choice | null;
  same_as: number | null;
  predicted_s: number | null;
  printed_s: number | null;
  again_of: number | null;
  received_s: number | null;
  sending_s: number | null;
  ended_s: number | null;
  deleted_s?: number | null;  // its folder
  filed: string;
  history?: JobEvent[];
}

export interface Printer {
  name: string;
  profile: string;
  folder: string;
  port: string;
  handoff_folder: string;
  prefer: 'cheapest' | 'soonest' | null;  // not null: it stands for all others, and proposes one
  approve: 'auto' | 'ask';
  simulated: boolean;
  connected: boolean | null;
  bed: 'clear' | 'not clear' | 'none';
  paused: boolean;
  trouble?: string | null;  // all of troubles, in words
  troubles?: Trouble[];  // of the printer and its folders
  job: number | null;
  print: Print | null;
}

// The disk of the state folder, and which jobs' folders are deleted.
export interface Storage {
  free_bytes: number | null;
  low: boolean;
  keep_days: number;
  keep_jobs: number;
  announced: { from_s: number; jobs: number } | null;
}

export interface State {
  jobs: Job[];
  printers: Printer[];
  storage: Storage | null;
  troubles: Trouble[];  // of neither a job nor a printer
}

export type ToldState = Pick<State, 'jobs' | 'printers'> & Partial<State>;

// The print that an action starts at once.
export interface Start {
  job: number;
  name: string;
  printer: string;
  tray: number;
  trays: number;
  time_s: number | null;
  doubt: string | null;
}

export interface UploadRules {
  most_bytes: number;
  endings: string[];  // of names
  formats: string[];  // as people call them
}

export type Vec2 = [number, number];
export type Vec3 = [number, number, number];

export interface Part {
  id: number;
  model: number;
  tray: number;
  volume_mm3: number;
  neighbours: { id: number; glue_area_mm2: number }[];
}

// job.json, as far as the page shows it. A program that somebody else made has no size and no parts.
export interface Report {
  inputs: { file: string; size_mm?: Vec3 }[];
  variant: string;
  // Where parts may stand, and where not; jobs of earlier versions do not tell.
  printer: { name: string; dialect: string; build_mm: Vec3; plate_mm?: Vec2[]; keep_out_mm?: Vec2[][] };
  parts?: Part[];
  removal_order?: number[];
  removal_path?: Record<string, Vec3[]>;
  resample_tolerance_mm?: number;
  warnings: { code: string; text: string }[];
}

// A job that can be taken apart in 3D.
export type PackedReport = Report & { parts: Part[]; removal_order: number[] };
export const isPacked = (report: Report): report is PackedReport =>
  (report.parts?.length ?? 0) > 0 && report.removal_order !== undefined;

// Of what was prepared. A program says what it takes itself, as it is.
export const ownEstimate = ({ variant, estimates }: Job): Estimate | undefined =>
  estimates?.[variant === 'program' ? 'as_is' : variant || 'packed'];

const ENDED: readonly JobState[] = ['done', 'handed_over', 'failed', 'cancelled'];
export const hasEnded = (job: Job): boolean => ENDED.includes(job.state);
