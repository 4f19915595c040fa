import { describe, expect, test, vi } from 'vitest';
import { DestroyedError, InvalidArgumentError } from '../data/errors.ts';
import { packSet } from '../data/packing/pack-set.ts';
import type { CloudPrecision } from '../data/packing/precision.ts';
import type { ShDegree } from '../data/splats/splat-set.ts';
import type { GpuMemory } from '../gpu/gpu-memory.ts';
import { randomSplats } from '../testing/random-splats.ts';
import { CloudLeases, type MakeOptions } from './cloud-leases.ts';
import { uploadGeometry, uploadHarmonics } from './cloud-planes.ts';
import { SplatCloud } from './splat-cloud.ts';

const FINEST: CloudPrecision = { geometryPrecision: 'f32', shPrecision: 'f32' };
const MIDDLE: CloudPrecision = { geometryPrecision: 'f32', shPrecision: 'f16' };
const SMALLEST: CloudPrecision = { geometryPrecision: 'packed', shPrecision: 'u8' };

/** A precision that is being made, until the test ends it. */
interface Making {
  readonly options: MakeOptions;
  end(): void;
  fail(error: Error): void;
}

const planesOf = (...precisions: CloudPrecision[]) => {
  const planes = precisions.flatMap(({ geometryPrecision, shPrecision }) => [
    `${geometryPrecision} geometry`,
    `${shPrecision} harmonics`,
  ]);
  return [...new Set(planes)].sort();
};

/** The leases of a cloud uploaded as `SMALLEST`, and the planes that it holds. */
function leased({ atOnce = true } = {}) {
  const begun: Making[] = [];
  let planes = planesOf(SMALLEST);
  const leases = new CloudLeases(SMALLEST, {
    name: 'garden',
    hasPalette: false,
    keepOnly: (claims) => {
      planes = planes.filter((plane) => planesOf(...claims).includes(plane));
    },
    make: (precision, options) =>
      new Promise((resolve, reject) => {
        options.signal.addEventListener('abort', () => reject(options.signal.reason));
        const end = () => {
          if (options.signal.aborted) return;
          planes = [...new Set([...planes, ...planesOf(precision)])].sort();
          resolve();
        };
        begun.push({ options, end, fail: reject });
        if (atOnce) end();
      }),
  });
  return { leases, begun, held: () => planes };
}

describe('a cloud holds', () => {
  test('the uploaded planes, and those claimed in addition until they are released', async () => {
    const { leases, held } = leased();
    expect(held()).toEqual(planesOf(SMALLEST));
    const lease = leases.hold(FINEST);
    await lease.met;
    expect(held()).toEqual(planesOf(SMALLEST, FINEST));
    lease.release();
    expect(held()).toEqual(planesOf(SMALLEST));
    lease.release();
    expect(held()).toEqual(planesOf(SMALLEST));
  });

  test.each([
    [0, 1],
    [1, 0],
  ])('the planes that several holders claim, whichever releases first (%i, %i)', async (...order) => {
    const { leases, held } = leased();
    const precisions = [FINEST, MIDDLE];
    const holders = precisions.map((precision) => leases.hold(precision));
    await Promise.all(holders.map(({ met }) => met));
    expect(held()).toEqual(planesOf(SMALLEST, MIDDLE, FINEST));
    holders[order[0]].release();
    expect(held()).toEqual(planesOf(SMALLEST, precisions[order[1]]));
    holders[order[1]].release();
    expect(held()).toEqual(planesOf(SMALLEST));
  });

  test('a plane as long as any lease claims it', async () => {
    const { leases, held } = leased();
    const holders = [leases.hold(FINEST), leases.hold(FINEST)];
    await Promise.all(holders.map(({ met }) => met));
    holders[0].release();
    expect(held()).toEqual(planesOf(SMALLEST, FINEST));
    holders[1].release();
    expect(held()).toEqual(planesOf(SMALLEST));
  });

  test('several precisions for one holder', async () => {
    const { leases, held } = leased();
    const lease = leases.hold(FINEST);
    await lease.met;
    await lease.add(MIDDLE);
    await lease.add(MIDDLE);
    expect(held()).toEqual(planesOf(SMALLEST, MIDDLE, FINEST));
    await lease.change(MIDDLE);
    expect(held()).toEqual(planesOf(SMALLEST, MIDDLE));
    lease.release();
    expect(held()).toEqual(planesOf(SMALLEST));
  });

  test('only the claims of others while its own lease is released, until that claims again', async () => {
    const { leases, held } = leased();
    const lease = leases.hold(FINEST);
    await lease.met;
    leases.own.release();
    expect(held()).toEqual(planesOf(FINEST));
    await leases.own.change(SMALLEST);
    expect(held()).toEqual(planesOf(SMALLEST, FINEST));
  });

  test('the claims of the last lease that was released, until its own lease claims something else', async () => {
    const { leases, held } = leased();
    leases.own.release();
    expect(held()).toEqual(planesOf(SMALLEST));
    const [first, last] = [leases.hold(FINEST), leases.hold(MIDDLE)];
    await Promise.all([first.met, last.met]);
    leases.own.release();
    first.release();
    last.release();
    expect(held()).toEqual(planesOf(MIDDLE));
    await leases.hold(FINEST).met;
    expect(held()).toEqual(planesOf(MIDDLE, FINEST));
    await leases.own.change(FINEST);
    expect(held()).toEqual(planesOf(FINEST));
  });

  test('claims that pass to its own lease while that adds another claim', async () => {
    const { leases, begun, held } = leased({ atOnce: false });
    const lease = leases.hold(MIDDLE);
    begun[0].end();
    await lease.met;
    leases.own.release();
    const added = leases.own.add(FINEST);
    lease.release();
    begun[1].end();
    await added;
    expect(held()).toEqual(planesOf(MIDDLE, FINEST));
  });
});

