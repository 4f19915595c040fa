import { basename } from 'node:path';
import type { PeerFormats } from '../adapter.ts';
import type { LoadRequest, MeasureRequest, Picture } from '../page/protocol.ts';
import type { BenchSetup, PageBench } from '../runner/bench.ts';
import type { BuiltPeer } from '../runner/built-pages.ts';
import { filesOf } from '../runner/evidence.ts';
import type { SizePx } from '../runner/options.ts';
import { choosePeers } from '../runner/peer-list.ts';
import { drawReferences, psnrOf } from '../runner/pictures.ts';
import { type BenchScene, readScene, type SceneFormat, sceneFiles } from '../runner/scenes.ts';
import { inSession, type Session } from '../runner/session.ts';
import type { OpenPage } from '../runner/visit.ts';
import { type FramesOptions, readOptions, USAGE } from './options.ts';
import type { Report, Row, SceneReport } from './report.ts';
import { reportLegend, reportParts, reportText } from './table.ts';

/** Frames and loads of scenes that are loaded as a whole. */
const bench: PageBench<FramesOptions> = {
  script: 'bench:peers',
  usage: USAGE,
  readOptions,
  choose: ({ peers, sourcesFolder }, folder) => choosePeers(peers, folder, sourcesFolder),
  async measure(options, peers, setup) {
    const report = await measurePeers(options, peers, setup);
    return {
      text: reportText(report),
      files: filesOf(options, report, reportParts(report), reportLegend(report)),
      hasFailures: report.scenes.some(({ rows }) => rows.some(({ failures }) => failures.length > 0)),
    };
  },
};
export default bench;

async function measurePeers(
  options: FramesOptions,
  peers: readonly BuiltPeer[],
  setup: BenchSetup,
): Promise<Report> {
  const { camerasFile, size, pictureSize, jumps, isFromFile, isLoads } = options;
  const files = await sceneFiles(options, setup.workFolder);
  const addresses = files.map((file, i) => `scenes/${i}/${encodeURIComponent(basename(file))}`);
  const served = Object.fromEntries(addresses.map((address, i) => [address, files[i]]));
  return inSession(options, setup, { files: served }, async (session) => {
    const formatsOf = new Map<BuiltPeer, PeerFormats>();
    const scenes: SceneReport[] = [];
    for (const [i, file] of files.entries()) {
      session.say(`${file}: reading …`);
      const scene = await readScene(file, camerasFile);
      const measured = new MeasuredScene(
        options,
        scene,
        session.urlOf(addresses[i]),
        peers,
        session,
        formatsOf,
      );
      await session.quickestWait();
      if (options.takesPictures) await measured.takePictures();
      await session.inRounds(measured.peers, (peer, round) => measured.measure(peer, round));
      const { name, format, fileBytes, splats, shDegree } = scene;
      const rows = measured.peers.map(({ row }) => row);
      scenes.push({ scene: name, format, fileBytes, splats, shDegree, rows });
    }
    return {
      isFromFile,
      isLoads,
      ...size,
      pictureWidthPx: pictureSize.widthPx,
      pictureHeightPx: pictureSize.heightPx,
      jumps,
      scenes,
    };
  });
}

interface MeasuredPeer {
  readonly peer: BuiltPeer;
  readonly row: Row;
}

/** All peers with one scene. */
class MeasuredScene {
  readonly peers: readonly MeasuredPeer[];
  readonly #options: FramesOptions;
  readonly #scene: BenchScene;
  readonly #sceneUrl: string;
  readonly #session: Session;
  /** Formats that peers read, as far as their pages have been opened. */
  readonly #formatsOf: Map<BuiltPeer, PeerFormats>;

