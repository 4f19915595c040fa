import { mkdir, writeFile } from 'node:fs/promises';
import { basename, join } from 'node:path';
import { serveFiles } from '@websplatter/tools/file-server';
import type { PeerFormats } from '../adapter.ts';
import { WAITS, type Wait } from '../page/completion.ts';
import type { Loaded, LoadRequest, MeasureRequest, Picture } from '../page/protocol.ts';
import type { BenchSetup, SizePx } from './bench-definition.ts';
import { BLANK_PAGE, type BuiltPeer } from './built-pages.ts';
import { machineOf, PAGE_HEADERS } from './machine.ts';
import type { BenchOptions } from './options.ts';
import { isReadBy } from './peer-formats.ts';
import { psnrOf } from './picture-error.ts';
import { quickestWait } from './quickest-wait.ts';
import { drawReferences } from './references.ts';
import type { Report, Row, SceneReport } from './report.ts';
import { type BenchScene, readScene, sceneFiles } from './scenes.ts';
import { type OpenPage, Visitor } from './visit.ts';

/**
 * Measures `peers` with all scenes.
 *
 * @throws BenchError if a scene cannot be read.
 */
export async function measurePeers(
  options: BenchOptions,
  peers: readonly BuiltPeer[],
  setup: BenchSetup,
): Promise<Report> {
  const { size, pictureSize, frames, jumps, timeLimitMs, budgetMs, isSoftware, isFromFile, isLoads } =
    options;
  const { executablePath, commandLine, pages, pagesFolder, workFolder, say } = setup;
  const files = await sceneFiles(options, workFolder);
  const addresses = files.map((file, i) => `scenes/${i}/${encodeURIComponent(basename(file))}`);
  const server = await serveFiles(pagesFolder, {
    files: Object.fromEntries(addresses.map((address, i) => [address, files[i]])),
    headers: PAGE_HEADERS,
  });
  const visitor = new Visitor({
    executablePath,
    usesGpu: !isSoftware,
    timeLimitMs,
    deadlineMs: performance.now() + budgetMs,
    blankUrl: server.url + BLANK_PAGE,
  });
  try {
    const formatsOf = new Map<BuiltPeer, PeerFormats>();
    const pageOf = ({ page }: BuiltPeer) => server.url + page;
    let adapter: string | null = null;
    let wait: Wait = WAITS[0];
    const scenes: SceneReport[] = [];
    for (const [i, file] of files.entries()) {
      say(`${file}: reading …`);
      const scene = await readScene(file, options.camerasFile);
      const sceneUrl = server.url + addresses[i];
      const bench = new SceneBench(options, scene, sceneUrl, visitor, pageOf, formatsOf, say);
      if (i === 0) ({ wait, adapter } = await quickestWait(visitor, pageOf(pages.floor), options, say));
      const rows = peers.map(emptyRow);
      if (options.takesPictures) await bench.takePictures(rows, peers, wait);
      await bench.measure(rows, peers, wait);
      const { name, format, fileBytes, splats, shDegree } = scene;
      scenes.push({ scene: name, format, fileBytes, splats, shDegree, rows });
    }
    return {
      date: new Date().toISOString(),
      command: [commandLine.name, ...commandLine.args].join(' '),
      commit: pages.commit,
      ...machineOf(executablePath),
      adapter,
      wait,
      isFromFile,
      isLoads,
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

function emptyRow({ name, isFloor, version }: BuiltPeer): Row {
  return { peer: name, isFloor, version, isReader: true, rounds: [], pictures: [], failures: [] };
}

/** All peers with one scene. */
class SceneBench {
  readonly #options: BenchOptions;
  readonly #scene: BenchScene;
  readonly #sceneUrl: string;
  readonly #visitor: Visitor;
  readonly #pageOf: (peer: BuiltPeer) => string;
  /** Formats that peers read, as their pages have said so far. */
  readonly #formatsOf: Map<BuiltPeer, PeerFormats>;
  readonly #say: (line: string) => void;

  constructor(
    options: BenchOptions,
    scene: BenchScene,
    sceneUrl: string,
    visitor: Visitor,
    pageOf: (peer: BuiltPeer) => string,
    formatsOf: Map<BuiltPeer, PeerFormats>,
    say: (line: string) => void,
  ) {
    this.#options = options;
    this.#scene = scene;
    this.#sceneUrl = sceneUrl;
    this.#visitor = visitor;
    this.#pageOf = pageOf;
    this.#formatsOf = formatsOf;
    this.#say = say;
  }

  /** Runs first, so that missing splats show before times. Threads draw in float64 meanwhile. */
  async takePictures(rows: readonly Row[], peers: readonly BuiltPeer[], wait: Wait): Promise<void> {
    const { pictureSize } = this.#options;
    const { cameras } = this.#scene;
    const taken: Picture[][] = rows.map(() => []);
    const takeAll = async () => {
      for (const [i, peer] of peers.entries()) {
        if (peer.isFloor) continue;
        await this.#try(rows[i], 'pictures', async () => {
          const use = async (page: OpenPage) => {
            await page.load(this.#load(pictureSize, wait));
            return page.pictures(cameras);
          };
          taken[i] = (await this.#visitReader(rows[i], peer, pictureSize, use)) ?? [];
          await this.#keep(taken[i], peer);
        });
      }
    };
    const [references] = await Promise.all([drawReferences(this.#scene, pictureSize), takeAll()]);
    for (const [i, { pictures }] of rows.entries())
      for (const [view, picture] of taken[i].entries())
        pictures.push({ camera: picture.camera, psnrDb: psnrOf(picture, references[view]) });
  }

  async #keep(pictures: readonly Picture[], peer: BuiltPeer): Promise<void> {
    const { outFolder } = this.#options;
    if (!outFolder) return;
    await mkdir(outFolder, { recursive: true });
    for (const { camera, pngBase64 } of pictures) {
      const file = `${this.#scene.name}.${peer.name}.${camera}.png`.replace(/[^\w.-]/g, '_');
      await writeFile(join(outFolder, file), Buffer.from(pngBase64, 'base64'));
    }
  }

  /** Rounds forwards and back, so that a machine that slows down in a run meets all alike. */
  async measure(rows: readonly Row[], peers: readonly BuiltPeer[], wait: Wait): Promise<void> {
    const order = peers.map((_, i) => i);
    for (let round = 0; round < this.#options.rounds; round++) {
      for (const i of round % 2 === 0 ? order : order.toReversed()) {
        await this.#try(rows[i], `round ${round + 1}`, async () => {
          const { size, isLoads } = this.#options;
          const found = await this.#visitReader(rows[i], peers[i], size, async (page) => ({
            round,
            loaded: await this.#loadTimed(page, wait),
            measured: isLoads ? null : await page.measure(this.#measureRequest),
            state: await page.state(),
            heap: await page.heap(),
          }));
          if (found) rows[i].rounds.push(found);
        });
      }
    }
  }

  /** Visits a peer's page; notes a peer that does not read the format, and resolves with null. */
  async #visitReader<Result>(
    row: Row,
    peer: BuiltPeer,
    size: SizePx,
    use: (page: OpenPage) => Promise<Result>,
  ): Promise<Result | null> {
    const isReader = (formats: PeerFormats) => {
      row.isReader = isReadBy(formats, this.#scene.format);
      return row.isReader;
    };
    const known = this.#formatsOf.get(peer);
    if (known && !isReader(known)) return null;
    return this.#visitor.visit(this.#pageOf(peer), size, async (page) => {
      const formats = known ?? (await page.formats());
      this.#formatsOf.set(peer, formats);
      return isReader(formats) ? use(page) : null;
    });
  }

  async #try(row: Row, what: string, work: () => Promise<void>): Promise<void> {
    const startedMs = performance.now();
    const label = `${this.#scene.name}, ${row.peer}, ${what}`;
    try {
      await work();
      this.#say(`${label}: ${((performance.now() - startedMs) / 1000).toFixed(1)} s`);
    } catch (error) {
      const { message } = error as Error;
      row.failures.push(`${what}: ${message}`);
      this.#say(`${label}: FAILED: ${message}`);
    }
  }

  async #loadTimed(page: OpenPage, wait: Wait): Promise<Loaded> {
    const { size, isFromFile } = this.#options;
    const request = this.#load(size, wait);
    if (!isFromFile) return page.load(request);
    await page.giveFile(this.#scene.file);
    return page.load({ ...request, url: null });
  }

  #load(size: SizePx, wait: Wait): LoadRequest {
    const { file, cameras } = this.#scene;
    return { url: this.#sceneUrl, fileName: basename(file), ...size, wait, camera: cameras[0] };
  }

  get #measureRequest(): MeasureRequest {
    const { frames, warmUpFrames, jumps } = this.#options;
    return { camera: this.#scene.cameras[0], frames, warmUpFrames, jumps };
  }
}
