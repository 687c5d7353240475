// The real daemon with simulated printers, in a folder of its own.
import { spawn, spawnSync } from 'node:child_process';
import { mkdirSync, mkdtempSync, openSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { createServer } from 'node:net';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { setTimeout as sleep } from 'node:timers/promises';

export const SOURCE = resolve(import.meta.dirname ?? new URL('.', import.meta.url).pathname, '../../..');
const BIN = process.env.PACKMERGER_BIN ?? join(SOURCE, 'build/bin');
export const SCREENSHOTS = join(BIN, '../page-screenshots');

export const freePort = () => new Promise((done) => {
  const server = createServer().listen(0, '127.0.0.1', () => {
    const { port } = server.address();
    server.close(() => done(port));
  });
});

// Asks again until it is so; the last answer is told where it never is.
export async function until(what, question, patience_s = 60) {
  const end = Date.now() + 1000 * patience_s;
  let last;
  while (Date.now() < end) {
    last = await question();
    if (last) return last;
    await sleep(150);
  }
  throw new Error(`${what}: not within ${patience_s} s (${JSON.stringify(last)})`);
}

export class Workshop {
  children = [];

  // printers: the text of their tables, given the addresses of the simulated machines.
  static async open({ printers, machines = {}, settings = '', files = {}, web = '' }) {
    const shop = new Workshop();
    shop.folder = mkdtempSync(join(tmpdir(), 'packmerger-page-'));
    shop.port = await freePort();
    shop.base = `http://127.0.0.1:${shop.port}`;
    for (const [name, text] of Object.entries(files)) writeFileSync(shop.path(name), text, { mode: 0o755 });
    mkdirSync(shop.path('out'));
    const ports = {};
    for (const [name, command] of Object.entries(machines)) ports[name] = await shop.simulate(name, command);
    shop.settings = (list) => `state = "state"\nretry_s = 1\n${settings}\n[web]\nport = ${shop.port}\n${web}\n${list(ports)}`;
    writeFileSync(shop.path('daemon.toml'), shop.settings(printers));
    await shop.startDaemon();
    shop.key = shop.shell('keys', 'add', 'tester').trim();
    return shop;
  }

  path(name) {
    return join(this.folder, name);
  }

  run(name, program, ...rest) {
    const log = openSync(this.path(`${name}.log`), 'a');
    const child = spawn(join(BIN, program), rest, { stdio: ['ignore', log, log], cwd: this.folder });
    this.children.push(child);
    return child;
  }

  async simulate(name, command) {
    this.run(name, 'packmerger', 'simulate', ...command);
    return until(`simulated ${name}`, () => readFileSync(this.path(`${name}.log`), 'utf8').split('\n')[0], 20);
  }

  async startDaemon() {
    this.daemon = this.run('daemon', 'packmergerd', '--config', this.path('daemon.toml'));
    await until('the web server', () => fetch(this.base).then(() => true, () => false), 30);
  }

  async stopDaemon() {
    this.daemon.kill();
    await until('the daemon ends', () => this.daemon.exitCode !== null || this.daemon.signalCode !== null, 60);
  }

  shell(...words) {
    const done = spawnSync(join(BIN, 'packmerger'), [...words, '--socket', this.path('state/packmergerd.sock')], { encoding: 'utf8' });
    if (done.status !== 0) throw new Error(`packmerger ${words.join(' ')}: ${done.stderr}`);
    return done.stdout;
  }

  async ask(path, method = 'GET', body = undefined) {
    try {
      const reply = await fetch(`${this.base}/api/v1/${path}`, { method, body, headers: { 'X-Api-Key': this.key } });
      return await reply.json();
    } catch (error) {
      const log = readFileSync(this.path('daemon.log'), 'utf8').slice(-2000);
      throw new Error(`${method} ${path}: ${error.cause ?? error}; the daemon ${this.daemon.exitCode ?? this.daemon.signalCode ?? 'runs'}: ${log}`);
    }
  }

  async upload(printer, name, content) {
    const form = new FormData();
    form.append('printer', printer);
    form.append('file', new Blob([content]), name);
    const job = await this.ask('jobs', 'POST', form);
    if (!job.id) throw new Error(JSON.stringify(job));
    return job;
  }

  job(id) {
    return this.ask(`jobs/${id}`);
  }

  async close() {
    for (const child of this.children.reverse()) child.kill();
    await sleep(500);
    for (const child of this.children) child.kill('SIGKILL');
    rmSync(this.folder, { recursive: true, force: true });
  }
}

export function bunny(folder) {
  const path = join(folder, 'bunny.obj');
  spawnSync('node', [join(SOURCE, 'tests/fixtures/bunny_obj.js'), path]);
  return path;
}
