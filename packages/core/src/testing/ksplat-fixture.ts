// Writes .ksplat for tests.
import { toHalfBits } from '../data/layout/half.ts';
import { coefficientsPerSplat, type ShDegree } from '../data/splats/splat-set.ts';
import { seededRandom } from './seeded-random.ts';

export const BLOCK = 5;
export const STEPS = 32767;
export const [SH_LEAST, SH_GREATEST] = [-1.25, 2];

export type KsplatLevel = 0 | 1 | 2;

export interface KsplatSplat {
  readonly position: readonly number[];
  readonly scale: readonly number[];
  /** w, x, y, z. */
  readonly rotation: readonly number[];
  /** Red, green, blue, opacity. */
  readonly rgba: readonly number[];
  /** By coefficient, then by channel. */
  readonly sh: readonly number[];
}

interface Bucket {
  readonly center: readonly number[];
  readonly splats: readonly KsplatSplat[];
}

/** Buckets in the order of the file: those with `bucketSize` splats come first. */
export interface KsplatSection {
  readonly degree: ShDegree;
  readonly bucketSize: number;
  readonly buckets: readonly Bucket[];
  /** Rows that are kept free. */
  readonly spare?: number;
}

export function randomSections(count: number, degrees: readonly ShDegree[], seed = 1): KsplatSection[] {
  const random = seededRandom(seed);
  const list = (length: number, next: () => number) => Array.from({ length }, next);
  const splatsAbout = (center: readonly number[], length: number, degree: ShDegree): KsplatSplat[] =>
    list(length, random).map(() => ({
      position: center.map((value) => Math.fround(value + BLOCK * (random() - 0.5))),
      scale: list(3, () => Math.fround(Math.exp(-8 * random()))),
      rotation: list(4, () => Math.fround(random() - 0.5)),
      rgba: list(4, () => Math.floor(256 * random())),
      sh: list(coefficientsPerSplat(degree), () => Math.fround(3 * random() - 1.2)),
    }));
  return degrees.map((degree, i) => {
    const bucketSize = Math.max(1, Math.floor(count / 4));
    const sizes = [bucketSize, bucketSize, Math.ceil(bucketSize / 2), 0, count];
    const buckets = sizes.map((size, bucket) => {
      const center = [BLOCK * bucket, -BLOCK * i, 0.5];
      return { center, splats: splatsAbout(center, size, degree) };
    });
    return { degree, bucketSize, buckets, spare: i };
  });
}

/** Where a coefficient of `sh` stands in the file: each degree by channel. */
function placeInFile(k: number): number {
  const [coefficient, channel] = [Math.floor(k / 3), k % 3];
  return coefficient < 3 ? 3 * channel + coefficient : 9 + 5 * channel + (coefficient - 3);
}

export function ksplatBytes(sections: readonly KsplatSection[], level: KsplatLevel): Uint8Array<ArrayBuffer> {
  const parts = sections.map((section) => encodeSection(section, level));
  const counts = sections.map(({ buckets }) => buckets.flatMap(({ splats }) => splats).length);
  const bytes = new Uint8Array(parts.reduce((sum, { body }) => sum + 1024 + body.length, 4096));
  const view = new DataView(bytes.buffer);
  const splats = counts.reduce((sum, count) => sum + count, 0);
  bytes[1] = 1;
  for (const [i, word] of [sections.length, sections.length, splats, splats].entries())
    view.setUint32(4 + 4 * i, word, true);
  view.setUint16(20, level, true);
  view.setFloat32(36, SH_LEAST, true);
  view.setFloat32(40, SH_GREATEST, true);
  let at = 4096 + 1024 * parts.length;
  for (const [i, { header, body }] of parts.entries()) {
    bytes.set(header, 4096 + 1024 * i);
    bytes.set(body, at);
    at += body.length;
  }
  return bytes;
}

function encodeSection({ degree, bucketSize, buckets, spare = 0 }: KsplatSection, level: KsplatLevel) {
  const rows = buckets.flatMap(({ center, splats }) => splats.map((splat) => ({ center, splat })));
  const full = buckets.filter(({ splats }) => splats.length === bucketSize);
  const others = buckets.filter(({ splats }) => splats.length !== bucketSize);
  const numberBytes = level === 0 ? 4 : 2;
  const rowBytes = 10 * numberBytes + 4 + coefficientsPerSplat(degree) * [4, 2, 1][level];
  const bucketBytes = level === 0 ? 0 : 4 * others.length + 12 * buckets.length;
  const header = new Uint8Array(1024);
  const about = new DataView(header.buffer);
  about.setUint32(0, rows.length, true);
  about.setUint32(4, rows.length + spare, true);
  about.setUint16(40, degree, true);
  const body = new Uint8Array(bucketBytes + (rows.length + spare) * rowBytes);
  const view = new DataView(body.buffer);
  if (level > 0) {
    about.setUint32(8, bucketSize, true);
    about.setUint32(12, buckets.length, true);
    about.setFloat32(16, BLOCK, true);
    about.setUint16(20, 12, true);
    about.setUint32(24, STEPS, true);
    about.setUint32(28, body.length, true);
    about.setUint32(32, full.length, true);
    about.setUint32(36, others.length, true);
    for (const [i, { splats }] of others.entries()) view.setUint32(4 * i, splats.length, true);
    for (const [i, { center }] of [...full, ...others].entries())
      for (let axis = 0; axis < 3; axis++)
        view.setFloat32(4 * others.length + 12 * i + 4 * axis, center[axis], true);
  }
  const put = (at: number, value: number) => {
    if (level === 0) view.setFloat32(at, value, true);
    else view.setUint16(at, toHalfBits(value), true);
  };
  for (const [row, { center, splat }] of rows.entries()) {
    const start = bucketBytes + row * rowBytes;
    for (let axis = 0; axis < 3; axis++) {
      const steps = Math.round(((splat.position[axis] - center[axis]) / (BLOCK / 2)) * STEPS) + STEPS;
      if (level === 0) put(start + 4 * axis, splat.position[axis]);
      else view.setUint16(start + 2 * axis, Math.max(0, Math.min(2 * STEPS + 1, steps)), true);
    }
    for (const [i, value] of [...splat.scale, ...splat.rotation].entries())
      put(start + (3 + i) * numberBytes, value);
    const colors = start + 10 * numberBytes;
    body.set(splat.rgba, colors);
    for (const [k, value] of splat.sh.entries()) {
      const place = placeInFile(k);
      if (level === 2)
        body[colors + 4 + place] = Math.floor(((value - SH_LEAST) / (SH_GREATEST - SH_LEAST)) * 255);
      else put(colors + 4 + place * numberBytes, value);
    }
  }
  return { header, body };
}
