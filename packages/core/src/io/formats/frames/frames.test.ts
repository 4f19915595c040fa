// Proves: frames come back as they were, in a third of their bytes, one by one and before the file has ended;
// wrong files and frames give typed errors.
import { createServer, type Server, type ServerResponse } from 'node:http';
import type { AddressInfo } from 'node:net';
import { deflateSync, inflateSync } from 'node:zlib';
import { afterEach, beforeEach, describe, expect, test, vi } from 'vitest';
import { perspectiveCamera } from '../../../data/camera/camera.ts';
import { DestroyedError, InvalidArgumentError, SplatFileError } from '../../../data/errors.ts';
import { type Harmonics, readCoefficients } from '../../../data/packing/harmonics.ts';
import { mortonOrder } from '../../../data/packing/morton-order.ts';
import { packCloud } from '../../../data/packing/packed-cloud.ts';
import { opacityOf } from '../../../data/splats/color-values.ts';
import { coefficientsPerSplat, type SplatSet } from '../../../data/splats/splat-set.ts';
import { fakeWorker } from '../../../testing/fake-worker.ts';
import { fileErrorOf } from '../../../testing/file-error-of.ts';
import { float64Picture, psnrOf, worldSplats } from '../../../testing/float64-picture.ts';
import { framesFile } from '../../../testing/frames-file.ts';
import { framesOfMotion } from '../../../testing/frames-of-motion.ts';
import { fuzz } from '../../../testing/fuzz.ts';
import { movingSplats } from '../../../testing/moving-splats.ts';
import { type RandomSplatOptions, randomSplats } from '../../../testing/random-splats.ts';
import { checkDrawable, damagedBytes } from '../../../testing/read-damaged.ts';
import { everyOf, stillLife } from '../../../testing/still-life.ts';
import { crc32 } from '../../containers/crc32.ts';
import { loadSplats } from '../../loading/load-splats.ts';
import { readSplats } from '../../loading/read-splats.ts';
import type { LoadProgress } from '../../sources/splat-source.ts';
import { encodePly } from '../ply/write-ply.ts';
import { SCENE_TASKS, WAITING_TASKS } from '../scene-tasks.ts';
import { write as writeSpz } from '../spz/write-spz.ts';
import { FrameWriter } from './frame-writer.ts';
import { HEADER, HEADER_BYTES, headerBytesOf, readHeader, writeHeader } from './frames-layout.ts';
import { openFrames } from './open-frames.ts';

const IDENTITY = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];

const motionOf = (frameCount: number, options: RandomSplatOptions) =>
  framesOfMotion(randomSplats(options), frameCount);

/** As trained. */
function trained(set: SplatSet<Harmonics>): SplatSet {
  const { degree } = set.harmonics;
  const width = coefficientsPerSplat(degree);
  const coefficients = new Float32Array(width * set.count);
  for (let i = 0; i < set.count; i++)
    readCoefficients(set.harmonics, i, coefficients.subarray(i * width, (i + 1) * width));
  return { ...set, harmonics: { degree, coefficients } };
}

/** Numbers of the key frames of a file. */
function keysOf(bytes: Uint8Array): number[] {
  return readHeader(bytes, 'a').entries.flatMap(({ key }, i) => (key === i ? [i] : []));
}

/**
 * @fault Files: a file of frames shows a moving scene otherwise than its frames do
 * @consequence its pictures have more than 50 dB against those of the frames
 */
