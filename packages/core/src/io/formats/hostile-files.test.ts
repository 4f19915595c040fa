// Proves: damaged PLY files end alike, whole, in pieces and as rows.
import { gzipSync } from 'node:zlib';
import { withinCpuTime } from '@websplatter/node/cpu-time';
import { expect, test } from 'vitest';
import { SplatFileError, WebSplatterError } from '../../data/errors.ts';
import type { ReadHarmonics } from '../../data/packing/harmonics.ts';
import { packCloud } from '../../data/packing/packed-cloud.ts';
import type { RowLayout } from '../../data/packing/row-layout.ts';
import type { ShDegree, SplatSet } from '../../data/splats/splat-set.ts';
import { type Choices, fuzz } from '../../testing/fuzz.ts';
import {
  chunked,
  type Fixture,
  type FixtureElement,
  type FixtureProperty,
  plyBytes,
  splatNames,
} from '../../testing/ply-fixture.ts';
import { readSource } from '../loading/read-source.ts';
import { knownSource } from '../sources/known-source.ts';
import type { ReadLimits } from '../sources/splat-source.ts';
import { ALL_READERS } from './readers.ts';
import type { RowSink } from './rows/row-sink.ts';

const FORMATS = ['ascii', 'binary_little_endian', 'binary_big_endian'] as const;
const FLOATS = ['float', 'float32', 'double', 'float64'];
const INTEGERS = ['char', 'uchar', 'short', 'ushort', 'int', 'uint', 'int8', 'uint16', 'uint32'];
/** Numbers that have broken readers. */
const EVIL_NUMBERS = [
  ...[
    '0',
    '-1',
    '1e9',
    '4294967295',
    '4294967296',
    '9007199254740993',
    '1'.repeat(400),
    'NaN',
    '0x10',
    '1.5',
  ],
];
const EVIL_WORDS = [
  ...['vertex', 'list', 'float', 'uchar', 'end_header', 'comment', 'x', 'f_rest_0', 'packed_position', ''],
  ...['\0', '\r', '\u2028', 'é', '__proto__', 'constructor', 'y'.repeat(5000)],
];
const EVIL_VALUES = ['nan', '-inf', '1e999', '.', '-', '1e', '--1', '1.#QNAN', '9'.repeat(3000), 'x', ''];

/** A reader's outcome for some bytes. */
type Outcome = SplatSet<ReadHarmonics> | WebSplatterError;

function fixtureOf(choices: Choices): Fixture {
  const count = 1 + choices.below(5);
  const degree = choices.of<ShDegree>([0, 0, 1, 2, 3]);
  const isPlain = choices.isTrue(0.4);
  const column = (name: string): FixtureProperty => ({
    name,
    type: isPlain ? 'float' : choices.of(choices.isTrue(0.7) ? FLOATS : INTEGERS),
    values: Array.from({ length: count }, () => choices.below(127)),
  });
  const list = (name: string): FixtureProperty => ({
    name,
    type: choices.of(['uchar', 'double']),
    countType: choices.of(['uchar', 'int']),
    values: Array.from({ length: count }, () => Array.from({ length: choices.below(3) }, () => 1)),
  });
  const properties = splatNames(degree).map(column);
  if (!isPlain) {
    for (let i = choices.below(3); i > 0; i--) {
      const extra = choices.isTrue(0.5) ? column(`extra_${i}`) : list(`extra_${i}`);
      properties.splice(choices.below(properties.length + 1), 0, extra);
    }
  }
  const elements: FixtureElement[] = [{ name: 'vertex', count, properties }];
  const other = { name: 'face', count, properties: [choices.isTrue(0.5) ? list('indices') : column('flag')] };
  if (choices.isTrue(0.3)) elements.splice(choices.below(2), 0, other);
  return { format: choices.of(FORMATS), elements, lineEnd: choices.of(['\n', '\n', '\r\n', '\r']) };
}

