import { execFileSync } from 'node:child_process';
import { mkdir, writeFile } from 'node:fs/promises';
import { join } from 'node:path';
import { timeSpread } from '@websplatter/core/measure';
import { syntheticCamera } from '@websplatter/scenes';
import { type FileServer, type FileServerOptions, serveFiles } from '@websplatter/tools/file-server';
import { WAITS, type Wait } from '../page/completion.ts';
import type { Picture } from '../page/protocol.ts';
import type { BenchSetup } from './bench.ts';
import { BLANK_PAGE, type BuiltPeer } from './built-pages.ts';
import type { CommonOptions, SizePx } from './options.ts';
import { machineText, type RunReport } from './report.ts';
import { type OpenPage, Visitor } from './visit.ts';

/** A page that is isolated from other origins may share memory with its workers. */
const PAGE_HEADERS = {
  'cross-origin-opener-policy': 'same-origin',
  'cross-origin-embedder-policy': 'require-corp',
  'cross-origin-resource-policy': 'same-origin',
  'cache-control': 'no-store',
};

type SessionOptions = CommonOptions & {
  /** Frames after jumps, by which the quickest wait is found. */
  readonly jumps: number;
};

/** Part of a report: a peer, which is filled in as it is measured. */
interface FilledRow {
  readonly peer: string;
  /** Why rounds or pictures are missing. */
  readonly failures: string[];
}

/**
 * Serves pages and scenes while `work` measures them.
 *
 * @returns the result of `work`, with the facts of the run.
 */
export async function inSession<Found extends object>(
  options: SessionOptions,
  setup: BenchSetup,
  serving: Pick<FileServerOptions, 'files' | 'answer'>,
  work: (session: Session) => Promise<Found>,
): Promise<RunReport & Found> {
  const server = await serveFiles(setup.pagesFolder, { headers: PAGE_HEADERS, ...serving });
  try {
    const session = new Session(options, setup, server);
    const found = await work(session);
    const { commandLine, executablePath, pages } = setup;
    return {
      date: new Date().toISOString(),
      command: [commandLine.name, ...commandLine.args].join(' '),
      commit: pages.commit,
      machine: machineText(),
      browser: execFileSync(executablePath, ['--version'], { encoding: 'utf8' }).trim(),
      ...(await session.quickestWait()),
      frames: options.frames,
      ...found,
    };
  } finally {
    await server.close();
  }
}

export class Session {
  readonly #options: SessionOptions;
  readonly #setup: BenchSetup;
  readonly #server: FileServer;
  readonly #visitor: Visitor;
  #quickest: Promise<Pick<RunReport, 'wait' | 'adapter'>> | undefined;

  constructor(options: SessionOptions, setup: BenchSetup, server: FileServer) {
    const { isSoftware, timeLimitMs, budgetMs } = options;
    this.#options = options;
    this.#setup = setup;
    this.#server = server;
    this.#visitor = new Visitor({
      executablePath: setup.executablePath,
      usesGpu: !isSoftware,
      timeLimitMs,
      deadlineMs: performance.now() + budgetMs,
      blankUrl: this.urlOf(BLANK_PAGE),
    });
  }

  /** @param address from the root of all pages. */
  urlOf(address: string): string {
    return this.#server.url + address;
  }

  /** Prints a line of progress. */
  say(line: string): void {
    this.#setup.say(line);
  }

  /** Opens the peer's page in a fresh browser. @param query more options for its adapter. */
  visit<Result>(
    { page }: BuiltPeer,
    size: SizePx,
    use: (page: OpenPage) => Promise<Result>,
    query = '',
  ): Promise<Result> {
    return this.#visitor.visit(this.urlOf(page + query), size, use);
  }

  /** The quickest way to wait for WebGPU if nothing is drawn, not even loaded: all peers get it. */
  quickestWait(): Promise<Pick<RunReport, 'wait' | 'adapter'>> {
    this.#quickest ??= this.#findQuickestWait();
    return this.#quickest;
  }

  async #findQuickestWait(): Promise<{ readonly wait: Wait; readonly adapter: string | null }> {
    const { size, frames, warmUpFrames, jumps } = this.#options;
    const camera = syntheticCamera;
    const floors = await this.visit(this.#setup.pages.floor, size, async (page) => {
      const found = [];
      for (const wait of WAITS) {
        await page.load({ ...size, url: this.urlOf(BLANK_PAGE), fileName: BLANK_PAGE, wait, camera });
        const { correctMs } = await page.measure({ camera, frames, warmUpFrames, jumps });
        const { adapter } = await page.state();
        found.push({ wait, ms: timeSpread(correctMs).median, adapter });
      }
      return found;
    });
    const { wait, adapter } = floors.reduce((best, each) => (each.ms < best.ms ? each : best));
    const times = floors.map((each) => `${each.wait} ${each.ms.toFixed(2)} ms`);
    this.say(`Waiting for WebGPU: ${times.join(', ')}.`);
    return { wait, adapter };
  }

  /** Rounds forwards and back, so that a machine that slows down in a run meets all alike. */
  async inRounds<Peer>(
    peers: readonly Peer[],
    measure: (peer: Peer, round: number) => Promise<unknown>,
  ): Promise<void> {
    for (let round = 0; round < this.#options.rounds; round++)
      for (const peer of round % 2 === 0 ? peers : peers.toReversed()) await measure(peer, round);
  }

  /** Does a part of the work for a peer, and says how long it took; a failure is noted: null. */
  async attempt<Result>(
    { peer, failures }: FilledRow,
    what: string,
    work: () => Promise<Result>,
    scene?: string,
  ): Promise<Result | null> {
    const startedMs = performance.now();
    const label = [...(scene ? [scene] : []), peer, what].join(', ');
    try {
      const result = await work();
      this.say(`${label}: ${((performance.now() - startedMs) / 1000).toFixed(1)} s`);
      return result;
    } catch (error) {
      const { message } = error as Error;
      failures.push(`${what}: ${message}`);
      this.say(`${label}: FAILED: ${message}`);
      return null;
    }
  }

  /** Writes pictures into the folder of `--out`, if there is one: `NAME.CAMERA.png`. */
  async keep(pictures: readonly Picture[], name: string): Promise<void> {
    const { outFolder } = this.#options;
    if (!outFolder) return;
    await mkdir(outFolder, { recursive: true });
    for (const { camera, pngBase64 } of pictures) {
      const file = `${name}.${camera}.png`.replace(/[^\w.-]/g, '_');
      await writeFile(join(outFolder, file), Buffer.from(pngBase64, 'base64'));
    }
  }
}
