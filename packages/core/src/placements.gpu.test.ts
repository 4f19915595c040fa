import { gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import { describe, expect, test } from 'vitest';
import type { SplatCloud } from './clouds/splat-cloud.ts';
import { SplatEngine } from './create-engine.ts';
import {
  type Camera,
  type LookAtOptions,
  orthographicCamera,
  perspectiveCamera,
} from './data/camera/camera.ts';
import { type Quaternion, rotationMatrixOf } from './data/editing/quaternion.ts';
import { type SplatTransform, transformSplats } from './data/editing/transform-splats.ts';
import { InvalidArgumentError } from './data/errors.ts';
import { identity4, type Mat4, multiply4, type Vec3 } from './data/math/mat4.ts';
import type { ShDegree, SplatSet } from './data/splats/splat-set.ts';
import type { CloudInstance } from './frame/plan/frame-request.ts';
import { WRITABLE_FORMATS } from './io/formats/writable-formats.ts';
import { writeSplats } from './io/formats/writers.ts';
import { readSplats } from './io/loading/read-splats.ts';
import { renderReference } from './reference/render.ts';
import { float64Picture, psnrOf, worldSplats } from './testing/float64-picture.ts';
import { type Choices, fuzz } from './testing/fuzz.ts';
import { glbBytes, gltfOf, splatAttributes } from './testing/gltf-fixture.ts';
import { byTiles } from './testing/preset-engines.ts';
import { randomSplats } from './testing/random-splats.ts';

const SIZE = { widthPx: 64, heightPx: 64 };
/** Of float64 on float64: what is left is the rounding of positions to float32 about an origin. */
const MIN_FLOAT64_DB = 110;
/** Of the GPU at its most exact: a pixel that rounding takes across the cutoff leaves 84 dB. */
const MIN_GPU_DB = 80;
/**
 * Of files of which nothing is said, however far away: 145, 145, 56, 54, 43 and 36 dB were the least
 * of 200, as near 0.
 */
const MIN_WRITTEN_DB: Readonly<Record<string, number>> = {
  ...{ ply: 110, gltf: 110 },
  ...{ bricks: 50, 'compressed-ply': 50, spz: 40, sog: 34 },
};
const FARTHEST = 1e7;

/** A link of a chain: a matrix, and what `transformSplats` calls it if it can do the same. */
interface Link {
  readonly matrix: Mat4;
  readonly transform?: SplatTransform;
}

/** Splats, and what moves them into the world: the last link first. */
interface Placement {
  readonly set: SplatSet;
  readonly links: readonly Link[];
  readonly matrix: Mat4;
  readonly camera: Camera;
}

const translation = (by: Vec3) => Float64Array.of(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, ...by, 1);

function linear([a, b, c, d, e, f, g, h, i]: ArrayLike<number> & Iterable<number>): Mat4 {
  return Float64Array.of(a, b, c, 0, d, e, f, 0, g, h, i, 0, 0, 0, 0, 1);
}

/** A move by up to 1e7, a turn, an even scale, or one that is uneven and may mirror. */
function randomLink(choices: Choices): Link {
  const signed = () => 2 * choices.next() - 1;
  const factor = () => 2 ** (1.5 * signed());
  const mirror = () => (choices.isTrue(0.25) ? -1 : 1);
  switch (choices.below(4)) {
    case 0: {
      const reach = FARTHEST ** choices.next();
      const by: Vec3 = [reach * signed(), reach * signed(), reach * signed()];
      return { matrix: translation(by), transform: { translation: by } };
    }
    case 1: {
      const rotation: Quaternion = [signed(), signed(), signed(), signed()];
      return { matrix: linear(rotationMatrixOf(rotation)), transform: { rotation } };
    }
    case 2: {
      const scale = factor();
      return { matrix: linear([scale, 0, 0, 0, scale, 0, 0, 0, scale]), transform: { scale } };
    }
    default: {
      const stretch = [mirror() * factor(), 0, 0, 0, mirror() * factor(), 0, 0, 0, mirror() * factor()];
      return { matrix: linear(stretch) };
    }
  }
}

function product(links: readonly Link[]): Mat4 {
  return links.reduce((matrix, link) => multiply4(matrix, link.matrix), identity4());
}

/** A random scene with a random chain of transforms, and a camera that sees it. */
function randomPlacement(choices: Choices): Placement {
  const set = randomSplats({
    count: 40,
    seed: choices.below(1e6),
    shDegree: choices.below(4) as ShDegree,
    halfExtent: 0.5,
    logScales: [-4, -2],
  });
  const links = Array.from({ length: 1 + choices.below(5) }, () => randomLink(choices));
  const matrix = product(links);
  // As far away as the largest stretch of the scene asks for.
  const size = Math.max(...[0, 4, 8].map((at) => Math.hypot(...matrix.subarray(at, at + 3))));
  const [x, y, z] = matrix.subarray(12);
  const direction = [choices.next() - 0.5, choices.next() - 0.5, choices.next() - 0.5];
  const distance = (3 * size) / Math.hypot(...direction);
  const look: LookAtOptions = {
    position: [x + distance * direction[0], y + distance * direction[1], z + distance * direction[2]],
    target: [x, y, z],
    aspect: 1,
    near: 0.01 * size,
    far: 1e9,
  };
  const camera = choices.isTrue(0.2)
    ? orthographicCamera({ ...look, height: 3 * size })
    : perspectiveCamera({ ...look, fovYDegrees: 50 });
  return { set, links, matrix, camera };
}

/** A glTF of the set, with a node for each link. */
function glbOf({ set, links }: Placement): Uint8Array<ArrayBuffer> {
  const { json, binary } = gltfOf(splatAttributes(set));
  json.nodes = links.map(({ matrix }, i) => ({
    matrix: [...matrix],
    ...(i === links.length - 1 ? { mesh: 0 } : { children: [i + 1] }),
  }));
  json.scenes = [{ nodes: [0] }];
  return glbBytes({ json, binary });
}

/** The set after one `transformSplats` for each link; null if a link is uneven. */
function bakedSet({ set, links }: Placement): SplatSet | null {
  let baked: SplatSet = set;
  for (const { transform } of links.toReversed()) {
    if (!transform) return null;
    baked = transformSplats(baked, transform) as SplatSet;
  }
  return baked;
}

function referenceOf(set: SplatSet, camera: Camera, modelMatrix?: Mat4): Float64Array {
  return renderReference({ clouds: [{ set, modelMatrix }], camera, ...SIZE, sortBy: 'depth' }).data;
}

/** As trained, whatever the reader packs them in. */
function readTrained(bytes: Uint8Array<ArrayBuffer>): Promise<SplatSet> {
  return readSplats(bytes, { shPrecision: 'f32' }) as unknown as Promise<SplatSet>;
}

function expectAlike(what: string, image: ArrayLike<number>, expected: Float64Array, minDb: number): void {
  expect(psnrOf(image, expected), what).toBeGreaterThanOrEqual(minDb);
}

/**
 * @fault Files: matrices scale splats unevenly, shear or mirror them
 * @consequence colours are the same, however the matrix is given
 */
describe('splats look the same whichever way a chain of matrices places them', () => {
  /**
   * @fault Files: matrices move splats up to 1e7 away, in any chain: nodes of a glTF, a cloud's matrix,
   *   instances, `transformSplats`
   * @consequence positions lose nothing at the scene's size: matrices act in float64, and an origin is
   *   subtracted before rounding
   */
  test('in float64: as a matrix of the cloud, and as nested nodes of a glTF', {
    tags: 'deeper',
  }, async () => {
    await fuzz({ few: 12, many: 200 }, async (choices) => {
      const placement = randomPlacement(choices);
      const { set, matrix, camera } = placement;
      const expected = float64Picture(worldSplats(set, matrix), camera);
      expectAlike('matrix', referenceOf(set, camera, matrix), expected, MIN_FLOAT64_DB);
      const read = await readTrained(glbOf(placement));
      expectAlike('nodes', referenceOf(read, camera), expected, MIN_FLOAT64_DB);
      const moved = bakedSet(placement);
      if (moved) expectAlike('transformSplats', referenceOf(moved, camera), expected, MIN_FLOAT64_DB);
    });
  });

  test('in every format that is written, or there is a note or an error', { tags: 'deeper' }, async () => {
    await fuzz({ few: 2, many: 100 }, async (choices) => {
      const placement = randomPlacement(choices);
      const { set, matrix, camera } = placement;
      const expected = float64Picture(worldSplats(set, matrix), camera);
      const placed = await readTrained(glbOf(placement));
      for (const { name } of WRITABLE_FORMATS) {
        const notes: string[] = [];
        const options = { onNote: (note: string) => notes.push(note) };
        const bytes = await writeSplats(placed, name, options).catch((error) => {
          expect(error).toBeInstanceOf(InvalidArgumentError);
          return null;
        });
        if (!bytes || notes.length > 0) continue;
        const image = referenceOf(await readTrained(bytes), camera);
        expectAlike(name, image, expected, MIN_WRITTEN_DB[name]);
      }
    });
  });

  gpuTest('on the GPU: as a matrix, as nodes, and as instances', { tags: 'deeper' }, async () => {
    const engine = await SplatEngine.create({
      device: await shareTestDevice(),
      accuracy: byTiles('reference'),
    });
    const view = engine.createView();
    const draw = async (cloud: SplatCloud, camera: Camera, place: Omit<CloudInstance, 'cloud'> = {}) => {
      view.render({ camera, clouds: [{ cloud, ...place }], ...SIZE, sortBy: 'depth' });
      return (await view.readPixels()).data;
    };
    await fuzz({ few: 2, many: 100 }, async (choices) => {
      const placement = randomPlacement(choices);
      const { set, links, matrix, camera } = placement;
      const expected = float64Picture(worldSplats(set, matrix), camera);
      const cloud = engine.add(set);
      expectAlike('matrix', await draw(cloud, camera, { modelMatrix: matrix }), expected, MIN_GPU_DB);
      const split = choices.below(links.length + 1);
      const place = {
        modelMatrix: product(links.slice(0, split)),
        instances: { modelMatrices: product(links.slice(split)) },
      };
      expectAlike('instance', await draw(cloud, camera, place), expected, MIN_GPU_DB);
      cloud.destroy();
      const loaded = await engine.load(glbOf(placement));
      expectAlike('nodes', await draw(loaded, camera), expected, MIN_GPU_DB);
      loaded.destroy();
    });
    view.destroy();
    engine.destroy();
  });
});
