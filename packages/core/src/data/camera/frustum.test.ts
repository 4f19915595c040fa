import fc from 'fast-check';
import { describe, expect, test } from 'vitest';
import { reference as lensReference } from '../../gpu/effects/depth-of-field/depth-of-field.reference.ts';
import { depthOfField } from '../../gpu/effects/depth-of-field/depth-of-field.ts';
import type { EffectReference } from '../../reference/effects/effect-reference.ts';
import { chunkClearance, cullSplat, isChunkInFrustum } from '../../stages/cull/cull.reference.ts';
import { anyCamera, anyModel } from '../../testing/any-view.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { TEST_MODELS } from '../../testing/test-cameras.ts';
import { uniform } from '../../testing/uniform.ts';
import { DILATION_PX2 } from '../accuracy/accuracy.ts';
import { identity4 } from '../math/mat4.ts';
import type { SplatSet } from '../splats/splat-set.ts';
import { type Projection, perspectiveCamera, projectionOf } from './camera.ts';
import { type CloudView, cloudView } from './cloud-view.ts';
import { frustumSides } from './frustum.ts';

const ALPHA_CUTOFF = 1 / 255;
const LOG_SCALES = [
  [-8, -3],
  [-3, 2],
  [-3, -1],
] as const;

/** Of each splat that is surely drawn, its index and the smallest chunk that holds it: itself. */
function drawnChunks(
  set: SplatSet,
  view: CloudView,
  projection: Projection,
  effects: readonly EffectReference[] = [],
) {
  // At near and far exactly, the rounding of the plane itself decides.
  const surely = { ...projection, near: projection.near + 1e-9, far: projection.far * (1 - 1e-9) };
  const settings = { alphaCutoff: ALPHA_CUTOFF, dilationPx2: DILATION_PX2, effects };
  return Array.from({ length: set.count }, (_, i) => i)
    .filter((i) => cullSplat(set, i, view, surely, settings))
    .map((i) => {
      const position = set.positions.subarray(3 * i, 3 * i + 3);
      const maxScale = Math.exp(Math.max(...set.logScales.subarray(3 * i, 3 * i + 3)));
      return { i, chunk: { minPosition: position, maxPosition: position, maxScale } };
    });
}

describe('frustumSides', () => {
  test('every drawn splat is in a chunk that passes, for any camera and model', () => {
    const model = fc.oneof(anyModel, fc.constantFrom(...Object.values(TEST_MODELS)));
    let drawn = 0;
    fc.assert(
      fc.property(anyCamera, model, fc.nat(), fc.nat(2), (camera, modelMatrix, seed, size) => {
        // Large splats right in front of the camera are the hard case: their Jacobian is steepest.
        const set = randomSplats({ count: 40, seed, shDegree: 0, logScales: LOG_SCALES[size] });
        const projection = projectionOf(camera, 64, 48);
        const view = cloudView(camera.viewMatrix, modelMatrix, set.origin, projection.isOrthographic);
        const planes = frustumSides(view, projection, ALPHA_CUTOFF, DILATION_PX2);
        for (const { i, chunk } of drawnChunks(set, view, projection)) {
          drawn++;
          const clearance = chunkClearance(chunk, planes);
          if (clearance < -1e-12) expect.fail(`splat ${i} is drawn; its chunk fails by ${clearance}`);
        }
      }),
      { numRuns: 3000 },
    );
    expect(drawn).toBeGreaterThan(1000);
  });

  test('every blurred splat that is drawn is in a chunk that passes, for any camera and lens', () => {
    const lens = fc.record({ aperture: uniform(0, 2), focusDistance: uniform(0.05, 5) });
    let blurred = 0;
    fc.assert(
      fc.property(anyCamera, lens, fc.nat(), (camera, options, seed) => {
        const set = randomSplats({
          count: 40,
          seed,
          shDegree: 0,
          logScales: [-3, -1],
          opacityLogits: [2, 6],
        });
        const projection = projectionOf(camera, 64, 48);
        const view = cloudView(camera.viewMatrix, identity4(), set.origin, projection.isOrthographic);
        const { reach } = depthOfField(options);
        const planes = frustumSides(view, projection, ALPHA_CUTOFF, DILATION_PX2, reach);
        const sharp = frustumSides(view, projection, ALPHA_CUTOFF, DILATION_PX2);
        const place = {
          modelMatrix: identity4(),
          origin: set.origin,
          viewMatrix: camera.viewMatrix,
          projection,
        };
        for (const { i, chunk } of drawnChunks(set, view, projection, [lensReference(options, place)])) {
          if (chunkClearance(chunk, sharp) < 0) blurred++;
          const clearance = chunkClearance(chunk, planes);
          if (clearance < -1e-12) expect.fail(`splat ${i} is drawn; its chunk fails by ${clearance}`);
        }
      }),
      { numRuns: 1000 },
    );
    // Without room for the blur, these would be lost.
    expect(blurred).toBeGreaterThan(100);
  });

  test('cull splats that are beside, behind, too near or too far, and keep all others', () => {
    const camera = perspectiveCamera({
      position: [0, 0, 5],
      target: [0, 0, 0],
      fovYDegrees: 60,
      aspect: 1,
      near: 1,
      far: 9,
    });
    const projection = projectionOf(camera, 100, 100);
    const view = cloudView(camera.viewMatrix, identity4(), [0, 0, 0], false);
    const planes = frustumSides(view, projection, ALPHA_CUTOFF, DILATION_PX2);
    const isKept = (x: number, y: number, z: number, maxScale = 0.001) =>
      isChunkInFrustum({ minPosition: [x, y, z], maxPosition: [x, y, z], maxScale }, planes);
    const edge = 5 * Math.tan(Math.PI / 6);
    for (const sign of [-1, 1]) {
      expect(isKept(sign * edge * 0.99, 0, 0)).toBe(true);
      expect(isKept(sign * edge * 1.1, 0, 0)).toBe(false);
      expect(isKept(0, sign * edge * 0.99, 0)).toBe(true);
      expect(isKept(0, sign * edge * 1.1, 0)).toBe(false);
      expect(isKept(sign * edge * 1.1, 0, 0, 0.2)).toBe(true);
    }
    expect(isKept(0, 0, 3.99)).toBe(true);
    expect(isKept(0, 0, 4.01)).toBe(false);
    // At near and far the centre decides, however large the splat.
    expect(isKept(0, 0, 4.01, 10)).toBe(false);
    expect(isKept(0, 0, 20)).toBe(false);
    expect(isKept(0, 0, -3.99)).toBe(true);
    expect(isKept(0, 0, -4.01)).toBe(false);
    // All corners of this box are outside, but the view passes through it.
    const box = { minPosition: [-100, -100, -1], maxPosition: [100, 100, 1], maxScale: 0.001 };
    expect(isChunkInFrustum(box, planes)).toBe(true);
  });
});
