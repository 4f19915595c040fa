import { mkdir, writeFile } from 'node:fs/promises';
import { basename, dirname, join, sep } from 'node:path';
import type { SceneCamera } from '@websplatter/scenes';
import { type FileServer, serveFiles } from '@websplatter/tools/file-server';
import type { Wait } from '../page/completion.ts';
import type { Picture } from '../page/protocol.ts';
import type { BenchSetup, SizePx } from '../runner/bench-definition.ts';
import { BLANK_PAGE, type BuiltPeer } from '../runner/built-pages.ts';
import { readCameras } from '../runner/cameras.ts';
import { machineOf, PAGE_HEADERS } from '../runner/machine.ts';
import { psnrOf } from '../runner/picture-error.ts';
import { quickestWait } from '../runner/quickest-wait.ts';
import { drawReferences } from '../runner/references.ts';
import { type BenchScene, readScene } from '../runner/scenes.ts';
import { type OpenPage, Visitor } from '../runner/visit.ts';
import type { StreamsOptions } from './options.ts';
import type { StreamRound, StreamRow, StreamsReport } from './report.ts';
import { SceneLine } from './scene-line.ts';
import { type Budget, streamPeer } from './stream-peers.ts';

/** Addresses below it are the scene's files, those of each format in a folder. */
const SCENE_PATH = 'scene/';
/** Frames after jumps, by which the quickest wait is found. */
const WAIT_JUMPS = 16;

/** Measures `peers` with one scene in several files. @throws BenchError if one cannot be read. */
export async function measureStreams(
  options: StreamsOptions,
  peers: readonly BuiltPeer[],
  { executablePath, commandLine, pages, pagesFolder, say }: BenchSetup,
): Promise<StreamsReport> {
  const { size, pictureSize, frames, warmUpFrames, maxSplats, poolBytes, bitsPerSecond, latencyMs } = options;
  const { sceneFile, camerasFile, timeLimitMs, budgetMs, isSoftware } = options;
  const scene = sceneFile ? await readScene(sceneFile, camerasFile) : null;
  const cameras = scene?.cameras ?? (await readCameras(camerasFile!));
  const line = new SceneLine({ bitsPerSecond, latencyMs });
  const server = await serveFiles(pagesFolder, {
    headers: PAGE_HEADERS,
    answer: (path, request, response) => {
      const file = sceneFileAt(path, options.files);
      if (file) void line.answer(file, request, response);
      return file !== null;
    },
  });
  const visitor = new Visitor({
    executablePath,
    usesGpu: !isSoftware,
    timeLimitMs,
    deadlineMs: performance.now() + budgetMs,
    blankUrl: server.url + BLANK_PAGE,
  });
  try {
    const asked = { size, frames, warmUpFrames, jumps: WAIT_JUMPS };
    const { wait, adapter } = await quickestWait(visitor, server.url + pages.floor.page, asked, say);
    const measured = peers.map(
      (peer) => new MeasuredPeer(peer, options, { cameras, line, server, visitor, wait, say }),
    );
    if (options.takesPictures) await takePictures(measured, scene, pictureSize);
    // Rounds forwards and back, so that a machine that slows down in a run meets all alike.
    for (let round = 0; round < options.rounds; round++)
      for (const peer of round % 2 === 0 ? measured : measured.toReversed()) await peer.measure(round);
    return {
      date: new Date().toISOString(),
      command: [commandLine.name, ...commandLine.args].join(' '),
      commit: pages.commit,
      ...machineOf(executablePath),
      adapter,
      wait,
      ...{ size, pictureSize, frames, maxSplats, poolBytes, latencyMs },
      bitsPerSecond: Number.isFinite(bitsPerSecond) ? bitsPerSecond : null,
      rows: measured.map(({ row }) => row),
    };
  } finally {
    await server.close();
  }
}

/** The file at an address; null for addresses of something else. */
function sceneFileAt(path: string, files: StreamsOptions['files']): string | null {
  const [, format, inFolder] = /^scene\/([^/]+)\/(.+)$/.exec(decodeURIComponent(path)) ?? [];
  const leading = files[format as keyof typeof files];
  if (!leading) return null;
  const folder = dirname(leading);
  const file = join(folder, inFolder);
  return file.startsWith(folder + sep) ? file : null;
}

/** Threads draw in float64 meanwhile. */
async function takePictures(
  peers: readonly MeasuredPeer[],
  scene: BenchScene | null,
  size: SizePx,
): Promise<void> {
  const takeAll = async () => {
    const taken = [];
    for (const peer of peers) taken.push(await peer.takePictures());
    return taken;
  };
  const [references, taken] = await Promise.all([scene && drawReferences(scene, size), takeAll()]);
  for (const [i, pictures] of taken.entries())
    for (const [view, { budgeted, finest }] of pictures.entries())
      peers[i].row.pictures.push({
        camera: budgeted.camera,
        ownPsnrDb: psnrOf(budgeted, levelsOf(finest)),
        psnrDb: references && psnrOf(budgeted, references[view]),
        finestPsnrDb: references && psnrOf(finest, references[view]),
      });
}