describe('a claim that is changed', () => {
  test('stands until the new one is met', async () => {
    const { leases, begun, held } = leased({ atOnce: false });
    const changed = leases.own.change(FINEST);
    expect(leases.own.met).toBe(changed);
    expect(held()).toEqual(planesOf(SMALLEST));
    begun[0].end();
    await changed;
    expect(held()).toEqual(planesOf(FINEST));
  });

  test('stands if the new one fails', async () => {
    const { leases, begun, held } = leased({ atOnce: false });
    const lease = leases.hold(MIDDLE);
    begun[0].end();
    await lease.met;
    const changed = lease.change(FINEST);
    begun[1].fail(new Error('gone'));
    await expect(changed).rejects.toThrow('gone');
    expect(held()).toEqual(planesOf(SMALLEST, MIDDLE));
    lease.release();
    expect(held()).toEqual(planesOf(SMALLEST));
  });

  test('cancels the pending claim of the same holder, and of no other', async () => {
    const { leases, begun, held } = leased({ atOnce: false });
    const other = leases.hold(MIDDLE);
    const first = leases.own.change(FINEST);
    const last = leases.own.change(MIDDLE);
    await expect(first).rejects.toMatchObject({ name: 'AbortError', message: /garden/ });
    expect(begun.map(({ options }) => options.signal.aborted)).toEqual([false, true, false]);
    for (const making of begun) making.end();
    await Promise.all([other.met, last]);
    expect(held()).toEqual(planesOf(MIDDLE));
  });
});

describe('a pending claim', () => {
  test('keeps planes that it needs and another holder releases', async () => {
    const { leases, begun, held } = leased({ atOnce: false });
    const first = leases.hold(MIDDLE);
    begun[0].end();
    await first.met;
    const second = leases.hold(FINEST);
    first.release();
    expect(held()).toEqual(['f32 geometry', ...planesOf(SMALLEST)]);
    begun[1].fail(new Error('gone'));
    await expect(second.met).rejects.toThrow('gone');
    expect(held()).toEqual(planesOf(SMALLEST));
  });

  test('ends with its release, even if its planes have just been made', async () => {
    const { leases, begun, held } = leased({ atOnce: false });
    const lease = leases.hold(FINEST);
    begun[0].end();
    lease.release();
    await expect(lease.met).rejects.toMatchObject({ name: 'AbortError' });
    expect(held()).toEqual(planesOf(SMALLEST));
  });

  test('rejects with the reason of its signal; reading is reported', async () => {
    const { leases, begun, held } = leased({ atOnce: false });
    const [ending, onProgress] = [new AbortController(), vi.fn()];
    const lease = leases.hold(FINEST, { signal: ending.signal, onProgress });
    expect(begun[0].options.onProgress).toBe(onProgress);
    ending.abort(new Error('enough'));
    await expect(lease.met).rejects.toThrow('enough');
    await expect(leases.hold(FINEST, { signal: ending.signal }).met).rejects.toThrow('enough');
    expect(begun).toHaveLength(1);
    expect(held()).toEqual(planesOf(SMALLEST));
  });

  test('ends with its cloud, and so do later ones; nothing is freed twice', async () => {
    const { leases, begun, held } = leased({ atOnce: false });
    const lease = leases.hold(FINEST);
    const gone = new DestroyedError('The cloud garden', 'it was destroyed');
    leases.end(gone);
    await expect(lease.met).rejects.toBe(gone);
    await expect(lease.change(SMALLEST)).rejects.toBe(gone);
    await expect(leases.hold(SMALLEST).met).rejects.toBe(gone);
    expect(begun).toHaveLength(1);
    lease.release();
    leases.own.release();
    expect(held()).toEqual(planesOf(SMALLEST));
  });

  test('of an unknown precision is rejected before anything is cancelled', async () => {
    const { leases, begun } = leased({ atOnce: false });
    const lease = leases.hold(FINEST);
    const wrong = { ...FINEST, geometryPrecision: 'f64' } as unknown as CloudPrecision;
    await expect(leases.hold(wrong).met).rejects.toThrow(InvalidArgumentError);
    await expect(lease.change(wrong)).rejects.toThrow(InvalidArgumentError);
    expect(begun.map(({ options }) => options.signal.aborted)).toEqual([false]);
  });
});

