// Draws streamed scenes in leaves, and checks which level of each leaf is drawn as parts are fetched
// and evicted.
import { expect } from 'vitest';
import type { SplatCloud } from '../clouds/splat-cloud.ts';
import type { StreamContext } from '../clouds/stream/stream-budget.ts';
import type { SplatEngine } from '../create-engine.ts';
import type { LeafLevel, LeafScene, SceneLeaf } from '../data/bricks/leaf-scene.ts';
import { perspectiveCamera } from '../data/camera/camera.ts';
import { CHUNK_WORDS } from '../data/layout/chunk-words.ts';
import { CHUNK_SPLATS } from '../data/layout/constants.ts';
import { ChunkLinks, LevelCell } from '../data/layout/level-structs.ts';
import type { Vec3 } from '../data/math/mat4.ts';
import { nextTask } from '../data/turns.ts';
import { GpuMemory } from '../gpu/gpu-memory.ts';
import { Pipelines } from '../gpu/pipelines.ts';
import { readWords } from '../gpu/read-buffer.ts';
import { seededRandom } from './seeded-random.ts';
import { signalOf } from './signal.ts';

/** Chunks and cells that are not drawn have bounds farther away than this. */
const NOWHERE = 1e17;

export const SIZE = { widthPx: 96, heightPx: 64 };

export function lookFrom(position: Vec3, target: Vec3 = [0, 0, 0]) {
  return perspectiveCamera({ position, target, up: [0, 1, 0], fovYDegrees: 40, aspect: 1.5 });
}

/** Draws a cloud until its picture is complete, in a view of its own. */
export async function drawComplete(
  engine: SplatEngine,
  cloud: SplatCloud,
  detail = {},
  camera = lookFrom([0, 0, 4]),
) {
  const view = engine.createView();
  view.render({ camera, clouds: [{ cloud }], ...SIZE, ...detail });
  await view.whenComplete();
  const { data } = await view.readPixels();
  const report = view.detail!;
  view.destroy();
  return { data, report };
}

/** A `StreamContext` without an engine. */
export function streamContext(device: GPUDevice): StreamContext {
  return {
    device,
    memory: new GpuMemory(device),
    pipelines: new Pipelines(device),
    dispatchRow: 7,
    shares: { sharers: new Set(), turn: Promise.resolve() },
  };
}

/** `scene` with a number of leaf and level as the row of each splat: `fileIndices` then name it. */
export function numbered(
  scene: LeafScene,
  numberOf: (leaf: SceneLeaf, level: LeafLevel) => number,
): LeafScene {
  const read: LeafScene['read'] = async (file, signal) => {
    const decoded = await scene.read(file, signal);
    return {
      pack: async (parts, packSignal) => {
        const packed = await decoded.pack(parts, packSignal);
        return packed.map((pieces, i) => {
          const number = numberOf(parts[i].leaf, parts[i].level);
          return pieces.map((piece) => ({ ...piece, fileIndices: piece.fileIndices.map(() => number) }));
        });
      },
    };
  };
  return { ...scene, read };
}

/** A `numbered` scene with the numbers 10·leaf + level. */
export function byLevel(scene: LeafScene): LeafScene {
  return numbered(scene, (leaf, level) => 10 * scene.leaves.indexOf(leaf) + leaf.levels.indexOf(level));
}

/** Expects each leaf of a scene `byLevel` to be complete at one level; returns the cut as text. */
export function expectOneLevel(scene: LeafScene, numbers: readonly number[], when: string): string {
  const shown = [...new Set(numbers)].sort((a, b) => a - b);
  expect(
    shown.map((number) => Math.floor(number / 10)),
    when,
  ).toEqual([...scene.leaves.keys()]);
  for (const number of shown) {
    const { count } = scene.leaves[Math.floor(number / 10)].levels[number % 10];
    expect(numbers.filter((each) => each === number).length, when).toBe(Math.ceil(count / CHUNK_SPLATS));
  }
  return shown.join();
}