test.each([0, 3] as const)(
  'twenty frames of degree %i take less than a third of their bytes, and look as before',
  async (degree) => {
    const still = trained(everyOf(await stillLife(), 5));
    const harmonics = degree === 3 ? still.harmonics : { degree, coefficients: new Float32Array(0) };
    const frames = framesOfMotion({ ...still, harmonics }, 20);
    const bytes = await framesFile(frames);
    const plyBytes = frames.length * encodePly(frames[0]).length;
    expect(bytes.length).toBeLessThan(plyBytes / (degree === 3 ? 20 : 6));
    const spzBytes = await Promise.all(frames.map(async (frame) => (await writeSpz(frame, {})).length));
    expect(bytes.length).toBeLessThan(spzBytes.reduce((sum, each) => sum + each) / 2);
    const opened = await openFrames(bytes);
    const camera = perspectiveCamera({
      position: [-0.22, 0.89, 1.36],
      target: [0.03, 0.42, -0.07],
      fovYDegrees: 50,
      aspect: 1,
    });
    const pictureOf = (set: SplatSet) => float64Picture(worldSplats(set, IDENTITY), camera);
    for (const number of [0, 7, 19]) {
      const set = trained(await opened.frames[number].readFrame('f32'));
      expect(psnrOf(pictureOf(set), pictureOf(frames[number])), `frame ${number}`).toBeGreaterThan(50);
    }
  },
);

test('values of each frame are within half a step, in the storage order of the key frame', async () => {
  const frames = motionOf(5, { count: 700, shDegree: 2, origin: [500_000, 5_300_000, 700] });
  const opened = await openFrames(await framesFile(frames));
  const order = mortonOrder(frames[0].positions, 700);
  for (const [number, frame] of frames.entries()) {
    const set = await opened.frames[number].readFrame('f32');
    expect(set.origin).toEqual(frame.origin);
    let [place, logScale, opacity, color, turn] = [0, 0, 0, 0, 0];
    for (const [i, row] of order.entries()) {
      const length = Math.hypot(...frame.rotations.subarray(4 * row, 4 * row + 4));
      let cosine = 0;
      for (let k = 0; k < 4; k++)
        cosine += (set.rotations[4 * i + k] * frame.rotations[4 * row + k]) / length;
      turn = Math.max(turn, 2 * Math.acos(Math.min(1, Math.abs(cosine))));
      const error = opacityOf(set.opacityLogits[i]) - opacityOf(frame.opacityLogits[row]);
      opacity = Math.max(opacity, Math.abs(error));
      for (let axis = 0; axis < 3; axis++) {
        const [at, from] = [3 * i + axis, 3 * row + axis];
        place = Math.max(place, Math.abs(set.positions[at] - frame.positions[from]));
        logScale = Math.max(logScale, Math.abs(set.logScales[at] - frame.logScales[from]));
        color = Math.max(color, Math.abs(set.colorDc[at] - frame.colorDc[from]));
      }
    }
    // A thirty-second of the small splats' sizes, of which the least is e⁻⁵.
    expect(place).toBeLessThan(Math.exp(-3) / 64);
    expect(logScale).toBeLessThanOrEqual(0.501 / 64);
    expect(color).toBeLessThanOrEqual(0.501 / 128);
    expect(opacity).toBeLessThanOrEqual(0.501 / 1023);
    // Half a step about each axis of the key frame, and again of the difference.
    expect(turn).toBeLessThan((2 * Math.sqrt(3) * 0.51) / 512);
  }
});