describe('a SplatCloud', () => {
  /** Planes as if from reading splats again, instead of a GPU that makes them from other planes. */
  async function makePlanes(
    { planes, shDegree }: SplatCloud,
    precision: CloudPrecision,
    { signal }: MakeOptions,
  ): Promise<void> {
    await Promise.resolve();
    signal.throwIfAborted();
    const { geometry, harmonics } = packSet(randomSplats({ count: 300, shDegree }), precision);
    planes.adoptGeometry(precision.geometryPrecision, uploadGeometry(planes.place, geometry));
    if (shDegree > 0) planes.adoptSh(precision.shPrecision, uploadHarmonics(planes.place, harmonics));
  }

  function uploaded({ shDegree = 3 as ShDegree, isEngines = true } = {}) {
    const buffers = new Set<string>();
    const memory = {
      createFilledBuffer: (label: string, { byteLength }: Uint32Array) => {
        buffers.add(label);
        return { label, size: byteLength };
      },
      destroy: ({ label }: GPUBuffer) => buffers.delete(label),
      guard: <Result>(_what: string, _advice: string, work: () => Result) => ({
        result: work(),
        checked: null,
      }),
    } as unknown as GpuMemory;
    const limits = { maxBufferSize: 1e6, maxStorageBufferBindingSize: 1e6 } as GPUSupportedLimits;
    const packed = packSet(randomSplats({ count: 300, shDegree }), SMALLEST);
    const options = { name: 'garden', ...(isEngines && { makePlanes }) };
    return { cloud: SplatCloud.upload(memory, limits, packed, options), buffers };
  }

  test('is drawn from the planes that it holds', async () => {
    const { cloud } = uploaded();
    const before = cloud.pagesFor(FINEST);
    expect(before).toMatchObject(SMALLEST);
    const lease = cloud.hold(FINEST);
    expect(cloud.pagesFor(FINEST)).toBe(before);
    await lease.met;
    expect(cloud.pagesFor(FINEST)).toMatchObject(FINEST);
    expect(cloud.pagesFor(SMALLEST)).toBe(before);
    cloud.ownLease.release();
    expect(cloud.pagesFor(SMALLEST)).toMatchObject(FINEST);
    lease.release();
    expect(cloud.precisions).toEqual({ geometry: ['f32'], sh: ['f32'] });
  });

  test('without harmonics holds them in every precision, whatever is claimed', async () => {
    const { cloud } = uploaded({ shDegree: 0 });
    const sh = ['f32', 'f16', 'u8', 'palette'];
    expect(cloud.precisions).toEqual({ geometry: ['packed'], sh });
    const lease = cloud.hold(FINEST);
    await lease.met;
    expect(cloud.precisions).toEqual({ geometry: ['f32', 'packed'], sh });
    cloud.ownLease.release();
    await lease.change(MIDDLE);
    expect(cloud.precisions).toEqual({ geometry: ['f32'], sh });
  });

  test('that is destroyed ends pending claims and rejects later ones', async () => {
    const { cloud, buffers } = uploaded();
    const lease = cloud.hold(FINEST);
    await lease.met;
    const pending = lease.change(MIDDLE);
    cloud.destroy();
    await expect(pending).rejects.toThrow(DestroyedError);
    await expect(cloud.hold(SMALLEST).met).rejects.toThrow(/garden.*destroyed/);
    lease.release();
    expect(cloud.bytes).toBe(0);
    expect([...buffers]).toEqual([]);
  });

  test('that no engine has uploaded cannot be held in another precision', async () => {
    const { cloud } = uploaded({ isEngines: false });
    await expect(cloud.hold(FINEST).met).rejects.toThrow(/garden.*engine/);
  });
});
