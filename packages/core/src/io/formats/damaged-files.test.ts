// Proves: any damage to a file of any format gives splats or a typed error, whole and in pieces alike,
// in bounded memory and time.
import { Buffer } from 'node:buffer';
import { gzipSync } from 'node:zlib';
import { expect, test } from 'vitest';
import { WebSplatterError } from '../../data/errors.ts';
import { allocatedBytes } from '../../testing/allocation-meter.ts';
import { framesFile } from '../../testing/frames-file.ts';
import { Choices, fuzz } from '../../testing/fuzz.ts';
import { glbBytes, glbOfSpz, gltfBytes, gltfOf, splatAttributes } from '../../testing/gltf-fixture.ts';
import { type KsplatLevel, ksplatBytes, randomSections } from '../../testing/ksplat-fixture.ts';
import { chunked, plyBytes, splatElement } from '../../testing/ply-fixture.ts';
import { radBytes, radFiles, randomNodes } from '../../testing/rad-fixture.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { checkDrawable, damagedBytes } from '../../testing/read-damaged.ts';
import { droppedFiles, type SogFixture, sogExample, sogFiles } from '../../testing/sog-fixture.ts';
import { zipBytes } from '../../testing/zip-fixture.ts';
import { readSplats } from '../loading/read-splats.ts';
import type { SplatSource } from '../sources/splat-source.ts';
import { write as writeBricks } from './bricks/write-bricks.ts';
import { write as writeCompressedPly } from './compressed-ply/write-compressed-ply.ts';
import { SPLAT_FORMATS } from './formats.ts';
import { encodePly } from './ply/write-ply.ts';
import { distinctSplat, spzBytes } from './spz/spz-fixture.ts';

type Bytes = Uint8Array<ArrayBuffer>;
type Files = Readonly<Record<string, Bytes>>;

/** A kind of scene, as files by name. */
interface Kind {
  /** Name of its format. */
  readonly format: string;
  readonly filesOf: (splats: number) => Files | Promise<Files>;
  /** Makes one file of them; without it, there is a single file, or they are a folder. */
  readonly pack?: (files: Files) => Bytes;
  /** Name of the one file. */
  readonly name?: string;
}

const setOf = (count: number, shDegree: 0 | 1 | 3 = 1) => randomSplats({ count, shDegree });
const only = (files: Files) => Object.values(files)[0];
const gzip = (files: Files) => new Uint8Array(gzipSync(only(files)));
const spzOf = (version: number, count: number) => ({
  inner: spzBytes({
    version,
    degree: 1,
    splats: Array.from({ length: count }, (_, row) => distinctSplat(version, 1, row)),
  }),
});
const sogOf = (fixture: Omit<SogFixture, 'width' | 'paletteSize'>) =>
  sogFiles(sogExample({ ...fixture, paletteSize: 70, width: 8 }, new Choices(1)));

const gltf = (count: number) => gltfOf(splatAttributes(setOf(count)));

function pointsOf(count: number): Bytes {
  const names = ['x', 'y', 'z', 'red', 'green', 'blue'];
  const properties = names.map((name, i) => ({
    name,
    type: i < 3 ? 'float' : 'uchar',
    values: Array.from({ length: count }, (_, row) => (7 * row + 31 * i) % 256),
  }));
  return plyBytes({
    format: 'binary_little_endian',
    elements: [{ name: 'vertex', count, properties }],
  });
}

/** Rows of positions, scales, and bytes for colour and rotation. */
function splatRows(count: number): Bytes {
  const bytes = Uint8Array.from({ length: 32 * count }, (_, i) => 29 * i);
  const view = new DataView(bytes.buffer);
  for (let row = 0; row < count; row++)
    for (let k = 0; k < 6; k++) view.setFloat32(32 * row + 4 * k, 0.1 + row + k, true);
  return bytes;
}

