// Proves: any finite splat is culled and drawn as in float64, by any camera.
import { gpuTest } from '@websplatter/node/gpu-test';
import fc from 'fast-check';
import { expect } from 'vitest';
import { anyCamera, anyModel } from '../testing/any-view.ts';
import { type SplatValues, splatsOf } from '../testing/random-splats.ts';
import { testGpu } from '../testing/test-gpu.ts';
import { uniform } from '../testing/uniform.ts';
import { compareCulling } from './compare-culling.ts';
import { compareRecords } from './compare-records.ts';
import { describeFieldError } from './field-error.ts';
import { findNonFinite } from './find-non-finite.ts';
import { InspectedFrame } from './inspected-frame.ts';

const gpu = testGpu();

/** Any finite float32, including denormals, ±0 and the largest. */
const finite = fc.float({ noNaN: true, noDefaultInfinity: true });
const usually = (usual: fc.Arbitrary<number>, rare: fc.Arbitrary<number>) =>
  fc.oneof({ weight: 4, arbitrary: usual }, { weight: 1, arbitrary: rare });
const triple = (value: fc.Arbitrary<number>) => fc.tuple(value, value, value);

/** Positions stay where float32 can tell depths; other properties have any value of a file. */
const anySplat: fc.Arbitrary<SplatValues> = fc.record({
  position: triple(usually(uniform(-2, 2), uniform(-1e4, 1e4))),
  logScales: triple(usually(uniform(-8, 1), fc.oneof(uniform(-120, 90), finite))),
  rotation: usuallyTuple(uniform(-1, 1), fc.oneof(finite, fc.constantFrom(0, 1e-20, 1e20, -1e-40))),
  opacityLogit: usually(
    uniform(-6, 6),
    fc.constantFrom(100, -100, Number.POSITIVE_INFINITY, Number.NEGATIVE_INFINITY),
  ),
  colorDc: triple(usually(uniform(-2, 2), uniform(-1e4, 1e4))),
});

function usuallyTuple(usual: fc.Arbitrary<number>, rare: fc.Arbitrary<number>): fc.Arbitrary<number[]> {
  const value = usually(usual, rare);
  return fc.array(value, { minLength: 4, maxLength: 4 });
}

const RUNS = process.env.WEBSPLATTER_FULL ? 300 : 25;

gpuTest(
  'any finite splat, seen by any camera, is drawn or culled as in float64, and has the same record',
  { tags: 'deeper' },
  async () => {
    let drawn = 0;
    let unsure = 0;
    let total = 0;
    await fc.assert(
      fc.asyncProperty(
        fc.array(anySplat, { minLength: 1, maxLength: 100, size: 'max' }),
        anyCamera,
        anyModel,
        fc.boolean(),
        async (splats, camera, modelMatrix, isPacked) => {
          const frame = await InspectedFrame.draw(gpu.device, {
            clouds: [{ set: splatsOf(splats), modelMatrix }],
            camera,
            widthPx: 48,
            heightPx: 32,
            keyBits: 8,
            accuracy: isPacked ? { geometryPrecision: 'packed', recordPrecision: 'f16' } : {},
          });
          const { mismatches, flaws, visibleCount, unsureCount } = await compareCulling(frame);
          drawn += visibleCount;
          unsure += unsureCount;
          total += splats.length;
          expect(flaws).toEqual([]);
          expect(mismatches).toEqual([]);
          const { firstBad } = await compareRecords(frame);
          if (firstBad) expect.fail(describeFieldError(firstBad));
          expect(await findNonFinite(frame)).toEqual([]);
          frame.destroy();
        },
      ),
      { numRuns: RUNS },
    );
    // A GPU that draws nothing, or a reference that is never sure, would otherwise pass.
    expect(drawn).toBeGreaterThan(RUNS);
    expect(unsure).toBeLessThan(total / 4);
  },
);
