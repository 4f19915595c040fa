// Proves: without a remedy on the CPU, its hard case fails.
import { renderReference } from '@websplatter/core/reference';
import { createNodeGpu } from '@websplatter/node';
import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect, vi } from 'vitest';
import { HARD_CASES } from './catalogue.ts';
import { CASE_RASTERIZERS } from './run-result.ts';

type Exports = Record<string, (...args: never[]) => unknown>;

/** A remedy on the engine's CPU side, switched off. */
interface HostMutation {
  readonly remedy: string;
  /** Module of core that contains the remedy. */
  readonly module: string;
  /** Returns the exports that replace the module's own. */
  readonly replace: (original: Exports) => Exports;
  readonly caseName: string;
}

const toFloat32 = (values: unknown) => Float64Array.from(Float32Array.from(values as Float64Array));

const HOST_MUTATIONS: readonly HostMutation[] = [
  {
    remedy: 'rows that are not finite are dropped at load',
    module: '../../core/src/data/splats/splat-row.ts',
    replace: () => ({ reasonToDrop: () => undefined }),
    caseName: 'input-nan-x',
  },
  {
    remedy: 'log scales are clamped before they are exponentiated',
    module: '../../core/src/data/packing/log-scale.ts',
    replace: () => ({ clampLogScale: (logScale: number) => logScale }),
    caseName: 'scale-log-88',
  },
  {
    remedy: 'view and model matrices are multiplied in float64',
    module: '../../core/src/data/math/mat4.ts',
    replace: ({ multiply4 }) => ({
      multiply4: (...matrices) => multiply4(...(matrices.map(toFloat32) as never[])),
    }),
    caseName: 'world-offset-6-4e6-by-model-matrix',
  },
  {
    remedy: 'the zero quaternion is the identity',
    module: '../../core/src/data/packing/rotation.ts',
    replace: () => ({
      normalizedRotation: (rotations: Float32Array, at: number, result: Float64Array) => {
        const length = Math.hypot(...rotations.subarray(at, at + 4));
        for (let k = 0; k < 4; k++) result[k] = rotations[at + k] / length;
      },
    }),
    caseName: 'rotation-zero-quaternion',
  },
  {
    remedy: 'a singular matrix has no inverse',
    module: '../../core/src/data/math/mat4.ts',
    replace: ({ invert3 }) => ({
      invert3: (...matrix) => invert3(...matrix) ?? new Float64Array(9).fill(Number.POSITIVE_INFINITY),
    }),
    caseName: 'model-singular-flat-seen-obliquely',
  },
  {
    remedy: 'positions are rounded to float32 about an origin',
    module: '../../core/src/data/packing/origin.ts',
    replace: () => ({ originOfSamples: () => [0, 0, 0] }),
    caseName: 'placement-node-far',
  },
  {
    remedy: 'the rotation of a matrix is that of its polar decomposition',
    module: '../../core/src/data/math/polar-decomposition.ts',
    replace: ({ polarDecomposition }) => ({
      polarDecomposition: (matrix) => {
        const columns = matrix as readonly number[];
        const rotation = columns.map((value, i) => {
          const start = 3 * Math.floor(i / 3);
          return value / Math.hypot(...columns.slice(start, start + 3));
        });
        return polarDecomposition(matrix) && { rotation, stretch: rotation };
      },
    }),
    caseName: 'placement-nodes-shear-colours',
  },
];

/** Also keeps adapters and devices from being garbage-collected, which Dawn does not survive. */
const gpu = { requestAdapter: async () => (await createNodeGpu()).adapter };

describe('without a remedy of the host, its case fails', () => {
  for (const { remedy, module, replace, caseName } of HOST_MUTATIONS) {
    gpuTest(remedy, async () => {
      const hardCase = HARD_CASES.find(({ name }) => name === caseName)!;
      // Load engine and runner anew with the module replaced, but keep the reference renderer.
      vi.resetModules();
      vi.doMock(module, async (importOriginal) => {
        const original = await importOriginal<Exports>();
        return { ...original, ...replace(original) };
      });
      const { HardCaseRunner } = await import('./run.ts');
      const runner = await HardCaseRunner.create({ gpu, renderReference });
      const verdicts: string[] = [];
      for (const rasterizer of CASE_RASTERIZERS) {
        const options = { presets: ['reference'], rasterizers: [rasterizer], endsAtFailure: true } as const;
        verdicts.push((await runner.run(hardCase, options)).verdict);
      }
      runner.destroy();
      vi.doUnmock(module);
      expect(verdicts).toEqual(CASE_RASTERIZERS.map(() => 'fail'));
    });
  }
});
