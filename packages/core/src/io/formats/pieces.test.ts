import { gunzipSync } from 'node:zlib';
import { expect, test } from 'vitest';
import { limitDegree } from '../../data/editing/limit-degree.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { readSplatPieces, readSplats } from '../loading/read-splats.ts';
import { knownSource } from '../sources/known-source.ts';
import { openBricks } from './bricks/open-bricks.ts';
import { encodePly } from './ply/write-ply.ts';
import { PieceFacts } from './rows/piece-facts.ts';
import type { SplatPieces } from './write-format.ts';
import { canWritePieces, openBrickWriter, writeSplatPieces, writeSplats } from './writers.ts';

/** Of three pieces, also without every ninth. */
const COUNT = 40_000;
const SPLATS = randomSplats({ count: COUNT, shDegree: 1 });

/** A PLY as text, whose lines are those of a binary one. */
function asText(ply: Uint8Array): Uint8Array<ArrayBuffer> {
  const text = new TextDecoder('latin1').decode(ply);
  const start = text.indexOf('end_header\n') + 'end_header\n'.length;
  const columns = text.slice(0, start).match(/^property/gm)!.length;
  const values = new Float32Array(ply.slice(start).buffer);
  const lines = Array.from({ length: values.length / columns }, (_, row) =>
    values.subarray(row * columns, (row + 1) * columns).join(' '),
  );
  const header = text.slice(0, start).replace('binary_little_endian', 'ascii');
  return new TextEncoder().encode(`${header}${lines.join('\n')}\n`);
}

/** A PLY whose x, y and z are doubles. */
function widePly(set: typeof SPLATS, positions: Float64Array): Uint8Array<ArrayBuffer> {
  const bytes = encodePly({ ...set, origin: [2 ** 30, 0, 0] });
  const view = new DataView(bytes.buffer);
  const rowBytes = 24 + 4 * (11 + 9);
  for (const [i, value] of positions.entries())
    view.setFloat64(bytes.length - (set.count - Math.floor(i / 3)) * rowBytes + 8 * (i % 3), value, true);
  return bytes;
}

function splatBytes(count: number): Uint8Array<ArrayBuffer> {
  const bytes = new Uint8Array(32 * count).map((_, i) => (37 * i) & 255);
  const view = new DataView(bytes.buffer);
  for (let row = 0; row < count; row++)
    for (let k = 0; k < 6; k++) view.setFloat32(32 * row + 4 * k, 1 + ((row * 7 + k) % 1000) / 100, true);
  return bytes;
}

async function piecesOf(
  bytes: Uint8Array<ArrayBuffer>,
  name: string,
): Promise<SplatPieces & { pieces: number }> {
  const facts = new PieceFacts();
  let pieces = 0;
  const read: SplatPieces['read'] = (onPiece) =>
    readSplatPieces(new File([bytes], name), { shPrecision: 'f32' }, onPiece);
  await read(async (piece) => {
    facts.add(piece);
    pieces++;
  });
  return { facts, read, pieces };
}

async function writtenInPieces(pieces: SplatPieces, format: string): Promise<Uint8Array<ArrayBuffer>> {
  const parts: Uint8Array<ArrayBuffer>[] = [];
  const told: number[] = [];
  await writeSplatPieces(pieces, format, { onProgress: (fraction) => told.push(fraction) }, async (part) => {
    parts.push(part);
  });
  expect(told.at(-1)).toBe(1);
  expect(told).toEqual([...told].sort((a, b) => a - b));
  return new Uint8Array(await new Blob(parts).arrayBuffer());
}

const withGaps = { ...SPLATS, positions: SPLATS.positions.slice() };
for (let i = 0; i < COUNT; i += 9) withGaps.positions[3 * i] = Number.NaN;

const SOURCES = {
  'a.ply': encodePly(SPLATS),
  'gaps.ply': encodePly(withGaps),
  'text.ply': asText(encodePly(SPLATS)),
  'a.splat': splatBytes(COUNT),
  'a.spz': await writeSplats(SPLATS, 'spz'),
};

test.each(Object.entries(SOURCES))('%s is written in pieces as it is whole', async (name, bytes) => {
  const pieces = await piecesOf(bytes, name);
  expect(pieces.pieces).toBeGreaterThan(2);
  const set = await readSplats(new File([bytes], name), { shPrecision: 'f32' });
  const { count, dropped, origin, isAntialiased, fileFacts, harmonics } = set;
  expect({ ...pieces.facts, origin: pieces.facts.origin }).toMatchObject({
    ...{ count, dropped, origin, isAntialiased, fileFacts, shDegree: harmonics.degree },
  });
  // Text gives the pieces of a.ply, slowly.
  for (const format of name === 'text.ply' ? ['ply'] : ['ply', 'spz'])
    expect(await writtenInPieces(pieces, format)).toEqual(await writeSplats(set, format));
});