/** Streamed SOG of two files, of which both are read. */
function streamedSog(count: number): Files {
  const bound = { min: [0, 0, 0], max: [1, 1, 1] };
  const children = [0, 1].map((file) => ({ bound, lods: { 0: { file, offset: 0, count } } }));
  const filenames = ['0_0/meta.json', '0_1/meta.json'];
  const meta = { version: 1, count: 2 * count, counts: [2 * count], lodLevels: 1, filenames };
  const text = JSON.stringify({ ...meta, tree: { bound, children } });
  const part = sogExample({ version: 2, count, shDegree: 0, width: 8 }, new Choices(2));
  return {
    'a/lod-meta.json': new TextEncoder().encode(text),
    ...sogFiles(part, 'a/0_0/'),
    ...sogFiles(part, 'a/0_1/'),
  };
}

const KINDS: Readonly<Record<string, Kind>> = {
  'a binary PLY': { format: 'ply', filesOf: (count) => ({ inner: encodePly(setOf(count, 3)) }) },
  'an ASCII PLY': {
    format: 'ply',
    filesOf: (count) => ({ inner: plyBytes({ format: 'ascii', elements: [splatElement(count, 1)] }) }),
  },
  'a PLY of points': { format: 'ply-points', filesOf: (count) => ({ inner: pointsOf(count) }) },
  'a compressed PLY': {
    format: 'compressed-ply',
    filesOf: async (count) => ({ inner: await writeCompressedPly(setOf(count), {}) }),
  },
  ...Object.fromEntries(
    [1, 2, 3, 4].map((version): [string, Kind] => [
      `SPZ ${version}`,
      { format: 'spz', filesOf: (count) => spzOf(version, count), ...(version < 4 && { pack: gzip }) },
    ]),
  ),
  GLB: { format: 'gltf', filesOf: (count) => ({ inner: glbBytes(gltf(count)) }) },
  'a glTF with its buffer in it': {
    format: 'gltf',
    filesOf: (count) => {
      const made = gltf(count);
      const data = Buffer.from(made.binary).toString('base64');
      return { inner: gltfBytes(made, `data:application/octet-stream;base64,${data}`) };
    },
  },
  'a glTF in two files': {
    format: 'gltf',
    filesOf: (count) => {
      const made = gltf(count);
      return { 'a/scene.gltf': gltfBytes(made, 'scene.bin'), 'a/scene.bin': made.binary };
    },
  },
  'GLB with SPZ': {
    format: 'gltf',
    filesOf: (count) => spzOf(2, count),
    pack: (files) => glbOfSpz(gzipSync(only(files))),
  },
  ...Object.fromEntries(
    ([0, 1, 2] as const).map((level: KsplatLevel): [string, Kind] => [
      `.ksplat of level ${level}`,
      { format: 'ksplat', filesOf: (count) => ({ inner: ksplatBytes(randomSections(count, [1]), level) }) },
    ]),
  ),
  '.splat': {
    format: 'splat',
    name: 'scene.splat',
    filesOf: (count) => ({ inner: splatRows(count) }),
  },
  '.rad': {
    format: 'rad',
    // Its leaves are somewhat more than half of its nodes.
    filesOf: (count) => ({ inner: radBytes(randomNodes(2 * count, 1, true), { degree: 1, chunkSize: 100 }) }),
  },
  '.rad in several files': {
    format: 'rad',
    filesOf: (count) =>
      radFiles(randomNodes(2 * count, 1, true), { degree: 1, chunkSize: 100, paletteSize: 2 }, 'a/'),
  },
  '.bricks': {
    format: 'bricks',
    filesOf: async (count) => ({ inner: await writeBricks(setOf(count), {}) }),
  },
  '.frames': {
    format: 'frames',
    filesOf: async (count) => ({ inner: await framesFile([setOf(count), setOf(count)]) }),
  },
  'SOG 1': { format: 'sog', filesOf: (count) => sogOf({ version: 1, count, shDegree: 1 }) },
  'SOG 2': { format: 'sog', filesOf: (count) => sogOf({ version: 2, count, shDegree: 1 }) },
  'streamed SOG': { format: 'sog', filesOf: streamedSog },
  'SOG in one file': {
    format: 'zip',
    filesOf: (count) => sogOf({ version: 2, count, shDegree: 0 }),
    pack: (files) => zipBytes(files),
  },
  'a zip archive': {
    format: 'zip',
    filesOf: (count) => ({ 'a.ply': encodePly(setOf(count)) }),
    pack: (files) => zipBytes(files, { isDeflated: true }),
  },
  gzip: { format: 'gzip', filesOf: (count) => ({ inner: encodePly(setOf(count)) }), pack: gzip },
};

