import { basename, dirname, join, sep } from 'node:path';
import type { SceneCamera } from '@websplatter/scenes';
import type { FileServerOptions } from '@websplatter/tools/file-server';
import type { LoadRequest, Picture } from '../page/protocol.ts';
import type { BenchSetup, PageBench } from '../runner/bench.ts';
import type { BuiltPeer } from '../runner/built-pages.ts';
import { readCameras } from '../runner/cameras.ts';
import { filesOf } from '../runner/evidence.ts';
import type { SizePx } from '../runner/options.ts';
import { drawReferences, levelsOf, psnrOf } from '../runner/pictures.ts';
import { type BenchScene, readScene } from '../runner/scenes.ts';
import { inSession, type Session } from '../runner/session.ts';
import type { OpenPage } from '../runner/visit.ts';
import { readOptions, type StreamsOptions, USAGE } from './options.ts';
import type { StreamRound, StreamRow, StreamsReport } from './report.ts';
import { SceneLine } from './scene-line.ts';
import { type Budget, chooseStreamPeers, streamPeer, withFiles } from './stream-peers.ts';
import { reportLegend, reportPart, reportText } from './table.ts';

/** Scenes that stream. */
const bench: PageBench<StreamsOptions> = {
  script: 'bench:streams',
  usage: USAGE,
  readOptions,
  choose: chooseStreamPeers,
  async measure(options, peers, setup) {
    const report = await measureStreams(options, withFiles(peers, options), setup);
    return {
      text: reportText(report),
      files: filesOf(options, report, [reportPart(report)], reportLegend(report)),
      hasFailures: report.rows.some(({ failures }) => failures.length > 0),
    };
  },
};
export default bench;

/** Addresses below it are the scene's files, in a folder for each format. */
const SCENE_PATH = 'scene/';
/** Frames after jumps, by which the quickest wait is found. */
const WAIT_JUMPS = 16;

async function measureStreams(
  options: StreamsOptions,
  peers: readonly BuiltPeer[],
  setup: BenchSetup,
): Promise<StreamsReport> {
  const { size, pictureSize, maxSplats, poolBytes, bitsPerSecond, latencyMs } = options;
  const { sceneFile, camerasFile, files } = options;
  const scene = sceneFile ? await readScene(sceneFile, camerasFile) : null;
  const cameras = scene?.cameras ?? (await readCameras(camerasFile!));
  const line = new SceneLine({ bitsPerSecond, latencyMs });
  const serving: Pick<FileServerOptions, 'answer'> = {
    answer: (path, request, response) => {
      const file = sceneFileAt(path, files);
      if (file) void line.answer(file, request, response);
      return file !== null;
    },
  };
  return inSession({ ...options, jumps: WAIT_JUMPS }, setup, serving, async (session) => {
    await session.quickestWait();
    const measured = peers.map((peer) => new MeasuredPeer(peer, options, cameras, line, session));
    if (options.takesPictures) await takePictures(measured, scene, pictureSize);
    await session.inRounds(measured, (peer, round) => peer.measure(round));
    return {
      ...{ size, pictureSize, maxSplats, poolBytes, latencyMs },
      bitsPerSecond: Number.isFinite(bitsPerSecond) ? bitsPerSecond : null,
      rows: measured.map(({ row }) => row),
    };
  });
}

/** The file at an address; null for other addresses. */
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

class MeasuredPeer {
  readonly row: StreamRow;
  readonly #peer: BuiltPeer;
  readonly #options: StreamsOptions;
  readonly #cameras: readonly SceneCamera[];
  readonly #line: SceneLine;
  readonly #session: Session;

  constructor(
    peer: BuiltPeer,
    options: StreamsOptions,
    cameras: readonly SceneCamera[],
    line: SceneLine,
    session: Session,
  ) {
    const { name, version } = peer;
    const { format } = streamPeer(name);
    this.row = { peer: name, version, format, rounds: [], pictures: [], failures: [] };
    this.#peer = peer;
    this.#options = options;
    this.#cameras = cameras;
    this.#line = line;
    this.#session = session;
  }

  /** Returns pairs by camera; none if it fails, which the row then says. */
  async takePictures(): Promise<{ readonly budgeted: Picture; readonly finest: Picture }[]> {
    const taken = (budget: Budget, name: string) =>
      this.#session.attempt(this.row, `pictures ${name}`, () =>
        this.#visit(budget, this.#options.pictureSize, async (page, load) => {
          await page.stream(load);
          const pictures = await page.pictures(this.#cameras);
          await this.#session.keep(pictures, `${this.row.peer}.${name}`);
          return pictures;
        }),
      );
    const finest = await taken(null, 'finest');
    const budgeted = await taken(this.#options, 'budgeted');
    return (finest && budgeted?.map((each, view) => ({ budgeted: each, finest: finest[view] }))) ?? [];
  }

  async measure(round: number): Promise<void> {
    const { size, frames, warmUpFrames } = this.#options;
    const line = this.#line;
    const request = { camera: this.#cameras[0], frames, warmUpFrames, jumps: 0 };
    const sent = (startedAtMs: number, ms: number) => line.bytesUntil(startedAtMs + ms);
    const measured = await this.#session.attempt(this.row, `round ${round + 1}`, async () => {
      const first = await this.#visit(this.#options, size, async (page, load) => {
        line.restart();
        const watched = await page.streamWatched(load);
        return { watched, bytes: sent(watched.startedAtMs, watched.firstPictureMs) };
      });
      return this.#visit(this.#options, size, async (page, load): Promise<StreamRound> => {
        line.restart();
        const streamed = await page.stream(load);
        const bytes = {
          firstPicture: first.bytes,
          complete: sent(streamed.startedAtMs, streamed.completeMs),
          rest: line.bytesUntil(),
        };
        const state = await page.state();
        const heap = await page.heap();
        const turned = await page.measure(request);
        const { requests } = line;
        return {
          ...{ round, watched: first.watched, streamed, state, heap, measured: turned },
          ...{ bytes: { ...bytes, turn: line.bytesUntil() }, requests },
        };
      });
    });
    if (measured) this.row.rounds.push(measured);
  }

  /** Opens the peer's page with a budget; `load` is the request for the scene. */
  async #visit<Result>(
    budget: Budget,
    size: SizePx,
    use: (page: OpenPage, load: LoadRequest) => Promise<Result>,
  ): Promise<Result> {
    const session = this.#session;
    const { format, settings } = streamPeer(this.row.peer);
    const file = this.#options.files[format]!;
    const query = Object.entries(await settings(budget, file)).map(([name, value]) => `&${name}=${value}`);
    const fileName = basename(file);
    const url = session.urlOf(`${SCENE_PATH}${format}/${encodeURIComponent(fileName)}`);
    const { wait } = await session.quickestWait();
    const request = { url, fileName, ...size, wait, camera: this.#cameras[0] };
    return session.visit(this.#peer, size, (page) => use(page, request), query.join(''));
  }
}
