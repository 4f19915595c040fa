// Looks at scenes that stream, and at what is drawn of their leaves as parts come and go.
import { expect } from 'vitest';
import type { SplatCloud } from '../clouds/splat-cloud.ts';
import type { StreamContext } from '../clouds/stream-budget.ts';
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

/** Less than what bounds have that are in no frustum. */
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

/** What a scene streams with, apart from the engine. */
export function streamContext(device: GPUDevice): StreamContext {
  return {
    device,
    memory: new GpuMemory(device),
    pipelines: new Pipelines(device),
    dispatchRow: 7,
    shares: { sharers: new Set(), turn: Promise.resolve() },
  };
}

/** A scene whose splats have the number of their leaf and level in place of their rows. */
export function numbered(
  scene: LeafScene,
  numberOf: (leaf: SceneLeaf, level: LeafLevel) => number,
): LeafScene {
  const read: LeafScene['read'] = async (file, signal) => {
    const decoded = await scene.read(file, signal);
    return {
      pieces: async (leaf, level, pieceSignal) => {
        const pieces = await decoded.pieces(leaf, level, pieceSignal);
        return pieces.map((piece) => ({ ...piece, rows: piece.rows.map(() => numberOf(leaf, level)) }));
      },
    };
  };
  return { ...scene, read };
}

/** A `numbered` scene, by ten times its leaf and the level. */
export function byLevel(scene: LeafScene): LeafScene {
  return numbered(scene, (leaf, level) => 10 * scene.leaves.indexOf(leaf) + leaf.levels.indexOf(level));
}

/** Expects all leaves of a scene `byLevel`, each at one level, as a whole; returns the cut as text. */
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

/** The numbers of a `numbered` scene of the chunks that are in sight for the CPU. */
function shownNumbers(cloud: SplatCloud): number[] {
  const words = new Float32Array(cloud.chunks);
  const chunkCount = words.length / CHUNK_WORDS.count;
  return Array.from({ length: chunkCount }, (_, chunk) => chunk)
    .filter((chunk) => words[CHUNK_WORDS.count * chunk + CHUNK_WORDS.minPosition] < NOWHERE)
    .map((chunk) => cloud.fileIndices[CHUNK_SPLATS * chunk]);
}

/** Expects CPU and GPU to show the same of a `numbered` scene, and returns its numbers. */
export async function expectShown(device: GPUDevice, cloud: SplatCloud): Promise<number[]> {
  const { when, give } = signalOf();
  cloud.stream!.hold(when);
  const drawn = await drawnNumbers(device, cloud);
  expect(drawn.sort()).toEqual(shownNumbers(cloud).sort());
  give();
  return drawn;
}

/**
 * Holds the numbers of a `numbered` scene that are in sight for the CPU against `expectCut`, each
 * time that they have changed. Returns a function that tells how often that was.
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
      // Parts of one change are no moments.
      queueMicrotask(() => {
        moments++;
        expectCut(shownNumbers(cloud), `version ${version}`);
      });
    },
  });
  return () => moments;
}

/** The same of the chunks that the GPU draws. */
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
 * Looks at a `numbered` scene from here and there, before all has come or after, and holds what CPU
 * and GPU show at each moment against `expectCut`, which returns the cut as text. Destroys the cloud.
 *
 * @param reach positions are within it of 0, along each axis.
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
  for (let step = 0; step < steps; step++) {
    const position = [0, 1, 2].map(() => 2 * reach * random() - reach) as [number, number, number];
    const detail = random() < 0.2 ? 'full' : { maxErrorPx: 10 ** (2 * random() - 0.5) };
    view.render({ camera: lookFrom(position), clouds: [{ cloud }], ...SIZE, detail });
    // Some steps are taken before all is there.
    if (random() < 0.6) await view.whenComplete();
    else for (let turn = 0; turn < 20 * random(); turn++) await nextTask();
    seen.add(expectCut(await expectShown(engine.device, cloud), `step ${step}`));
  }
  expect(seen.size).toBeGreaterThan(8);
  expect(moments()).toBeGreaterThan(25);
  view.destroy();
  cloud.destroy();
}