/** A reader's window, as if all files filled it: what little a file of some splats takes would forbid any first guess. */
const MOST_WINDOW_BYTES = 1 << 20;

/** Splats of a kind's files. */
const SIZES = [1, 30, 300];

/** How a file comes: at once, or in pieces, its size being unknown. A folder is there at once. */
const WAYS = ['whole', 'streamed'] as const;
type Way = (typeof WAYS)[number];

/** Files as a source. */
function sourceOf(
  { pack }: Pick<Kind, 'pack'>,
  files: Files,
): { open(way: Way): SplatSource; length: number } {
  const packed = pack ? pack(files) : Object.keys(files).length === 1 ? only(files) : null;
  if (packed) {
    const open = (way: Way) => (way === 'whole' ? packed : chunked(packed, [700, 30_000]));
    return { open, length: packed.length };
  }
  const length = Object.values(files).reduce((sum, bytes) => sum + bytes.length, 0);
  return { open: () => droppedFiles(files), length };
}

const EVIL_NUMBERS = [
  ...['0', '1', '-1', '0.5', '65536', '400000', '3000000', '33000000', '4294967295', '4294967296'],
  ...['1e9', '9007199254740993'],
];

/** Replaces a number that is written as text, if there is one near the start, by another. */
function damagedNumber(bytes: Bytes, choices: Choices): Bytes {
  const text = Buffer.from(bytes.buffer, bytes.byteOffset, Math.min(bytes.length, 4000)).toString('latin1');
  const numbers = [...text.matchAll(/(?<![\w.])-?\d+(?:\.\d+)?/g)];
  if (numbers.length === 0) return bytes;
  // The first of a header are counts.
  const { index, 0: number } = choices.of(numbers.slice(0, choices.of([2, 3, 30, numbers.length])));
  const other = Buffer.from(choices.of(EVIL_NUMBERS));
  const rest = bytes.subarray(index + number.length);
  return new Uint8Array(Buffer.concat([bytes.subarray(0, index), other, rest]));
}

/** Any bytes, or those that are damaged anywhere, or near an end, where the most depends on them. */
function damaged(bytes: Bytes, choices: Choices): Bytes {
  if (choices.isTrue(0.05)) return Uint8Array.from({ length: choices.below(400) }, () => choices.below(256));
  if (choices.isTrue(0.35)) return damagedNumber(bytes, choices);
  const window = choices.of([32, 300, bytes.length]);
  const from = choices.isTrue(0.7) ? 0 : Math.max(0, bytes.length - window);
  const part = bytes.subarray(from, from + window);
  if (part.length === 0) return bytes;
  const whole = Buffer.concat([
    bytes.subarray(0, from),
    damagedBytes(part, choices),
    bytes.subarray(from + window),
  ]);
  return new Uint8Array(whole);
}

/** Returns the code of a typed error that can be shown, or that there are splats. */
async function read(source: SplatSource, name: string): Promise<string> {
  let timer: ReturnType<typeof setTimeout> | undefined;
  const late = new Promise<never>((_, reject) => {
    timer = setTimeout(() => reject(new Error('Nothing came of it for a minute.')), 60_000);
  });
  try {
    checkDrawable(await Promise.race([readSplats(source, { name }), late]));
    return 'splats';
  } catch (error) {
    if (!(error instanceof WebSplatterError)) throw error;
    if (error.message.length > 1200) throw new Error(`too long: ${error.message}`);
    return error.code;
  } finally {
    clearTimeout(timer);
  }
}