describe('a key frame begins', () => {
  const [first, second, third] = motionOf(3, { count: 300, shDegree: 1 });
  const other = randomSplats({ count: 300, shDegree: 1, seed: 9 });

  test('at the first frame, and after as many as were asked for', async () => {
    expect(keysOf(await framesFile([first]))).toEqual([0]);
    expect(keysOf(await framesFile([first, second, third]))).toEqual([0]);
    expect(keysOf(await framesFile([first, second, third], { keyEvery: 2 }))).toEqual([0, 2]);
    expect(keysOf(await framesFile([first, second, third], { keyEvery: 1 }))).toEqual([0, 1, 2]);
  });

  test('at another number of splats, or another degree', async () => {
    const fewer = randomSplats({ count: 200, shDegree: 1 });
    const plain = { ...second, harmonics: { degree: 0, coefficients: new Float32Array(0) } } as const;
    const bytes = await framesFile([first, second, fewer, fewer, plain, plain]);
    expect(keysOf(bytes)).toEqual([0, 2, 4]);
    const { frames } = await openFrames(bytes);
    const counts = await Promise.all(frames.map(async (frame) => (await frame.readFrame('u8')).count));
    expect(counts).toEqual([300, 300, 200, 200, 300, 300]);
  });

  /**
   * @fault Files: rows of two frames of a file do not correspond, since rows were dropped from one
   * @consequence the frame is a key frame, without a difference to the last
   */
  test('where a row that is not finite shifts those after it', async () => {
    const positions = second.positions.slice();
    positions[3] = Number.NaN;
    const bytes = await framesFile([first, { ...second, positions }, { ...third, positions }, third]);
    expect(keysOf(bytes)).toEqual([0, 1, 3]);
    const { frames } = await openFrames(bytes);
    expect((await frames[1].readFrame('u8')).count).toBe(299);
  });

  test('at a cut, whose difference would not be smaller, and where splats have moved too far', async () => {
    expect(keysOf(await framesFile([first, other, { ...first, positions: other.positions }]))).toEqual([
      0, 1,
    ]);
    const far = { ...first, positions: first.positions.map((value, i) => (i === 0 ? 1e30 : value)) };
    const bytes = await framesFile([first, far]);
    expect(keysOf(bytes)).toEqual([0, 1]);
    const { frames } = await openFrames(bytes);
    expect(Math.max(...(await frames[1].readFrame('u8')).positions)).toBeCloseTo(1e30, -26);
  });
});

test('splats without a size, flat ones, and opacities of 0 and 1 are kept', async () => {
  const set = randomSplats({ count: 4, shDegree: 0 });
  set.logScales.fill(Number.NEGATIVE_INFINITY, 0, 4);
  set.opacityLogits.set([Number.NEGATIVE_INFINITY, Number.POSITIVE_INFINITY]);
  set.rotations.fill(0, 0, 4);
  const moved = { ...set, positions: set.positions.map((value) => value + 1e-4) };
  const { frames } = await openFrames(await framesFile([set, moved]));
  const back = await frames[1].readFrame('f32');
  expect([...back.opacityLogits].filter((logit) => !Number.isFinite(logit)).sort()).toEqual([
    Number.NEGATIVE_INFINITY,
    Number.POSITIVE_INFINITY,
  ]);
  expect(Math.min(...back.logScales)).toBe(-40);
  expect(Math.abs(Math.max(...back.positions) - Math.max(...moved.positions))).toBeLessThan(1e-5);
});

test('a load shows the first frame, and reads nothing after it', async () => {
  const frames = motionOf(8, { count: 2000, shDegree: 1 });
  const bytes = await framesFile(frames, { framesPerS: 24 });
  const [{ offset, bytes: byteCount }] = readHeader(bytes, 'a').entries;
  let sent = 0;
  const source = new ReadableStream<Uint8Array>(
    {
      pull(controller) {
        controller.enqueue(bytes.slice(sent, sent + 100));
        sent += 100;
      },
    },
    { highWaterMark: 0 },
  );
  const set = await readSplats(source);
  expect(set).toMatchObject({
    count: 2000,
    fileFacts: {
      format: 'frames',
      frames: { count: 8, perS: 24, bytes: bytes.length },
      notes: ['Only the first of its 8 frames is shown. A sequence plays them all: see openFrames.'],
    },
  });
  expect(sent).toBeLessThan(offset + byteCount + 5000);
  expect(sent).toBeLessThan(bytes.length);
  const { frames: opened } = await openFrames(bytes);
  const first = await opened[0].readFrame('u8');
  expect(set.positions).toEqual(first.positions);
  expect(await readSplats(opened[0])).toEqual(first);
  expect(first.fileFacts).not.toHaveProperty('notes');
  expect((await readSplats(await framesFile([frames[0]]))).fileFacts).not.toHaveProperty('notes');
});