/** Changes words and lines of the header. */
function damagedHeader(bytes: Uint8Array, choices: Choices): Uint8Array {
  const text = Buffer.from(bytes).toString('latin1');
  const end = text.indexOf('end_header');
  const lineEnd = /\r?\n|\r/.exec(text)![0];
  const lines = text.slice(0, end).split(lineEnd);
  for (let i = choices.below(3); i >= 0; i--) {
    // Without its first line, a file is of no known format.
    const at = choices.isTrue(0.1) ? 0 : choices.below(lines.length);
    const words = lines[at].split(' ');
    const word = choices.below(words.length);
    switch (choices.below(6)) {
      case 0:
        lines.splice(at, 1);
        if (lines.length === 0) lines.push('');
        break;
      case 1:
        lines.splice(choices.below(lines.length), 0, lines[at]);
        break;
      case 2:
        words[words.length - 1] = choices.of(EVIL_NUMBERS);
        lines[at] = words.join(' ');
        break;
      case 3:
        words[word] = choices.of([...FLOATS, ...INTEGERS, ...EVIL_WORDS]);
        lines[at] = words.join(' ');
        break;
      case 4:
        words.splice(word, choices.below(2), choices.of(EVIL_WORDS));
        lines[at] = words.join(' ');
        break;
      default:
        [lines[at], lines[lines.length - 1]] = [lines[lines.length - 1], lines[at]];
    }
  }
  return Buffer.from(lines.join(lineEnd) + text.slice(end), 'latin1');
}

/** Changes values of the body: bytes, or words of text. */
function damagedBody(bytes: Uint8Array, choices: Choices): Uint8Array {
  const damaged = Uint8Array.from(bytes);
  const start = Math.max(0, Buffer.from(bytes).indexOf('end_header'));
  const place = () => start + choices.below(damaged.length - start);
  if (choices.isTrue(0.3)) {
    const at = place();
    const value = Buffer.from(choices.of(EVIL_VALUES));
    return Buffer.concat([damaged.subarray(0, at), value, damaged.subarray(at + choices.below(4))]);
  }
  for (let i = choices.below(6); i >= 0; i--) {
    // Exponents of all ones are infinities and NaNs.
    damaged.set([choices.of([0, 0x7f, 0x80, 0xff, 10, 13, 32, 45, choices.below(256)])], place());
  }
  return damaged;
}

function damaged(bytes: Uint8Array, choices: Choices): Uint8Array<ArrayBuffer> {
  let result = bytes;
  if (choices.isTrue(0.4)) result = damagedHeader(result, choices);
  if (choices.isTrue(0.5)) result = damagedBody(result, choices);
  if (choices.isTrue(0.25)) result = result.subarray(0, choices.below(result.length + 1));
  if (choices.isTrue(0.1)) {
    const [from, to] = [choices.below(result.length + 1), choices.below(result.length + 1)];
    result = Buffer.concat([result.subarray(0, from), result.subarray(to)]);
  }
  if (choices.isTrue(0.02)) {
    result = gzipSync(result);
    result[choices.below(result.length)] ^= choices.below(256);
  }
  return Uint8Array.from(result);
}

/** Counts the rows that it is given. */
class RowCounter implements RowSink {
  readonly mayDetach: boolean;
  rows = 0;
  #pieceBytes = 0;

  constructor(mayDetach: boolean) {
    this.mayDetach = mayDetach;
  }

  async begin({ count, pieceRows, strideBytes }: RowLayout): Promise<void> {
    this.#pieceBytes = Math.min(count, pieceRows) * strideBytes;
  }