/**
 * @fault Files: a damaged file of any format, packed or not, whole or in pieces
 * @consequence splats or a `WebSplatterError`, within 2 s of CPU time, in at most three times the memory
 *   of an intact file and a buffer of 1 MiB
 * @fault Files: a file holds any bytes
 * @consequence splats or a typed error
 */
test('damaged files of every format give splats or a typed error, whole and in pieces alike, in no more memory and time than honest ones', {
  tags: 'deeper',
  timeout: 3_600_000,
}, async () => {
  expect([...new Set(Object.values(KINDS).map(({ format }) => format))].sort()).toEqual(
    SPLAT_FORMATS.map(({ name }) => name).sort(),
  );
  const examples = await Promise.all(
    Object.entries(KINDS).map(async ([title, kind]) => {
      const honest = await Promise.all(
        SIZES.map(async (splats) => {
          const files = await kind.filesOf(splats);
          return { files, ...sourceOf(kind, files), bytes: { whole: 0, streamed: 0 } };
        }),
      );
      return { title, kind, name: kind.name ?? 'scene', honest };
    }),
  );
  for (const { name, honest, title } of examples) {
    // Tables that are made once are not counted.
    await read(honest[0].open('whole'), name);
    for (const { open, bytes } of honest) {
      for (const way of WAYS) {
        bytes[way] = await allocatedBytes(async () => {
          expect(await read(open(way), name), title).toBe('splats');
        });
      }
    }
  }
  const found: Record<string, number> = {};
  let [most, mostOf, slowestMs] = [0, '', 0];
  let files = 0;
  const summary = () => {
    const memory = `most memory ${most.toFixed(2)} times that of an honest file (${mostOf})`;
    return `${files} damaged files of ${examples.length} kinds: ${JSON.stringify(found)}; ${memory}, slowest ${slowestMs.toFixed(0)} ms`;
  };
  await fuzz({ few: 200, many: 40_000 }, async (choices) => {
    const { title, kind, name, honest } = choices.of(examples);
    let scene: Record<string, Bytes> = { ...choices.of(honest).files };
    let { pack } = kind;
    if (pack && choices.isTrue(0.5)) {
      scene = { packed: pack(scene) };
      pack = undefined;
    }
    const path = choices.of(Object.keys(scene));
    scene[path] = damaged(scene[path], choices);
    const { open, length } = sourceOf({ pack }, scene);
    // The shortest honest file that is as long.
    const like = honest.find((each) => each.length >= length) ?? honest[honest.length - 1];
    const codes: string[] = [];
    for (const way of WAYS) {
      const start = process.cpuUsage();
      const bytes = await allocatedBytes(async () => {
        codes.push(await read(open(way), name));
      });
      const { user, system } = process.cpuUsage(start);
      const elapsedMs = (user + system) / 1000;
      slowestMs = Math.max(slowestMs, elapsedMs);
      if (elapsedMs > 2000) throw new Error(`${title}: reading took ${elapsedMs} ms of the processor`);
      const ratio = (bytes + MOST_WINDOW_BYTES) / (like.bytes[way] + MOST_WINDOW_BYTES);
      if (ratio > most) [most, mostOf] = [ratio, title];
      if (ratio > 3)
        throw new Error(
          `${title}, ${way}: reading took ${bytes} bytes, ${ratio} times those of an honest file`,
        );
    }
    // A known size refuses a PLY before its end, for whatever else is wrong with it.
    const isRefusedEarly = title.includes('PLY') && codes.includes('truncated');
    if (codes[0] !== codes[1] && !isRefusedEarly) throw new Error(`${title}, whole and streamed: ${codes}`);
    for (const code of codes) found[code] = (found[code] ?? 0) + 1;
    if (++files % 10_000 === 0) console.info(summary());
  });
  console.info(summary());
  expect(Object.keys(found)).toEqual(
    expect.arrayContaining(['splats', 'truncated', 'damaged', 'bad-header', 'bad-property']),
  );
});