test('an opened file tells what it holds, and its frames load as files do', async () => {
  const frames = motionOf(3, { count: 600, shDegree: 2 });
  const isAntialiased = true;
  const bytes = await framesFile(
    frames.map((frame) => ({ ...frame, isAntialiased })),
    { framesPerS: 60 },
  );
  const opened = await openFrames(new File([bytes], 'dance.frames'));
  expect(opened).toMatchObject({ name: 'dance.frames', framesPerS: 60, bytes: bytes.length });
  expect(opened.durationS).toBeCloseTo(0.05);
  expect(opened.frames.map(({ name }) => name)).toEqual([0, 1, 2].map((i) => `dance.frames, frame ${i}`));
  for (const geometryPrecision of ['f32', 'packed'] as const) {
    for (const shPrecision of ['f32', 'f16', 'u8', 'palette'] as const) {
      const packed = await loadSplats(opened.frames[2], { geometryPrecision, shPrecision });
      expect(packed.geometry.precision).toBe(geometryPrecision);
      expect(packed.harmonics.precision).toBe(shPrecision === 'palette' ? 'u8' : shPrecision);
      const set = await opened.frames[2].readFrame('f32');
      const expected = packCloud(set, { geometryPrecision, shPrecision });
      expect(packed.bounds).toEqual(expected.bounds);
      expect(packed.facts).toEqual(expected.facts);
      expect(packed.facts).toMatchObject({ isAntialiased: true, declaredShDegree: 2 });
    }
  }
  opened.end();
  await expect(loadSplats(opened.frames[0])).rejects.toThrow(DestroyedError);
});

test('harmonics that change from frame to frame come back', async () => {
  const [first, second] = motionOf(2, { count: 300, shDegree: 1 });
  const coefficients = second.harmonics.coefficients.map((value) => value / 2);
  const changed = { ...second, harmonics: { degree: 1, coefficients } } as const;
  const { frames } = await openFrames(await framesFile([first, changed, second]));
  // In this order, so that the harmonics of the key frame are kept before others are asked for.
  const sums: number[] = [];
  for (const number of [0, 1, 2]) {
    const { harmonics } = await loadSplats(frames[number], { shPrecision: 'f32' });
    const row = new Float32Array(9);
    readCoefficients(harmonics, 5, row);
    sums.push(row.reduce((sum, value) => sum + Math.abs(value), 0));
  }
  expect(sums[1] / sums[0]).toBeCloseTo(0.5, 1);
  expect(sums[2]).toBe(sums[0]);
});