function levelsOf({ rgbaBase64 }: Picture): Float64Array {
  return Float64Array.from(Buffer.from(rgbaBase64, 'base64'), (value) => value / 255);
}

interface Surroundings {
  readonly cameras: readonly SceneCamera[];
  readonly line: SceneLine;
  readonly server: FileServer;
  readonly visitor: Visitor;
  readonly wait: Wait;
  readonly say: (line: string) => void;
}

class MeasuredPeer {
  readonly row: StreamRow;
  readonly #peer: BuiltPeer;
  readonly #options: StreamsOptions;
  readonly #surroundings: Surroundings;

  constructor(peer: BuiltPeer, options: StreamsOptions, surroundings: Surroundings) {
    const { name, version } = peer;
    this.row = {
      peer: name,
      version,
      format: streamPeer(name).format,
      rounds: [],
      pictures: [],
      failures: [],
    };
    this.#peer = peer;
    this.#options = options;
    this.#surroundings = surroundings;
  }

  /** Returns pairs by camera; none if it fails, which the row then says. */
  async takePictures(): Promise<{ readonly budgeted: Picture; readonly finest: Picture }[]> {
    const { pictureSize } = this.#options;
    const { cameras } = this.#surroundings;
    const taken = (budget: Budget, name: string) =>
      this.#try(`pictures ${name}`, () =>
        this.#visit(budget, pictureSize, async (page, load) => {
          await load();
          const pictures = await page.pictures(cameras);
          await this.#keep(pictures, name);
          return pictures;
        }),
      );
    const finest = await taken(null, 'finest');
    const budgeted = await taken(this.#options, 'budgeted');
    return (finest && budgeted?.map((each, view) => ({ budgeted: each, finest: finest[view] }))) ?? [];
  }

  async #keep(pictures: readonly Picture[], name: string): Promise<void> {
    const { outFolder } = this.#options;
    if (!outFolder) return;
    await mkdir(outFolder, { recursive: true });
    for (const { camera, pngBase64 } of pictures) {
      const file = `${this.row.peer}.${name}.${camera}.png`.replace(/[^\w.-]/g, '_');
      await writeFile(join(outFolder, file), Buffer.from(pngBase64, 'base64'));
    }
  }

  async measure(round: number): Promise<void> {
    const { size, frames, warmUpFrames } = this.#options;
    const { cameras, line } = this.#surroundings;
    const request = { camera: cameras[0], frames, warmUpFrames, jumps: 0 };
    const measured = await this.#try(`round ${round + 1}`, () =>
      this.#visit(this.#options, size, async (page, load): Promise<StreamRound> => {
        line.restart();
        const streamed = await load();
        const { startedAtMs, firstPictureMs, completeMs } = streamed;
        const sent = (ms: number) => line.bytesUntil(startedAtMs + ms);
        const bytes = {
          firstPicture: sent(firstPictureMs),
          complete: sent(completeMs),
          rest: line.bytesUntil(),
        };
        const state = await page.state();
        const heap = await page.heap();
        const turned = await page.measure(request);
        const { requests } = line;
        return {
          round,
          streamed,
          state,
          heap,
          measured: turned,
          bytes: { ...bytes, turn: line.bytesUntil() },
          requests,
        };
      }),
    );
    if (measured) this.row.rounds.push(measured);
  }

  /** Opens the peer's page with a budget, whose `load` streams the scene until it is at rest. */
  async #visit<Result>(
    budget: Budget,
    size: SizePx,
    use: (page: OpenPage, load: () => ReturnType<OpenPage['stream']>) => Promise<Result>,
  ): Promise<Result> {
    const { server, visitor, wait, cameras } = this.#surroundings;
    const { format, settings } = streamPeer(this.row.peer);
    const file = this.#options.files[format]!;
    const asked = await settings(budget, file);
    const query = Object.entries(asked).map(([name, value]) => `&${name}=${value}`);
    const fileName = basename(file);
    const url = `${server.url}${SCENE_PATH}${format}/${encodeURIComponent(fileName)}`;
    return visitor.visit(server.url + this.#peer.page + query.join(''), size, (page) =>
      use(page, () => page.stream({ url, fileName, ...size, wait, camera: cameras[0] })),
    );
  }

  async #try<Result>(what: string, work: () => Promise<Result>): Promise<Result | null> {
    const { say } = this.#surroundings;
    const startedMs = performance.now();
    const label = `${this.row.peer}, ${what}`;
    try {
      const result = await work();
      say(`${label}: ${((performance.now() - startedMs) / 1000).toFixed(1)} s`);
      return result;
    } catch (error) {
      const { message } = error as Error;
      this.row.failures.push(`${what}: ${message}`);
      say(`${label}: FAILED: ${message}`);
      return null;
    }
  }
}
