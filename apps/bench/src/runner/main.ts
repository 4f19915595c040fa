// `npm run bench:peers`, started by packages/tools/bench-peers.mjs.
import { execFileSync } from 'node:child_process';
import { existsSync } from 'node:fs';
import { mkdir, mkdtemp, readFile, rm, writeFile } from 'node:fs/promises';
import os from 'node:os';
import { join } from 'node:path';
import { WAITS, type Wait } from '../page/completion.ts';
import type { LoadRequest, MeasureRequest } from '../page/protocol.ts';
import { BenchError } from './bench-error.ts';
import { buildPage } from './build-page.ts';
import { withPackages } from './install-peers.ts';
import { type BenchOptions, readOptions, USAGE } from './options.ts';
import { type ChosenPeer, choosePeers } from './peer-list.ts';
import { psnrOf } from './picture-error.ts';
import type { Report, Row, SceneReport } from './report.ts';
import { type BenchScene, readScene, sceneFiles } from './scenes.ts';
import { serve } from './serve.ts';
import { spreadOf } from './spread.ts';
import { reportText } from './table.ts';
import { BLANK_PAGE, Visitor } from './visit.ts';

interface Surroundings {
  /** Chromium's program. */
  readonly executablePath: string;
  readonly repositoryRoot: string;
  /** From where the command was called. */
  readonly folder: string;
}

const say = (line: string) => console.error(line);

/** Runs the bench; returns the process's exit status. */
export async function benchPeers(args: readonly string[], surroundings: Surroundings): Promise<number> {
  const work = await mkdtemp(join(os.tmpdir(), 'websplatter-bench-'));
  try {
    const options = readOptions(args, surroundings.folder);
    const report = await run(options, args, surroundings, work);
    console.log(reportText(report));
    if (options.jsonFile) await writeFile(options.jsonFile, `${JSON.stringify(report, null, 2)}\n`);
    return report.scenes.some(({ rows }) => rows.some(({ failures }) => failures.length)) ? 1 : 0;
  } catch (error) {
    if (!(error instanceof BenchError)) throw error;
    say(`${error.message}\n${USAGE}`);
    return 2;
  } finally {
    await rm(work, { recursive: true, force: true });
  }
}

async function run(
  options: BenchOptions,
  args: readonly string[],
  { executablePath, repositoryRoot }: Surroundings,
  work: string,
): Promise<Report> {
  const { size, pictureSize, frames, jumps, timeLimitMs, isSoftware } = options;
  const plyFiles = await sceneFiles(options, work);
  const peers = withPackages(options.peers, options.installs, say);
  const [floor] = choosePeers('floor-webgpu', work);
  const pages = await buildPages([floor, ...peers], work);
  await writeFile(join(work, BLANK_PAGE), '');
  const addresses = new Map(plyFiles.map((file, i) => [`/scenes/${i}.ply`, file]));
  const server = await serve(work, addresses);
  const visitor = new Visitor({ executablePath, usesGpu: !isSoftware, timeLimitMs });
  try {
    const pageOf = ({ adapterPath, options: query }: ChosenPeer) =>
      `${server.url}/${pages.get(adapterPath)}/index.html?${query}`;
    let adapter: string | null = null;
    let wait: Wait = WAITS[0];
    const scenes: SceneReport[] = [];
    for (const [i, file] of plyFiles.entries()) {
      say(`${file}: reading, and drawing in float64 …`);
      const scene = await readScene(file, options.camerasFile, pictureSize);
      const bench = new SceneBench(options, scene, `${server.url}/scenes/${i}.ply`, visitor, pageOf);
      if (i === 0) ({ wait, adapter } = await bench.quickestWait(floor, `${server.url}/${BLANK_PAGE}`));
      const rows = await Promise.all(peers.map(emptyRow));
      await bench.takePictures(rows, peers, wait);
      await bench.measure(rows, peers, wait);
      scenes.push({ scene: scene.name, splats: scene.splats, shDegree: scene.shDegree, rows });
    }
    return {
      date: new Date().toISOString(),
      command: args.join(' '),
      commit: commitOf(repositoryRoot),
      machine: machine(),
      browser: execFileSync(executablePath, ['--version'], { encoding: 'utf8' }).trim(),
      adapter,
      wait,
      ...size,
      pictureWidthPx: pictureSize.widthPx,
      pictureHeightPx: pictureSize.heightPx,
      frames,
      jumps,
      scenes,
    };
  } finally {
    await server.close();
  }
}

/** Folders of the built pages below `work`, by adapter. */
async function buildPages(peers: readonly ChosenPeer[], work: string): Promise<Map<string, string>> {
  const pages = new Map<string, string>();
  for (const { name, adapterPath } of peers) {
    if (pages.has(adapterPath)) continue;
    if (!existsSync(adapterPath)) throw new BenchError(`--peers: ${adapterPath} does not exist.`);
    const folder = `page-${pages.size}`;
    say(`Building the page of ${name} …`);
    await buildPage(adapterPath, join(work, folder));
    pages.set(adapterPath, folder);
  }
  return pages;
}

async function emptyRow({ name, isFloor, packageFile }: ChosenPeer): Promise<Row> {
  const version = packageFile && JSON.parse(await readFile(packageFile, 'utf8')).version;
  return { peer: name, isFloor, version, rounds: [], pictures: [], failures: [] };
}

