import { storeZstd } from '../../containers/zstd-fixture.ts';

/** Coefficients for one channel above degree 0. */
const COEFFICIENTS = [0, 3, 8, 15, 24];

/** One splat, as bytes of the file. */
export interface SpzFixtureSplat {
  /** Of each axis: bits of a float16 in version 1, later a whole number. */
  readonly position: readonly number[];
  readonly alpha: number;
  readonly color: readonly number[];
  readonly scale: readonly number[];
  /** x, y, z before version 3, later the four bytes of one number. */
  readonly rotation: readonly number[];
  /** As many as the degree asks for. */
  readonly harmonics: readonly number[];
}

export interface SpzFixture {
  readonly version: number;
  readonly degree: number;
  readonly splats: readonly SpzFixtureSplat[];
  readonly flags?: number;
  readonly fractionalBits?: number;
  /** Bytes of all extensions. */
  readonly extensions?: readonly number[];
  /** Replaces the packing of a stream. */
  readonly pack?: (bytes: Uint8Array) => Uint8Array;
}

export const FLAG_ANTIALIASED = 1;
const FLAG_EXTENSIONS = 2;

/** A splat whose bytes all differ, and differ from those of other rows. */
export function distinctSplat(version: number, degree: number, row: number): SpzFixtureSplat {
  const byte = (i: number) => (37 * row + 11 * i + 5) & 255;
  const bytes = (first: number, count: number) => Array.from({ length: count }, (_, i) => byte(first + i));
  return {
    // Halves without infinities; else numbers of both signs.
    position: [0, 1, 2].map((i) =>
      version === 1 ? (byte(i) << 7) & 0xbfff : 30_011 * (byte(i) - 128) + row,
    ),
    alpha: byte(3),
    color: bytes(4, 3),
    scale: bytes(7, 3),
    rotation: bytes(10, version < 3 ? 3 : 4),
    harmonics: bytes(14, 3 * COEFFICIENTS[degree]),
  };
}

/** An extension: its type, its length, and bytes. */
export function spzExtension(type: number, bytes: readonly number[]): number[] {
  return [...littleEndian(type, 4), ...littleEndian(bytes.length, 4), ...bytes];
}

/** The extension that names a coordinate system. */
export function coordinateSystemExtension(system: number): number[] {
  return spzExtension(0xadbe0003, littleEndian(system, 4));
}

/** A file; before version 4, the contents of its gzip stream. */
export function spzBytes(fixture: SpzFixture): Uint8Array<ArrayBuffer> {
  const { version, degree, splats, flags = 0, fractionalBits = 12 } = fixture;
  const { extensions = [], pack = storeZstd } = fixture;
  const positionBytes = version === 1 ? 2 : 3;
  const attributes = [
    splats.flatMap(({ position }) => position.flatMap((value) => littleEndian(value, positionBytes))),
    splats.map(({ alpha }) => alpha),
    splats.flatMap(({ color }) => color),
    splats.flatMap(({ scale }) => scale),
    splats.flatMap(({ rotation }) => rotation),
    splats.flatMap(({ harmonics }) => harmonics),
  ].filter((bytes) => bytes.length > 0);
  const allFlags = flags | (extensions.length > 0 ? FLAG_EXTENSIONS : 0);
  const start = [
    ...littleEndian(0x5053474e, 4),
    ...littleEndian(version, 4),
    ...littleEndian(splats.length, 4),
  ];
  const about = [degree, fractionalBits, allFlags];
  if (version < 4) return Uint8Array.from([...start, ...about, 0, ...attributes.flat(), ...extensions]);
  const streams = attributes.map((bytes) => pack(Uint8Array.from(bytes)));
  const table = streams.flatMap(({ length }, i) => [
    ...littleEndian(length, 8),
    ...littleEndian(attributes[i].length, 8),
  ]);
  const tableByte = 32 + extensions.length;
  return Uint8Array.from([
    ...[...start, ...about, streams.length, ...littleEndian(tableByte, 4), ...Array(12).fill(0)],
    ...[...extensions, ...table, ...streams.flatMap((stream) => [...stream])],
  ]);
}

/** A rotation's four bytes from version 3 on: which is largest, a sign and 9 bits of others. */
export function smallestThree(
  largest: number,
  others: readonly { isNegative: boolean; magnitude: number }[],
): number[] {
  let word = largest;
  for (const { isNegative, magnitude } of others) word = 1024 * word + (isNegative ? 512 : 0) + magnitude;
  return littleEndian(word, 4);
}

export function littleEndian(value: number, byteCount: number): number[] {
  return Array.from({ length: byteCount }, (_, i) => Math.floor(value / 256 ** i) & 255);
}