describe('bad input is refused', () => {
  const written = framesFile(motionOf(3, { count: 100, shDegree: 0 }));

  test.each([
    ['framesPerS', { framesPerS: 0 }],
    ['framesPerS', { framesPerS: 1e-320 }],
    ['framesPerS', { framesPerS: Number.NaN }],
    ['framesPerS', { framesPerS: 1001 }],
    ['keyEvery', { keyEvery: 0 }],
    ['keyEvery', { keyEvery: 1.5 }],
  ])('by a writer: %s of %j', (argument, options) => {
    expect(() => new FrameWriter(options)).toThrow(
      expect.objectContaining({ name: 'InvalidArgumentError', message: expect.stringContaining(argument) }),
    );
  });

  test('by a writer: no frames, no splats, motion', async () => {
    const writer = new FrameWriter();
    await expect(writer.finish(async () => {})).rejects.toThrow(/There are no frames to write/);
    await expect(writer.add(everyOf(randomSplats({ count: 1 }), 2))).resolves.toBeUndefined();
    const empty = randomSplats({ count: 0 });
    await expect(writer.add(empty)).rejects.toThrow(/Frame 1 has no splats/);
    await expect(writer.add(movingSplats({ count: 3 }))).rejects.toThrow(InvalidArgumentError);
    await expect(writer.add({} as never)).rejects.toThrow(InvalidArgumentError);
    expect(writer.frameCount).toBe(1);
  });

  /**
   * @fault Files: a file of frames is damaged, cut off, or none
   * @consequence `SplatFileError` with the code of the damage; whole frames before it are read
   */
  test('by readers: other files, cut and damaged ones', async () => {
    const bytes = await written;
    const { entries } = readHeader(bytes, 'a');
    const changed = (at: number, value: number) => {
      const copy = bytes.slice();
      copy[at] = value;
      return copy;
    };
    const openAll = async (source: Uint8Array<ArrayBuffer>) => {
      const { frames } = await openFrames(source, { name: 'a.frames' });
      for (const frame of frames) await frame.readFrame('u8');
    };
    const codes = async (source: Uint8Array<ArrayBuffer>) => [
      (await fileErrorOf(openAll(source))).code,
      await readSplats(source, { format: 'frames' }).then(
        () => 'splats',
        (error) => error.code,
      ),
    ];
    expect(await codes(changed(0, 0))).toEqual(['unknown-format', 'unknown-format']);
    expect(await codes(changed(HEADER.version, 2))).toEqual(['bad-header', 'bad-header']);
    expect(await codes(changed(HEADER.framesPerS + 7, 1))).toEqual(['damaged', 'damaged']);
    const slow = writeHeader({ framesPerS: 1e-320, isAntialiased: undefined, entries });
    expect(await codes(new Uint8Array([...slow, ...bytes.subarray(slow.length)]))).toEqual([
      'damaged',
      'damaged',
    ]);
    expect(await codes(changed(HEADER_BYTES + 3, 1))).toEqual(['damaged', 'damaged']);
    expect(await codes(bytes.slice(0, 20))).toEqual(['truncated', 'truncated']);
    expect(await codes(bytes.slice(0, HEADER_BYTES + 5))).toEqual(['truncated', 'truncated']);
    expect(await codes(bytes.slice(0, entries[0].offset + 9))).toEqual(['truncated', 'truncated']);
    expect(await codes(changed(entries[0].offset + 9, 1))).toEqual(['damaged', 'damaged']);
    // The first frame is whole.
    expect(await codes(bytes.slice(0, bytes.length - 1))).toEqual(['truncated', 'splats']);
    expect(await codes(changed(bytes.length - 9, 1))).toEqual(['damaged', 'splats']);
    await expect(openFrames(new Blob([]).stream())).rejects.toThrow(/a stream, of which no part/);
    await expect(openFrames(null as never)).rejects.toThrow(InvalidArgumentError);
  });

  test('by readers: headers whose sums are right, and that promise what cannot be', async () => {
    const bytes = await written;
    const headerBytes = headerBytesOf(3);
    const forged = (at: number, value: number) => {
      const copy = bytes.slice();
      const view = new DataView(copy.buffer);
      view.setUint32(at, value, true);
      view.setUint32(headerBytes - 4, crc32(copy.subarray(0, headerBytes - 4)), true);
      return openFrames(copy);
    };
    const entry = (number: number, field: number) => HEADER_BYTES + 32 * number + field;
    const cases: [Promise<unknown>, string][] = [
      [forged(HEADER.frameCount, 0), 'empty'],
      [forged(HEADER.frameCount, 2 ** 32 - 1), 'too-large'],
      // The sum of another number of entries lies elsewhere.
      [forged(HEADER.frameCount, 2), 'damaged'],
      [forged(entry(0, 0), 5), 'damaged'],
      [forged(entry(1, 20), 2), 'damaged'],
      [forged(entry(1, 24), 101), 'damaged'],
      [forged(entry(1, 12), 2 ** 31), 'damaged'],
      [forged(entry(0, 24), 0), 'damaged'],
      [forged(entry(0, 24), 2 ** 32 - 1), 'damaged'],
      [forged(entry(2, 28), 9), 'damaged'],
    ];
    for (const [opening, code] of cases) expect((await fileErrorOf(opening)).code).toBe(code);
    const limited = openFrames(bytes, { maxSplats: 99 });
    expect(await fileErrorOf(limited)).toMatchObject({ code: 'too-large' });
    expect(await fileErrorOf(openFrames(bytes, { maxBytes: 1000 }))).toMatchObject({ code: 'too-large' });
  });
});

/**
 * @fault Files: a file of frames whose sums are right holds any bytes
 * @consequence splats that can be drawn, or a typed error
 */
