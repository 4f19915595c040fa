import { describe, expect, test, vi } from 'vitest';
import { DestroyedError } from '../../data/errors.ts';
import type { RowLayout } from '../../data/packing/row-layout.ts';
import { GpuMemory } from '../../gpu/gpu-memory.ts';
import type { Pipelines, StageDefinition } from '../../gpu/pipelines.ts';
import { BUFFER_USAGE, deviceWithoutGpu } from '../../testing/device-without-gpu.ts';
import { signalOf } from '../../testing/signal.ts';
import { RowIngest, rowStages } from './row-ingest.ts';

vi.stubGlobal('GPUBufferUsage', BUFFER_USAGE);

const LAYOUT: RowLayout = {
  count: 5120,
  strideBytes: 56,
  pieceRows: 256,
  offsets: Array.from({ length: 14 }, (_, i) => 4 * i),
  isBigEndian: false,
  shDegree: 0,
};

/** Takes rows of `LAYOUT` on a device that has no shaders yet, and is idle only after `go`. */
function ingestOf(go: Promise<void>) {
  const asked = signalOf();
  const device = deviceWithoutGpu(() => {
    asked.give();
    return go;
  });
  const memory = new GpuMemory(device);
  const prepared: StageDefinition[] = [];
  const prepare = (stages: readonly StageDefinition[]) => {
    prepared.push(...stages);
    return new Promise(() => {});
  };
  const pipelines = { prepare } as unknown as Pipelines;
  const caller = new AbortController();
  const options = {
    geometryPrecision: 'packed',
    shPrecision: 'u8',
    name: 'garden',
    signal: caller.signal,
    // Looks for memory however small the file is.
    fit: 'auto',
  } as const;
  const ingest = new RowIngest({ device, pipelines, memory, dispatchRow: 65_535 }, options);
  return { ingest, memory, caller, prepared, whenAsked: asked.when };
}

test.each([
  [0, false, false],
  [0, false, true],
  [3, false, false],
  [3, true, false],
  [3, false, true],
] as const)(
  'what is foreseen of degree %i, with a palette: %s, with byte harmonics: %s, is what is compiled',
  async (shDegree, hasPalette, hasByteHarmonics) => {
    const { ingest, prepared } = ingestOf(Promise.resolve());
    const palette = { entryCount: 10, entryValues: 45 };
    const byteHarmonics = { strideBytes: 45, values: { least: -4, most: 4, scale: 1, offset: 0 } };
    const layout = {
      ...LAYOUT,
      shDegree,
      ...(hasPalette && { palette }),
      ...(hasByteHarmonics && { byteHarmonics }),
    };
    await ingest.begin(layout);
    const precision = { geometryPrecision: 'packed', shPrecision: 'u8' } as const;
    expect(prepared).toEqual(rowStages({ ...precision, shDegree, hasPalette, hasByteHarmonics }));
    expect(prepared[0].conditions?.ROW_PALETTE).toBe(hasPalette);
    expect(prepared[0].conditions?.ROW_BYTE_HARMONICS).toBe(shDegree > 0 && hasByteHarmonics);
    ingest.destroy();
  },
);

/** A load ends by its signal, or by an error of its reader. */
const ENDS = [
  ['its signal', new Error('enough'), (caller: AbortController) => caller.abort(new Error('enough'))],
  ['an error', DestroyedError, () => {}],
] as const;

describe.each(ENDS)('a load that %s ends leaves nothing', (_, expected, end) => {
  /**
   * @fault Devices and engines: a load ends while it waits for memory
   * @consequence nothing is allocated for it
   */
  test('while memory is looked for', async () => {
    const go = signalOf();
    const { ingest, memory, caller, whenAsked } = ingestOf(go.when);
    const beginning = ingest.begin(LAYOUT);
    await whenAsked;
    end(caller);
    ingest.destroy();
    go.give();
    await expect(beginning).rejects.toThrow(expected);
    expect(memory.report().resources).toEqual([]);
  });

  test('before it asks for memory for another piece', async () => {
    const { ingest, memory, caller } = ingestOf(Promise.resolve());
    await ingest.begin(LAYOUT);
    // No piece is free after these, and those that come wait for shaders.
    for (let piece = 0; piece < 4; piece++) {
      await ingest.memory();
      ingest.take(LAYOUT.pieceRows);
    }
    end(caller);
    ingest.destroy();
    await expect(ingest.memory()).rejects.toThrow(expected);
    expect(memory.report().resources).toEqual([]);
  });
});
