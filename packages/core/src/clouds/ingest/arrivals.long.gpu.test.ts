// Proves: the arrived part of a file is drawn, picked and freed.
import { gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import { beforeAll, describe, expect } from 'vitest';
import { createEngine, type SplatEngine } from '../../create-engine.ts';
import { perspectiveCamera } from '../../data/camera/camera.ts';
import { DestroyedError, SplatFileError, SplatSourceError } from '../../data/errors.ts';
import { encodePly } from '../../io/formats/ply/write-ply.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { reportedErrors } from '../../testing/reported-errors.ts';
import { signalOf } from '../../testing/signal.ts';
import type { SplatView } from '../../views/splat-view.ts';
import type { SplatCloud } from '../splat-cloud.ts';

const SIZE = { widthPx: 48, heightPx: 48 };
const LENS = {
  target: [0, 0, 0],
  up: [0, 1, 0],
  fovYDegrees: 50,
  near: 0.1,
  far: 100,
  aspect: 1,
} as const;
const CAMERA = perspectiveCamera({ ...LENS, position: [0, 0, 6] });

let device: GPUDevice;
let engine: SplatEngine;
let view: SplatView;
beforeAll(async () => {
  device = await shareTestDevice();
  // A frame in parts is given up when the next preview takes the place of its own.
  engine = await createEngine({ device, submissionBudgetMs: Number.POSITIVE_INFINITY }, { ingestMinRows: 1 });
  view = engine.createView();
});

/** A file of which `firstBytes` can be read at once, and the rest after `go`. */
function slowFile(bytes: Uint8Array<ArrayBuffer>, firstBytes: number, go: Promise<void>): Blob {
  return fileInParts(bytes, [[firstBytes, go]]);
}

/** A file that stops at each of these bytes until a promise resolves. */
function fileInParts(
  bytes: Uint8Array<ArrayBuffer>,
  stops: readonly (readonly [byte: number, go: Promise<void>])[],
): Blob {
  const stream = () =>
    new ReadableStream<Uint8Array<ArrayBuffer>>({
      async start(controller) {
        let at = 0;
        for (const [byte, go] of stops) {
          controller.enqueue(bytes.slice(at, byte));
          at = byte;
          await go;
        }
        controller.enqueue(bytes.slice(at));
        controller.close();
      },
    });
  return { size: bytes.length, stream } as unknown as Blob;
}

async function draw(cloud: SplatCloud): Promise<Float32Array> {
  view.render({ camera: CAMERA, clouds: [{ cloud }], ...SIZE });
  return (await view.readPixels()).data;
}

function greatestDifference(a: Float32Array, b: Float32Array): number {
  return a.reduce((most, value, i) => Math.max(most, Math.abs(value - b[i])), 0);
}

const COUNT = 40_000;
/** More than one piece. */
const SET = randomSplats({ count: COUNT, seed: 3, shDegree: 3 });
const FILE = encodePly(SET);

describe('while a file arrives', () => {
  gpuTest('the splats that have arrived can be drawn, and look as they do', async () => {
    const before = engine.memory().totalBytes;
    const rest = signalOf();
    const counts: number[] = [];
    let early: { cloud: SplatCloud; pixels: Promise<Float32Array> } | null = null;
    const previews: SplatCloud[] = [];
    const cloud = await engine.load(slowFile(FILE, 0.6 * FILE.length, rest.when), {
      name: 'slow',
      onPreview: (preview) => {
        for (const earlier of previews.slice(0, -1)) expect(earlier.isDestroyed).toBe(true);
        previews.push(preview);
        counts.push(preview.count);
        expect(preview.isPreview).toBe(true);
        if (early) return;
        const pixels = draw(preview);
        // A later preview may take its place before it is drawn, and in its picture: that one is compared then.
        const take = () => {
          if (preview !== previews.at(-1)) return;
          early ??= { cloud: preview, pixels };
          rest.give();
        };
        pixels.then(take, take);
      },
    });
    const { cloud: first, pixels } = early!;
    expect(first.count).toBeLessThan(0.6 * COUNT);
    expect(first.count).toBeGreaterThan(1000);
    expect(counts).toEqual(counts.toSorted((a, b) => a - b));
    expect(counts.at(-1)).toBe(COUNT);

    const only = engine.add(firstSplats(first.count));
    expect(first.bounds).toEqual(only.bounds);
    // Sizes are rounded to 2⁻⁹ of a logarithm until the range of all is known.
    expect(greatestDifference(await pixels, await draw(only))).toBeLessThan(0.02);
    only.destroy();

    expect(new Float32Array(first.chunks)).toHaveLength(8 * Math.ceil(first.count / 256));
    // The last one has the order, and all, of the cloud itself.
    const last = previews.at(-1)!;
    expect(last.isDestroyed).toBe(false);
    expect(await draw(last)).toEqual(await draw(cloud));
    expect(last.bytes).toBe(0);
    expect(engine.memory().totalBytes - cloud.bytes).toBeGreaterThanOrEqual(before);
    cloud.destroy();
    expect(previews.every(({ isDestroyed }) => isDestroyed)).toBe(true);
    expect(() => view.render({ camera: CAMERA, clouds: [{ cloud: last }], ...SIZE })).toThrow(DestroyedError);
  });

  gpuTest('rows that come right after a preview are shown, too, though none follow', async () => {
    const [second, rest] = [signalOf(), signalOf()];
    const counts: number[] = [];
    const file = fileInParts(FILE, [
      // A piece, and another.
      [Math.floor(0.5 * FILE.length), second.when],
      [Math.floor(0.9 * FILE.length), rest.when],
    ]);
    const cloud = await engine.load(file, {
      onPreview: ({ count }) => {
        counts.push(count);
        // The rest comes only after more has been shown.
        if (counts.length === 1) second.give();
        else rest.give();
      },
    });
    expect(counts[0]).toBeLessThan(0.5 * COUNT);
    expect(counts[1]).toBeGreaterThan(1.25 * counts[0]);
    expect(counts[1]).toBeLessThan(0.9 * COUNT);
    cloud.destroy();
  });

  gpuTest('splats that cannot be drawn leave no trace', async () => {
    const set = { ...SET, positions: SET.positions.slice() };
    for (let i = 0; i < COUNT; i += 2) set.positions[3 * i + 1] = Number.NaN;
    const file = encodePly(set);
    const rest = signalOf();
    let early: Promise<Float32Array> | null = null;
    let firstCount = 0;
    const cloud = await engine.load(slowFile(file, 0.6 * file.length, rest.when), {
      onPreview: (preview) => {
        if (early) return;
        firstCount = preview.count;
        expect(preview.dropped).toEqual({ 'non-finite-position': preview.count / 2 });
        early = draw(preview);
        void early.then(rest.give, rest.give);
      },
    });
    const only = engine.add({
      ...firstSplats(firstCount),
      positions: set.positions.slice(0, 3 * firstCount),
    });
    expect(greatestDifference((await early)!, await draw(only))).toBeLessThan(0.02);
    only.destroy();
    cloud.destroy();
  });

  for (const drawn of ['the first', 'every'] as const) {
    gpuTest(
      `picks find splats of the finished cloud where ${drawn} preview was drawn, and none of a preview, whose rows are unknown`,
      async () => {
        const rest = signalOf();
        const middle = SIZE.widthPx / 2;
        const picks: Promise<unknown>[] = [];
        const cloud = await engine.load(slowFile(FILE, 0.6 * FILE.length, rest.when), {
          onPreview: (preview) => {
            if (drawn === 'the first' && picks.length > 0) return;
            const pick = draw(preview).then(() => view.pick(middle, middle));
            picks.push(pick);
            void pick.then(rest.give, rest.give);
          },
        });
        expect(await Promise.all(picks)).toEqual(picks.map(() => null));
        // The last preview has the same planes, and looks the same.
        await draw(cloud);
        const pick = await view.pick(middle, middle);
        expect(pick?.cloud === cloud).toBe(true);
        expect(pick!.row).toBeGreaterThanOrEqual(0);
        cloud.destroy();
      },
    );
  }

  gpuTest(
    'a view inside of another frame keeps its image while what follows needs other shaders',
    async () => {
      const set = {
        ...SET,
        // The first to arrive are balls, for which shaders ignore rotations.
        logScales: SET.logScales.map((value, i) => (i < 2.1 * COUNT ? SET.logScales[i - (i % 3)] : value)),
      };
      const file = encodePly(set);
      // One that has compiled nothing yet.
      const other = await createEngine({ device }, { ingestMinRows: 1 });
      const embedded = other.createEmbeddedView();
      const prepare = (cloud: SplatCloud) =>
        embedded.prepare({ camera: CAMERA, clouds: [{ cloud }], ...SIZE });
      // More previews may come while the first one's shaders compile, and destroy it.
      let latest: SplatCloud;
      const previewPrepared = async () => {
        const { when, give } = signalOf();
        embedded.onReady = give;
        if (!prepare(latest)) await when;
        expect(prepare(latest)).toBe(true);
      };
      const rest = signalOf();
      let early: Promise<void> | null = null;
      const cloud = await other.load(slowFile(file, 0.6 * file.length, rest.when), {
        onPreview: (preview) => {
          latest = preview;
          early ??= previewPrepared().finally(rest.give);
        },
      });
      await early;
      const { framesPrepared } = other.counters();
      const { when, give } = signalOf();
      embedded.onReady = give;
      expect(prepare(cloud)).toBe(true);
      expect(other.counters().framesPrepared, 'while shaders compile').toBe(framesPrepared);
      await when;
      expect(prepare(cloud)).toBe(true);
      expect(other.counters().framesPrepared).toBe(framesPrepared + 1);
      other.destroy();
    },
  );

  gpuTest('a preview cannot be given another precision', async () => {
    let asked: Promise<unknown> | undefined;
    const cloud = await engine.load(new Blob([FILE]), {
      name: 'part.ply',
      onPreview: (preview) => {
        asked ??= engine
          .requestPrecision(preview, { geometryPrecision: 'f32', shPrecision: 'f32' })
          .catch((error: Error) => error);
      },
    });
    const error = await asked;
    expect(error).toBeInstanceOf(SplatSourceError);
    expect((error as Error).message).toMatch(/part\.ply.*still loading/);
    cloud.destroy();
  });

  gpuTest('while the planes change, frames keep the image', async () => {
    const rest = signalOf();
    let before: Promise<Float32Array> | null = null;
    let held: Promise<Float32Array> | null = null;
    const cloud = await engine.load(slowFileWhole(rest.when), {
      onPreview: (preview) => {
        if (before) return;
        before = draw(preview).then((image) => {
          preview.holdImage(new Promise(() => {}));
          const { framesDrawn } = engine.counters();
          const moved = perspectiveCamera({ ...LENS, position: [1, 0, 5] });
          view.render({ camera: moved, clouds: [{ cloud: preview }], ...SIZE, force: true });
          expect(engine.counters().framesDrawn).toBe(framesDrawn);
          held = view.readPixels().then(({ data }) => data as Float32Array);
          void held.then(rest.give, rest.give);
          return image;
        });
        before.catch(rest.give);
      },
    });
    expect(await held).toEqual(await before);
    cloud.destroy();
  });

  for (const [what, file] of [
    ['is cut off', slowFileCutOff],
    ['is aborted', slowFileWhole],
  ] as const) {
    gpuTest(`a load that ${what} takes its previews with it`, async () => {
      const before = engine.memory().totalBytes;
      const stop = new AbortController();
      const rest = signalOf();
      let last: SplatCloud | null = null;
      const load = engine.load(file(rest.when), {
        name: 'cut.ply',
        signal: stop.signal,
        onPreview: (preview) => {
          last = preview;
          if (what === 'is aborted') stop.abort(new Error('enough'));
          rest.give();
        },
      });
      await expect(load).rejects.toThrow(what === 'is aborted' ? 'enough' : SplatFileError);
      expect(last!.isDestroyed).toBe(true);
      expect(engine.memory().totalBytes).toBe(before);
    });
  }

  gpuTest('an error of the callback is reported, and the load goes on', async () => {
    const before = engine.memory().totalBytes;
    const seen: SplatCloud[] = [];
    const reported = reportedErrors();
    const load = engine.load(new Blob([FILE]), {
      onPreview: (preview) => {
        seen.push(preview);
        throw new Error('no room on the screen');
      },
    });
    const cloud = await load;
    expect(reported.length).toBe(seen.length);
    expect(reported[0]).toMatchObject({ message: 'no room on the screen' });
    expect(cloud.isDestroyed).toBe(false);
    cloud.destroy();
    expect(seen.every(({ isDestroyed }) => isDestroyed)).toBe(true);
    expect(engine.memory().totalBytes).toBe(before);
  });
});

function firstSplats(count: number): typeof SET {
  return {
    ...SET,
    count,
    positions: SET.positions.subarray(0, 3 * count),
    logScales: SET.logScales.subarray(0, 3 * count),
    rotations: SET.rotations.subarray(0, 4 * count),
    opacityLogits: SET.opacityLogits.subarray(0, count),
    colorDc: SET.colorDc.subarray(0, 3 * count),
    harmonics: { ...SET.harmonics, coefficients: SET.harmonics.coefficients.subarray(0, 45 * count) },
  };
}

function slowFileWhole(go: Promise<void>): Blob {
  return slowFile(FILE, 0.6 * FILE.length, go);
}

/** Says that it is as large as the whole. */
function slowFileCutOff(go: Promise<void>): Blob {
  const cut = FILE.slice(0, 0.9 * FILE.length);
  const { stream } = slowFile(cut, 0.6 * FILE.length, go);
  return { size: FILE.length, stream } as unknown as Blob;
}