test('frames whose sums are right, and whose bytes may be any, give splats that can be drawn or a typed error', {
  tags: 'deeper',
  timeout: 600_000,
}, async () => {
  const written = await framesFile(motionOf(2, { count: 300, shDegree: 1 }));
  const { entries, ...header } = readHeader(written, 'a');
  const unpackedFrames = entries.map(({ offset, bytes }) =>
    inflateSync(written.slice(offset, offset + bytes)),
  );
  let [drawn, refused] = [0, 0];
  await fuzz({ few: 60, many: 5000 }, async (choices) => {
    let offset = headerBytesOf(2);
    const parts = unpackedFrames.map((unpacked, i) => {
      const bytes = choices.isTrue(0.7) ? damagedBytes(new Uint8Array(unpacked), choices) : unpacked;
      const packed = new Uint8Array(deflateSync(bytes));
      const entry = {
        ...entries[i],
        offset,
        bytes: packed.length,
        unpackedBytes: bytes.length,
        crc: crc32(packed),
      };
      offset += packed.length;
      return { packed, entry };
    });
    const head = writeHeader({ ...header, entries: parts.map(({ entry }) => entry) });
    const bytes = new Uint8Array(await new Blob([head, ...parts.map(({ packed }) => packed)]).arrayBuffer());
    try {
      checkDrawable(await readSplats(bytes));
      const { frames } = await openFrames(bytes);
      for (const frame of frames) checkDrawable(await readSplats(frame));
      for (const frame of frames) await loadSplats(frame);
      drawn++;
    } catch (error) {
      if (!(error instanceof SplatFileError)) throw error;
      refused++;
    }
  });
  expect(Math.min(drawn, refused)).toBeGreaterThan(0);
});