  async memory(): Promise<Uint8Array<ArrayBuffer>> {
    return new Uint8Array(this.#pieceBytes);
  }

  take(rowCount: number): void {
    this.rows += rowCount;
  }
}

async function outcomeOf(reading: Promise<SplatSet<ReadHarmonics>>): Promise<Outcome> {
  try {
    return await reading;
  } catch (error) {
    if (error instanceof WebSplatterError) return error;
    throw error;
  }
}

/** Throws unless the outcome is usable: finite splats that can be packed, or a readable error. */
function checkOutcome(outcome: Outcome, { maxSplats = Number.POSITIVE_INFINITY }: ReadLimits): void {
  if (outcome instanceof WebSplatterError) {
    if (outcome.message.length > 1200 || /[\p{Cc}\p{Bidi_C}]/u.test(outcome.message))
      throw new Error(`The message cannot be shown: ${JSON.stringify(outcome.message).slice(0, 2000)}`);
    return;
  }
  const { count, positions, logScales, rotations, opacityLogits, colorDc, fileIndices, origin } = outcome;
  const lengths = [positions, logScales, colorDc].map(({ length }) => length / 3);
  lengths.push(rotations.length / 4, opacityLogits.length, fileIndices.length);
  if (count < 1 || count > maxSplats || lengths.some((length) => length !== count))
    throw new Error(`${count} splats with columns of ${lengths}`);
  if (opacityLogits.some(Number.isNaN)) throw new Error('an opacity that is no number');
  // Those of −∞ are flat.
  if (!logScales.every((value) => value < Infinity)) throw new Error(`not sizes: ${logScales}`);
  for (const column of [positions, rotations, colorDc, origin]) {
    if (!column.every(Number.isFinite)) throw new Error(`not finite: ${column}`);
  }
  const { geometry, bounds } = packCloud(outcome, { geometryPrecision: 'packed' });
  if (![...bounds.min, ...bounds.max].every(Number.isFinite)) throw new Error(`bounds of ${bounds.min}`);
  expect(geometry.words.length).toBe(8 * count);
}

/** A known size refuses a file before its end, even for bytes that would not have been read. */
function expectSame(a: Outcome, b: Outcome): void {
  const codes = [a, b].map((outcome) => (outcome instanceof WebSplatterError ? outcome.code : 'splats'));
  if (codes.includes('truncated') || codes.includes('too-large')) return;
  // Faults of packed bytes show at once, or after the first of them, depending on their arrival.
  if (!codes.includes('damaged')) expect(codes[0]).toBe(codes[1]);
  if (codes[0] === 'splats') expect(a).toEqual(b);
}

/**
 * @fault Files: a PLY is damaged, read whole, in pieces or as rows
 * @consequence splats or a `SplatFileError` with the place; never a hang
 */
test('any damage to a file gives splats or a typed error, however it comes', {
  tags: 'deeper',
  timeout: 3_600_000,
}, async () => {
  const found: Record<string, number> = {};
  await fuzz({ few: 300, many: 25_000 }, async (choices) => {
    const bytes = damaged(plyBytes(fixtureOf(choices)), choices);
    const limits: ReadLimits = choices.isTrue(0.1)
      ? { maxBytes: 1 + choices.below(bytes.length + 10), maxSplats: 1 + choices.below(6) }
      : {};
    // These files have a few kilobytes.
    const outcome = await withinCpuTime(5000, () =>
      outcomeOf(readSource(knownSource(bytes), limits, ALL_READERS)),
    );
    checkOutcome(outcome, limits);
    const key = outcome instanceof WebSplatterError ? outcome.code : 'splats';
    found[key] = (found[key] ?? 0) + 1;
    const sizes = [1 + choices.below(7), 1 + choices.below(500)];
    const inChunks = await outcomeOf(readSource(knownSource(chunked(bytes, sizes)), limits, ALL_READERS));
    checkOutcome(inChunks, limits);
    expectSame(outcome, inChunks);
    const sink = new RowCounter(choices.isTrue(0.5));
    const files = { minRows: 1, maxRows: 1000, pieceBytes: 1 + choices.below(1000) };
    const passed = readSource(knownSource(new Blob([bytes])), limits, ALL_READERS, { sink, files });
    const rows = await outcomeOf(
      passed.then((set) => (set === 'passed' ? ({ count: sink.rows } as SplatSet<ReadHarmonics>) : set)),
    );
    // Rows that are passed on have not been looked at: all may turn out to be nothing.
    if (outcome instanceof SplatFileError && outcome.code === 'empty') return;
    expect(rows instanceof WebSplatterError).toBe(outcome instanceof WebSplatterError);
  });
  console.info(JSON.stringify(found));
  expect(Object.keys(found)).toEqual(
    expect.arrayContaining(['splats', 'truncated', 'bad-header', 'bad-value']),
  );
});
