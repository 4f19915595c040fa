import { readCoefficients, shWordsPerSplat } from '@websplatter/core';
import { packCoefficients, splatsPerPage } from '@websplatter/core/inspect';
import type { ArithmeticCase, HardCase } from '../hard-case.ts';
import { frontAndOblique, frontOnly, scenesOf } from '../make-cases.ts';
import {
  moved,
  ordinarySplats,
  randomShRest,
  type SplatValues,
  seededRandom,
  splatsOf,
} from '../make-splats.ts';

const scene = scenesOf('counts');

/** Small splats at random in a ball that `front` sees whole, the first and the last included. */
function manySplats(count: number): SplatValues[] {
  const random = seededRandom(count);
  const within = (low: number, high: number) => low + (high - low) * random();
  // A few splats must be large enough to affect the image.
  const larger = count < 10 ? 2 : 0;
  return Array.from({ length: count }, () => ({
    position: [within(-1.6, 1.6), within(-1.6, 1.6), within(-1.6, 1.6)],
    logScales: [within(-4, -2.5) + larger, within(-4, -2.5) + larger, within(-4, -2.5) + larger],
    rotation: [within(-1, 1), within(-1, 1), within(-1, 1), within(0.1, 1)],
    opacityLogit: within(-1, 3),
    color: [within(0, 1), within(0, 1), within(0, 1)],
  }));
}

const WALL = () => ({ set: splatsOf(ordinarySplats()) });

const counted = (count: number, breaks: string, maxWorkgroupsPerDimension?: number) =>
  scene({
    name:
      maxWorkgroupsPerDimension === undefined
        ? `counts-${count}`
        : `counts-${count}-in-rows-of-${maxWorkgroupsPerDimension}`,
    breaks,
    clouds: () => [{ set: splatsOf(manySplats(count)) }, WALL()],
    cameras: count > 1000 ? frontOnly : frontAndOblique,
    maxWorkgroupsPerDimension,
  });

/** Workgroups per row of large dispatches: with WebGPU's 65,535 they need millions of splats. */
const ROW = 7;

const CHUNK_BREAKS =
  'The last splat of a full chunk, or the only one of the next, is lost or read beyond the end.';
const BLOCK_BREAKS =
  'The block of a sort or scan that is full, or has a single key, counts one too many or too few.';
const ROW_BREAKS = 'A dispatch of more workgroups than one dimension takes is cut off, or runs past its end.';

/** Writes and reads back a splat's SH coefficients, whose words start past 2^`exponent` bytes. */
const offsetCase = (exponent: number): ArithmeticCase => ({
  kind: 'arithmetic',
  group: 'counts',
  name: `counts-byte-offset-past-2-${exponent}`,
  breaks: 'Offsets computed with 32-bit operators wrap around past 2^31 or 2^32 and hit another splat.',
  check: () => {
    const degree = 3;
    const wordsPerSplat = shWordsPerSplat(degree, 'f32');
    const index = Math.ceil(2 ** exponent / (4 * wordsPerSplat));
    // A sparse object holds only written words: the check needs no buffer as large as the offsets.
    const written: Record<number, number> = {};
    const words = written as unknown as Uint32Array;
    const values = Float32Array.from(randomShRest(degree, 1, exponent));
    packCoefficients(degree, 'f32', values, words, index * wordsPerSplat);
    const strays = Object.keys(written).filter(
      (key) => Number(key) < index * wordsPerSplat || Number(key) >= (index + 1) * wordsPerSplat,
    );
    if (strays.length > 0) return `splat ${index} was written to word ${strays[0]}`;
    const read = new Float32Array(values.length);
    readCoefficients({ degree, precision: 'f32', wordsPerSplat, words }, index, read);
    const wrong = read.findIndex((value, i) => value !== values[i]);
    return wrong < 0
      ? null
      : `coefficient ${wrong} of splat ${index} is ${read[wrong]}, not ${values[wrong]}`;
  },
});

/** Bytes per splat: packed and float32 geometry, harmonics of degree 3 in bytes and float32. */
const BYTES_PER_SPLAT = [32, 64, 48, 180];

/** Checks that a binding of `mebibytes` is full of whole chunks, with words numbered in 32 bits. */
const bindingCase = (mebibytes: number): ArithmeticCase => ({
  kind: 'arithmetic',
  group: 'counts',
  name: `counts-bindings-of-${mebibytes}-mib`,
  breaks: 'A cloud larger than one binding is refused, or its last splats are read from beyond the end.',
  check: () => {
    const bytes = mebibytes * 2 ** 20;
    const limits = { maxBufferSize: 2 * bytes, maxStorageBufferBindingSize: bytes };
    for (const bytesPerSplat of BYTES_PER_SPLAT) {
      const splats = splatsPerPage(limits, bytesPerSplat);
      const what = `${splats} splats of ${bytesPerSplat} bytes in ${bytes}`;
      if (splats % 256 !== 0) return `${what} are no whole chunks`;
      if (splats * bytesPerSplat > bytes) return `${what} do not fit`;
      if ((splats + 256) * bytesPerSplat <= bytes) return `${what} leave room for another chunk`;
      if ((splats * bytesPerSplat) / 4 > 2 ** 32) return `${what} have words beyond 32 bits`;
    }
    return null;
  },
});

export const COUNTS_CASES: readonly HardCase[] = [
  counted(
    0,
    'An empty cloud beside another takes an empty binding or a dispatch of 0, which some drivers refuse.',
  ),
  scene({
    name: 'counts-no-clouds',
    breaks: 'Without any cloud nothing is recorded, and the last image, or garbage, is shown.',
    clouds: () => [],
    cameras: frontOnly,
  }),
  ...[1, 2].map((count) => counted(count, 'Bounds and depth ranges of so few splats have size 0.')),
  ...[255, 256, 257].map((count) => counted(count, CHUNK_BREAKS)),
  ...[2047, 2048, 2049].map((count) => counted(count, BLOCK_BREAKS)),
  // Seven chunks fill a row, as do seven workgroups of the stage project.
  ...[7 * 256 - 1, 7 * 256, 7 * 256 + 1].map((count) => counted(count, ROW_BREAKS, ROW)),
  // Nine rows of chunks.
  counted(7 * 2048 + 1, ROW_BREAKS, ROW),
  scene({
    name: 'counts-20-clouds',
    breaks: 'Uniforms of many clouds share a buffer whose dynamic offsets must be aligned, or slots run out.',
    clouds: () =>
      Array.from({ length: 20 }, (_, i) => ({
        set: splatsOf(manySplats(12 + i)),
        modelMatrix: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, (i % 5) / 4 - 0.5, 0.3, -i / 20, 1],
      })),
  }),
  scene({
    name: 'counts-one-visible-of-2048',
    breaks: 'A compaction that leaves one splat of many gives it another’s data.',
    clouds: () => {
      const [seen, ...others] = manySplats(2048);
      return [
        { set: splatsOf([...moved(others, [0, 0, 40]), { ...seen, logScales: [-1, -1, -1] }]) },
        WALL(),
      ];
    },
    cameras: frontOnly,
  }),
  scene({
    name: 'counts-none-visible',
    breaks: 'With every splat culled, an indirect draw of nothing shows the last image, or stale keys.',
    clouds: () => [{ set: splatsOf(moved(manySplats(300), [0, 0, 40])) }],
    cameras: frontOnly,
  }),
  // 2^33 bytes are 2^31 words, where offsets in words turn negative.
  ...[31, 32, 33, 34].map(offsetCase),
  ...[128, 256, 2048, 4096].map(bindingCase),
];