describe('from a server', () => {
  let content: Uint8Array;
  /** Bytes from here on are held back. */
  let heldFrom: number;
  let held: ServerResponse[];
  let ranges: string[];
  let server: Server;
  let url: string;

  beforeEach(async () => {
    [heldFrom, held, ranges] = [Number.POSITIVE_INFINITY, [], []];
    server = createServer((request, response) => {
      const [, start, last] = /^bytes=(\d+)-(\d+)$/.exec(request.headers.range ?? '')!;
      ranges.push(`${start}-${last}`);
      const [from, to] = [Number(start), Math.min(content.length, Number(last) + 1)];
      response.writeHead(206, {
        etag: '"1"',
        'content-range': `bytes ${from}-${to - 1}/${content.length}`,
        'content-length': to - from,
      });
      response.write(content.subarray(from, Math.min(to, Math.max(from, heldFrom))));
      if (to <= heldFrom) response.end();
      else held.push(response);
    });
    await new Promise<void>((resolve) => server.listen(0, '127.0.0.1', resolve));
    url = `http://127.0.0.1:${(server.address() as AddressInfo).port}/a.frames`;
  });

  afterEach(() => {
    for (const response of held) response.destroy();
    server.closeAllConnections();
    server.close();
  });

  test('a frame is there before the bytes after it are, and frames ahead are asked for with it', async () => {
    const frames = motionOf(6, { count: 6000, shDegree: 1 });
    content = await framesFile(frames);
    const { entries } = readHeader(content, 'a');
    expect(entries[0].bytes).toBeGreaterThan(1 << 16);
    heldFrom = entries[2].offset + 5;
    const opened = await openFrames(url);
    for (const number of [0, 1]) expect((await loadSplats(opened.frames[number])).count).toBe(6000);
    // The rest of the first frame, and all others with it.
    expect(ranges).toEqual(['0-65535', `65536-${content.length - 1}`]);
    const third = loadSplats(opened.frames[2]);
    const [response] = held;
    response.end(content.subarray(heldFrom));
    expect((await third).count).toBe(6000);
    for (const number of [3, 4, 5, 0]) await loadSplats(opened.frames[number]);
    expect(ranges).toHaveLength(2);
  });

  test('no more frames are asked for ahead than make a mebibyte', async () => {
    const file = await framesFile(motionOf(1, { count: 10, shDegree: 0 }));
    const header = readHeader(file, 'a');
    const [first] = header.entries;
    const start = headerBytesOf(5);
    // The others are no frames: they are asked for, and not read.
    const entries = [{ ...first, offset: start }];
    for (const key of [1, 2, 3, 4])
      entries.push({ ...first, key, offset: start + first.bytes + 600_000 * (key - 1), bytes: 600_000 });
    content = new Uint8Array(entries[4].offset + 600_000);
    content.set(writeHeader({ ...header, entries }));
    content.set(file.subarray(first.offset), start);
    const opened = await openFrames(url);
    expect((await loadSplats(opened.frames[0])).count).toBe(10);
    const askedTo = () => Math.max(...ranges.map((range) => Number(range.split('-')[1]) + 1));
    await expect.poll(askedTo).toBeGreaterThanOrEqual(entries[3].offset);
    expect(askedTo()).toBe(entries[3].offset);
  });

  test('frames report their bytes as they are asked for and arrive, once each, and a rate', async () => {
    content = await framesFile(motionOf(6, { count: 6000, shDegree: 1 }));
    const { entries } = readHeader(content, 'a');
    heldFrom = entries[2].offset + 5;
    const reports: LoadProgress[] = [];
    const opened = await openFrames(url, { onProgress: (progress) => reports.push(progress) });
    expect(reports).toEqual([]);
    await loadSplats(opened.frames[1]);
    const loaded = () => [...new Set(reports.map(({ loadedBytes }) => loadedBytes))];
    expect(loaded()).toEqual(entries.slice(0, 3).map(({ offset }) => offset));
    const progress = { phase: 'read', totalBytes: content.length, splats: 0 };
    expect(reports[0]).toMatchObject({ ...progress, bytesPerSecond: 0 });
    expect(reports.at(-1)).toMatchObject(progress);
    expect(reports.at(-1)!.bytesPerSecond).toBeGreaterThan(0);
    held[0].end(content.subarray(heldFrom));
    for (const number of [2, 3, 4, 5, 0]) await loadSplats(opened.frames[number]);
    expect(loaded()).toEqual([...entries.map(({ offset }) => offset), content.length]);
  });

  test('a load that nobody waits for any more ends, and frames can be asked for again', async () => {
    content = await framesFile(motionOf(3, { count: 6000, shDegree: 1 }));
    heldFrom = 70_000;
    const opened = await openFrames(url);
    const stop = new AbortController();
    const loading = loadSplats(opened.frames[0], { signal: stop.signal });
    stop.abort('stop');
    await expect(loading).rejects.toBe('stop');
    heldFrom = Number.POSITIVE_INFINITY;
    for (const response of held) response.destroy();
    expect((await loadSplats(opened.frames[0])).count).toBe(6000);
  });
});

test('workers decode frames to the bit as the calling thread does, several at once if there are cores', async () => {
  const FakeWorker = fakeWorker(() => SCENE_TASKS, WAITING_TASKS);
  vi.stubGlobal('Worker', FakeWorker);
  vi.stubGlobal('navigator', { hardwareConcurrency: 4 });
  try {
    const bytes = await framesFile(motionOf(4, { count: 900, shDegree: 1 }));
    const opened = await openFrames(bytes);
    const found = [];
    for (const frame of opened.frames) found.push(await loadSplats(frame));
    expect(FakeWorker.requests).toHaveLength(4);
    expect(FakeWorker.started).toHaveLength(1);
    await Promise.all(opened.frames.map((frame) => loadSplats(frame)));
    expect(FakeWorker.started).toHaveLength(3);
    opened.end();
    for (const worker of FakeWorker.started) expect(worker.isTerminated).toBe(true);
    vi.stubGlobal('Worker', undefined);
    const here = await openFrames(bytes);
    for (const [i, frame] of here.frames.entries()) expect(await loadSplats(frame)).toEqual(found[i]);
  } finally {
    vi.unstubAllGlobals();
  }
});
