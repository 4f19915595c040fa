// A page that keeps and streams scenes, driven by tests.
import { perspectiveCamera, SplatEngine, type SplatSource } from '@websplatter/core';
import { type KeepOptions, keepBricks, keptBricks, keptScenes, removeKept } from '@websplatter/core/keep';

const SIZE = { widthPx: 48, heightPx: 32 };
const camera = perspectiveCamera({
  position: [1, 2, 5],
  target: [1, 1, 0],
  fovYDegrees: 50,
  aspect: SIZE.widthPx / SIZE.heightPx,
});

const hex = (digest: ArrayBuffer) => Array.from(new Uint8Array(digest), (byte) => byte.toString(16)).join();
const sha256 = async (bytes: BufferSource) => hex(await crypto.subtle.digest('SHA-256', bytes));

/** The file at an address, as a page has it of a server or a disk. */
async function fetchFile(address: string, lastModified = 1e12): Promise<File> {
  return new File([await (await fetch(address)).blob()], 'large.ply', { lastModified });
}

/** Loads a scene in an engine of its own. */
async function load(source: SplatSource, options: Parameters<SplatEngine['load']>[1] = {}) {
  const engine = await SplatEngine.create({ accuracy: { rasterizer: 'quads' } });
  const cloud = await engine.load(source, options);
  const view = engine.createView();
  view.render({ camera, clouds: [{ cloud }], ...SIZE });
  return { engine, cloud, view };
}

type Shown = Awaited<ReturnType<typeof load>>;

/** A hash of the picture with what is there. */
async function pictureNow({ view }: Shown): Promise<string> {
  return sha256((await view.readPixels()).data as Float32Array<ArrayBuffer>);
}

/** A hash of the picture once all is there that it needs, or an error has ended fetching. */
async function picture(shown: Shown): Promise<string> {
  await shown.view.whenComplete();
  return pictureNow(shown);
}

const keeping = {
  /** Fractions of the work that `keep` has told. */
  parts: [] as number[],
  /** A scene that a test comes back to. */
  shown: null as Shown | null,
  fetchFile,
  load,
  picture,
  pictureNow,
  reportOf: ({ cloud }: Shown) => {
    const report = cloud.stream!.report();
    return { ...report, error: report.error?.name ?? null };
  },
  keptBricks,
  keptScenes,
  removeKept,
  keep: (file: File, options: KeepOptions = {}) =>
    keepBricks(file, { onProgress: (part) => keeping.parts.push(part), ...options }),
  hashOf: async (file: Blob) => sha256(await file.arrayBuffer()),
};

declare global {
  interface Window {
    keeping: typeof keeping;
  }
}

window.keeping = keeping;