/** All peers with one scene. */
class SceneBench {
  readonly #options: BenchOptions;
  readonly #scene: BenchScene;
  readonly #sceneUrl: string;
  readonly #visitor: Visitor;
  readonly #pageOf: (peer: ChosenPeer) => string;

  constructor(
    options: BenchOptions,
    scene: BenchScene,
    sceneUrl: string,
    visitor: Visitor,
    pageOf: (peer: ChosenPeer) => string,
  ) {
    this.#options = options;
    this.#scene = scene;
    this.#sceneUrl = sceneUrl;
    this.#visitor = visitor;
    this.#pageOf = pageOf;
  }

  /** Finds the wait that takes the least when nothing is drawn, not even loaded: all peers get it. */
  async quickestWait(floor: ChosenPeer, emptyUrl: string): Promise<{ wait: Wait; adapter: string | null }> {
    const { size } = this.#options;
    const floors = await this.#visitor.visit(this.#pageOf(floor), size, async (page) => {
      const found = [];
      for (const wait of WAITS) {
        await page.load({ ...this.#load(size, wait), url: emptyUrl });
        const { correctMs } = await page.measure(this.#measureRequest);
        const { adapter } = await page.state();
        found.push({ wait, ms: spreadOf(correctMs)!.median, adapter });
      }
      return found;
    });
    const quickest = floors.reduce((best, each) => (each.ms < best.ms ? each : best));
    say(`Waiting for WebGPU: ${floors.map(({ wait, ms }) => `${wait} ${ms.toFixed(2)} ms`).join(', ')}.`);
    return quickest;
  }

  /** Before anything is timed: who draws less than the others is seen first. */
  async takePictures(rows: readonly Row[], peers: readonly ChosenPeer[], wait: Wait): Promise<void> {
    const { outFolder, pictureSize } = this.#options;
    const { cameras, references, name } = this.#scene;
    if (outFolder) await mkdir(outFolder, { recursive: true });
    for (const [i, peer] of peers.entries()) {
      if (peer.isFloor) continue;
      await this.#try(rows[i], 'pictures', async () => {
        const pictures = await this.#visitor.visit(this.#pageOf(peer), pictureSize, async (page) => {
          await page.load(this.#load(pictureSize, wait));
          return page.pictures(cameras);
        });
        for (const [view, picture] of pictures.entries()) {
          rows[i].pictures.push({ camera: picture.camera, psnrDb: psnrOf(picture, references[view]) });
          if (!outFolder) continue;
          const file = `${name}.${peer.name}.${picture.camera}.png`.replace(/[^\w.-]/g, '_');
          await writeFile(join(outFolder, file), Buffer.from(picture.pngBase64, 'base64'));
        }
      });
    }
  }

  /** Rounds forwards and back, so that a machine that slows down in a run meets all alike. */
  async measure(rows: readonly Row[], peers: readonly ChosenPeer[], wait: Wait): Promise<void> {
    const order = peers.map((_, i) => i);
    for (let round = 0; round < this.#options.rounds; round++) {
      for (const i of round % 2 === 0 ? order : order.toReversed()) {
        await this.#try(rows[i], `round ${round + 1}`, async () => {
          const { size } = this.#options;
          const found = await this.#visitor.visit(this.#pageOf(peers[i]), size, async (page) => ({
            loaded: await page.load(this.#load(size, wait)),
            measured: await page.measure(this.#measureRequest),
            state: await page.state(),
            heap: await page.heap(),
          }));
          rows[i].rounds.push(found);
        });
      }
    }
  }

  async #try(row: Row, what: string, work: () => Promise<void>): Promise<void> {
    const startedMs = performance.now();
    const label = `${this.#scene.name}, ${row.peer}, ${what}`;
    try {
      await work();
      say(`${label}: ${((performance.now() - startedMs) / 1000).toFixed(1)} s`);
    } catch (error) {
      const { message } = error as Error;
      row.failures.push(`${what}: ${message}`);
      say(`${label}: FAILED: ${message}`);
    }
  }

  #load(size: BenchOptions['size'], wait: Wait): LoadRequest {
    return { url: this.#sceneUrl, ...size, wait, camera: this.#scene.cameras[0] };
  }

  get #measureRequest(): MeasureRequest {
    const { frames, warmUpFrames, jumps } = this.#options;
    return { camera: this.#scene.cameras[0], frames, warmUpFrames, jumps };
  }
}

function machine(): string {
  const cpus = os.cpus();
  const memoryGiB = Math.round(os.totalmem() / 2 ** 30);
  return `${cpus.length} × ${cpus[0]?.model ?? 'unknown'}, ${memoryGiB} GiB; ${os.type()} ${os.release()}; Node ${process.versions.node}`;
}

/** Null outside of git. */
function commitOf(folder: string): string | null {
  const git = (...args: string[]) =>
    execFileSync('git', args, { cwd: folder, encoding: 'utf8', stdio: ['ignore', 'pipe', 'ignore'] }).trim();
  try {
    const isChanged = git('status', '--porcelain', '--untracked-files=no') !== '';
    return `${git('rev-parse', '--short=12', 'HEAD')}${isChanged ? '+changes' : ''}`;
  } catch {
    return null;
  }
}