  constructor(
    options: FramesOptions,
    scene: BenchScene,
    sceneUrl: string,
    peers: readonly BuiltPeer[],
    session: Session,
    formatsOf: Map<BuiltPeer, PeerFormats>,
  ) {
    this.peers = peers.map((peer) => {
      const { name, isFloor, version } = peer;
      const row = { peer: name, isFloor, version, isReader: true, rounds: [], pictures: [], failures: [] };
      return { peer, row };
    });
    this.#options = options;
    this.#scene = scene;
    this.#sceneUrl = sceneUrl;
    this.#session = session;
    this.#formatsOf = formatsOf;
  }

  /** Runs first, so that missing splats show before times. Threads draw in float64 meanwhile. */
  async takePictures(): Promise<void> {
    const { pictureSize } = this.#options;
    const takeAll = async () => {
      const taken: Picture[][] = [];
      for (const peer of this.peers) taken.push(peer.peer.isFloor ? [] : await this.#take(peer));
      return taken;
    };
    const [references, taken] = await Promise.all([drawReferences(this.#scene, pictureSize), takeAll()]);
    for (const [i, { row }] of this.peers.entries())
      for (const [view, picture] of taken[i].entries())
        row.pictures.push({ camera: picture.camera, psnrDb: psnrOf(picture, references[view]) });
  }

  async #take(measured: MeasuredPeer): Promise<Picture[]> {
    const { pictureSize } = this.#options;
    const { name, cameras } = this.#scene;
    const pictures = await this.#attempt(measured, 'pictures', async () => {
      const found = await this.#visitReader(measured, pictureSize, async (page) => {
        await page.load(await this.#request(pictureSize));
        return page.pictures(cameras);
      });
      await this.#session.keep(found ?? [], `${name}.${measured.row.peer}`);
      return found;
    });
    return pictures ?? [];
  }

  async measure(measured: MeasuredPeer, round: number): Promise<void> {
    const { size, isLoads } = this.#options;
    const found = await this.#attempt(measured, `round ${round + 1}`, () =>
      this.#visitReader(measured, size, async (page) => ({
        round,
        loaded: await this.#loadTimed(page),
        measured: isLoads ? null : await page.measure(this.#measureRequest),
        state: await page.state(),
        heap: await page.heap(),
      })),
    );
    if (found) measured.row.rounds.push(found);
  }

  #attempt<Result>({ row }: MeasuredPeer, what: string, work: () => Promise<Result>): Promise<Result | null> {
    return this.#session.attempt(row, what, work, this.#scene.name);
  }

  /** Visits a peer's page; notes a peer that does not read the format, and resolves with null. */
  async #visitReader<Result>(
    { peer, row }: MeasuredPeer,
    size: SizePx,
    use: (page: OpenPage) => Promise<Result>,
  ): Promise<Result | null> {
    const isReader = (formats: PeerFormats) => {
      row.isReader = isReadBy(formats, this.#scene.format);
      return row.isReader;
    };
    const known = this.#formatsOf.get(peer);
    if (known && !isReader(known)) return null;
    return this.#session.visit(peer, size, async (page) => {
      const formats = known ?? (await page.formats());
      this.#formatsOf.set(peer, formats);
      return isReader(formats) ? use(page) : null;
    });
  }

  async #loadTimed(page: OpenPage) {
    const { size, isFromFile } = this.#options;
    const request = await this.#request(size);
    if (!isFromFile) return page.load(request);
    await page.giveFile(this.#scene.file);
    return page.load({ ...request, url: null });
  }

  async #request(size: SizePx): Promise<LoadRequest> {
    const { file, cameras } = this.#scene;
    const { wait } = await this.#session.quickestWait();
    return { url: this.#sceneUrl, fileName: basename(file), ...size, wait, camera: cameras[0] };
  }

  get #measureRequest(): MeasureRequest {
    const { frames, warmUpFrames, jumps, isByPass } = this.#options;
    return { camera: this.#scene.cameras[0], frames, warmUpFrames, jumps, isByPass };
  }
}

/** Whether a peer that reads `formats` reads `format`. */
export function isReadBy(formats: PeerFormats, { name, variant }: SceneFormat): boolean {
  return formats === 'any' || formats.includes(name) || formats.includes(`${name} ${variant}`);
}
