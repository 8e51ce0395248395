/** The real binary on a port of its own choice. */

import { spawn } from 'node:child_process';
import { existsSync } from 'node:fs';
import { mkdtemp, readFile, rm } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { setTimeout as sleep } from 'node:timers/promises';
import { fileURLToPath } from 'node:url';

const BINARY =
  process.env.TYNDALL_BIN ??
  fileURLToPath(new URL('../../../target/debug/tyndall', import.meta.url));
const START_MILLIS = 60_000;
const STOP_MILLIS = 10_000;

export class Server {
  log = '';
  #process;
  #folder;
  #options;

  /** `options` are further options of `tyndall serve`. */
  constructor(options = []) {
    this.#options = options;
  }

  /** Starts `tyndall serve`; `address` "127.0.0.1:0" lets the system choose the port. */
  async start(address = '127.0.0.1:0') {
    if (!existsSync(BINARY)) {
      throw new Error(`no binary at ${BINARY}: run "cargo build" or set TYNDALL_BIN`);
    }
    this.#folder = await mkdtemp(join(tmpdir(), 'tyndall-browser-'));
    const portFile = join(this.#folder, 'address');
    this.#process = spawn(BINARY, ['serve', '--bind', address, '--port-file', portFile, ...this.#options], {
      stdio: ['ignore', 'pipe', 'pipe'],
      env: { ...process.env, XDG_DATA_HOME: this.#folder },
    });
    for (const stream of [this.#process.stdout, this.#process.stderr]) {
      stream.setEncoding('utf8').on('data', (text) => {
        this.log += text;
      });
    }
    this.address = await this.#boundAddress(portFile);
    this.url = `http://${this.address}/`;
  }

  async #boundAddress(portFile) {
    const end = Date.now() + START_MILLIS;
    while (Date.now() < end) {
      if (this.#process.exitCode !== null) {
        throw new Error(`the server ended with ${this.#process.exitCode}:\n${this.tail()}`);
      }
      const text = existsSync(portFile) ? (await readFile(portFile, 'utf8')).trim() : '';
      const match = /(127\.0\.0\.1:\d+)/.exec(text);
      if (match !== null) return match[1];
      await sleep(50);
    }
    throw new Error(`no address in the port file after ${START_MILLIS} ms:\n${this.tail()}`);
  }

  /** Asks to stop, and insists after ten seconds. Returns the exit code, or null if insisted. */
  async stop() {
    const child = this.#process;
    if (child === undefined) return null;
    this.#process = undefined;
    const ended = new Promise((resolve) => child.once('exit', resolve));
    if (child.exitCode === null) {
      child.kill('SIGTERM');
      const insist = setTimeout(() => child.kill('SIGKILL'), STOP_MILLIS);
      await ended;
      clearTimeout(insist);
    }
    await rm(this.#folder, { recursive: true, force: true });
    return child.exitCode;
  }

  tail(lines = 30) {
    return this.log.split('\n').slice(-lines).join('\n');
  }
}