/** The numbers, in a `numbered` scene, of the chunks that the CPU's bounds leave visible. */
function shownNumbers(cloud: SplatCloud): number[] {
  const words = new Float32Array(cloud.chunks);
  const chunkCount = words.length / CHUNK_WORDS.count;
  return Array.from({ length: chunkCount }, (_, chunk) => chunk)
    .filter((chunk) => words[CHUNK_WORDS.count * chunk + CHUNK_WORDS.minPosition] < NOWHERE)
    .map((chunk) => cloud.fileIndices[CHUNK_SPLATS * chunk]);
}

/** Expects the same chunks of a `numbered` scene on CPU and GPU, and returns their numbers. */
export async function expectShown(device: GPUDevice, cloud: SplatCloud): Promise<number[]> {
  const { when, give } = signalOf();
  cloud.stream!.deferUploads(when);
  const drawn = await drawnNumbers(device, cloud);
  expect(drawn.sort()).toEqual(shownNumbers(cloud).sort());
  give();
  return drawn;
}

/**
 * Calls `expectCut` with the visible numbers of a `numbered` scene after each change on the CPU.
 * Returns a function that returns the number of changes.
 */
export function watchCuts(
  cloud: SplatCloud,
  expectCut: (numbers: readonly number[], when: string) => void,
): () => number {
  let moments = 0;
  let { version } = cloud;
  Object.defineProperty(cloud, 'version', {
    get: () => version,
    set: (value: number) => {
      version = value;
      // A change takes several synchronous steps: check after the last.
      queueMicrotask(() => {
        moments++;
        expectCut(shownNumbers(cloud), `version ${version}`);
      });
    },
  });
  return () => moments;
}

/** The numbers, in a `numbered` scene, of the chunks that the GPU draws. */
async function drawnNumbers(device: GPUDevice, cloud: SplatCloud): Promise<number[]> {
  const levels = cloud.levels!;
  const ofPages = (pages: readonly GPUBuffer[]) => Promise.all(pages.map((page) => readWords(device, page)));
  const links = await ofPages(levels.splatLinks);
  const blobLinks = await ofPages(levels.blobPages.slice(0, -1).map((page) => page.links));
  const cellsOf = (pages: Uint32Array[]) =>
    pages.flatMap((words) => [...words].filter((_, i) => i % ChunkLinks.words === 0));
  expect(cellsOf(blobLinks)).toEqual(cellsOf(links));
  const cells = await readWords(device, levels.cells);
  const nearest = new Float32Array(cells.buffer);
  const cellWords = LevelCell.bytes / 4;
  return cellsOf(links).flatMap((cell, chunk) =>
    cell === chunk && nearest[cellWords * cell] < NOWHERE ? [cloud.fileIndices[CHUNK_SPLATS * chunk]] : [],
  );
}

/**
 * Draws a `numbered` scene from random positions, with and without waiting for parts, and calls
 * `expectCut` after each change with the numbers that CPU and GPU draw. Destroys the cloud.
 *
 * @param reach camera positions are within ±reach on each axis.
 * @param expectCut returns the cut as text.
 */
export async function expectCuts(
  engine: SplatEngine,
  cloud: SplatCloud,
  { steps, reach }: { readonly steps: number; readonly reach: number },
  expectCut: (numbers: readonly number[], when: string) => string,
): Promise<void> {
  const random = seededRandom(5);
  const moments = watchCuts(cloud, expectCut);
  const view = engine.createView();
  const seen = new Set<string>();
  // A busy machine may be late with parts: more steps then.
  for (let step = 0; step < steps || (seen.size <= 8 && step < 10 * steps); step++) {
    const position = [0, 1, 2].map(() => 2 * reach * random() - reach) as [number, number, number];
    const detail = random() < 0.2 ? 'full' : { maxErrorPx: 10 ** (2 * random() - 0.5) };
    view.render({ camera: lookFrom(position), clouds: [{ cloud }], ...SIZE, detail });
    // Other steps do not wait for all parts.
    if (random() < 0.6) await view.whenComplete();
    else for (let turn = 0; turn < 20 * random(); turn++) await nextTask();
    seen.add(expectCut(await expectShown(engine.device, cloud), `step ${step}`));
  }
  expect(seen.size).toBeGreaterThan(8);
  expect(moments()).toBeGreaterThan(25);
  view.destroy();
  cloud.destroy();
}