test('coordinates in float64 are as exact as those of a whole set', async () => {
  const far = encodePly({ ...SPLATS, origin: [1024, 0, 0] });
  const pieces = await piecesOf(far, 'far.ply');
  expect(pieces.facts.origin).toEqual((await readSplats(far)).origin);
  const written = await writtenInPieces(pieces, 'ply');
  const headerBytes = far.length - COUNT * (24 + 4 * (11 + 9));
  expect(written.subarray(0, headerBytes)).toEqual(far.subarray(0, headerBytes));
  const [found, truth] = [written, far].map((bytes) => new DataView(bytes.buffer, headerBytes));
  let worst = 0;
  for (let at = 0; at < found.byteLength; at += 24 + 4 * (11 + 9))
    for (let axis = 0; axis < 24; axis += 8) {
      const error = found.getFloat64(at + axis, true) - truth.getFloat64(at + axis, true);
      worst = Math.max(worst, Math.abs(error));
    }
  expect(worst).toBeLessThanOrEqual(2 ** -24);
});

/** @fault Files: single failed or stray points lie far from the scene: at 0, at 1e7, on either side */
test('single strays take no precision from a far scene, whole, in pieces and in bricks', async () => {
  const truth = Float64Array.from(SPLATS.positions, (value, i) => value + [5e5, 5.3e6, 700][i % 3]);
  // Failed points at 0, and others far outside.
  for (let i = 5; i < COUNT; i += 50) truth.fill(i % 100 === 5 ? 0 : 1e7, 3 * i, 3 * i + 3);
  const bytes = widePly(SPLATS, truth);
  const set = await readSplats(bytes, { shPrecision: 'f32' });
  const writer = await openBrickWriter();
  const pieces = await piecesOf(bytes, 'far.ply');
  await pieces.read((piece) => writer.add(limitDegree(piece, 0)));
  const bricks: Uint8Array<ArrayBuffer>[] = [];
  await writer.finish(async (part) => {
    bricks.push(part);
  });
  await writer.end();
  const found = {
    whole: set,
    'written in pieces': await readSplats(await writtenInPieces(pieces, 'ply')),
  };
  for (const [how, { positions, origin, fileIndices }] of Object.entries(found)) {
    expect(origin, how).toEqual(set.origin);
    let worst = 0;
    for (const [i, row] of fileIndices.entries()) {
      if (row % 50 === 5) continue;
      for (let k = 0; k < 3; k++)
        worst = Math.max(worst, Math.abs(positions[3 * i + k] + origin[k] - truth[3 * row + k]));
    }
    expect(worst, how).toBeLessThan(1e-6);
  }
  const { origin } = await openBricks(knownSource(new Blob(bricks)));
  for (const axis of [0, 1, 2]) expect(Math.abs(origin[axis] - set.origin[axis])).toBeLessThan(1);
});

test('the reach of bands is that of all splats once the last piece is there', async () => {
  const reaches: (readonly number[] | undefined)[] = [];
  await readSplatPieces(SOURCES['a.ply'], { shPrecision: 'f32' }, async ({ harmonics }) => {
    if ('bandReach' in harmonics) reaches.push(harmonics.bandReach);
  });
  const { harmonics } = await readSplats(SOURCES['a.ply'], { shPrecision: 'f32' });
  expect(reaches.at(-1)).toEqual(harmonics.bandReach);
});

test('an SPZ that can be read once comes in pieces, too', async () => {
  const facts = new PieceFacts();
  let pieces = 0;
  await readSplatPieces(new Blob([SOURCES['a.spz']]).stream(), {}, async (piece) => {
    facts.add(piece);
    pieces++;
  });
  expect(pieces).toBeGreaterThan(2);
  expect(facts.count).toBe(COUNT);
});

test('an SPZ that is cut off gives no piece', async () => {
  const cut = new Blob([gunzipSync(SOURCES['a.spz']).subarray(0, -1)]);
  let pieces = 0;
  const read = readSplatPieces(cut, { name: 'cut.spz' }, async () => {
    pieces++;
  });
  await expect(read).rejects.toMatchObject({ code: 'truncated', file: 'cut.spz' });
  expect(pieces).toBe(0);
});

test('a splat that the format cannot hold is named by its place among all', async () => {
  const set = { ...SPLATS, positions: SPLATS.positions.slice() };
  set.positions[3 * 39_000] = 1e6;
  const pieces = await piecesOf(encodePly(set), 'a.ply');
  await expect(writtenInPieces(pieces, 'spz')).rejects.toThrow('Splat 39000 has x = 1000000');
});

test.each(['ply', 'spz'])(
  'a %s ends where its bytes find no place, and when it is aborted',
  async (format) => {
    const pieces = await piecesOf(SOURCES['a.ply'], 'a.ply');
    const full = new Error('no room');
    await expect(writeSplatPieces(pieces, format, {}, () => Promise.reject(full))).rejects.toBe(full);
    const controller = new AbortController();
    const options = { signal: controller.signal, onProgress: () => controller.abort('enough') };
    await expect(writeSplatPieces(pieces, format, options, async () => {})).rejects.toBe('enough');
  },
);

test('formats that need all splats at once, and no splats, are refused', async () => {
  const pieces = await piecesOf(SOURCES['a.ply'], 'a.ply');
  expect(['sog', 'nothing'].map(canWritePieces)).toEqual([false, false]);
  await expect(writeSplatPieces(pieces, 'sog', {}, async () => {})).rejects.toThrow(
    'sog cannot be written in pieces',
  );
  const none = { ...pieces, facts: new PieceFacts() };
  await expect(writeSplatPieces(none, 'ply', {}, async () => {})).rejects.toMatchObject({ argument: 'set' });
});
