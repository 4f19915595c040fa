// Writes SOG for tests, with the rows that reading it must give.
import { SH_REST_COEFFICIENTS, type ShDegree } from '../data/splats/splat-set.ts';
import type { Choices } from './fuzz.ts';
import { rgbaWebp } from './webp-fixture.ts';

export interface SogFixture {
  readonly version: 1 | 2;
  readonly count: number;
  readonly shDegree: ShDegree;
  /** Colours of the palette; default 70, so that it has two rows. */
  readonly paletteSize?: number;
  /** Width of all images except the palette's, px; default 4. */
  readonly width?: number;
}

/** A SOG of random bytes: metadata as an object, to be changed, images by name, float64 rows. */
export interface SogExample {
  // biome-ignore lint/suspicious/noExplicitAny: tests change whatever they like
  readonly meta: any;
  readonly images: Record<string, Uint8Array<ArrayBuffer>>;
  readonly rows: readonly (readonly number[])[];
}

export function sogExample(
  { version, count, shDegree, paletteSize = 70, width = 4 }: SogFixture,
  choices: Choices,
): SogExample {
  const height = Math.max(1, Math.ceil(count / width));
  const image = (fill: (pixel: number) => number[]) =>
    Uint8Array.from(Array.from({ length: width * height }, (_, i) => fill(i)).flat());
  const byte = () => choices.below(256);
  const low = image(() => [byte(), byte(), byte(), 255]);
  const high = image(() => [byte(), byte(), byte(), 255]);
  const rotations = image(() => [byte(), byte(), byte(), 252 + choices.below(4)]);
  const scales = image(() => [byte(), byte(), byte(), 255]);
  // All opacities but 0 and 1, whose logits are infinite.
  const colors = image(() => [byte(), byte(), byte(), 1 + choices.below(254)]);
  const labelOf = Array.from({ length: width * height }, () => choices.below(paletteSize));
  const labels = image((i) => [labelOf[i] & 255, labelOf[i] >> 8, 0, 255]);
  const coefficients = SH_REST_COEFFICIENTS[shDegree];
  const paletteWidth = 64 * coefficients;
  const paletteHeight = Math.ceil(paletteSize / 64);
  const palette = Uint8Array.from({ length: 4 * paletteWidth * paletteHeight }, byte);

  const [mins, maxs] = [
    [-2, -0.5, 0.25],
    [1.5, 3, 0.75],
  ];
  const codebook = (from: number, step: number) => Array.from({ length: 256 }, (_, i) => from + step * i);
  const between = (min: number, max: number, value: number) => min + (max - min) * (value / 255);
  const meta =
    version === 2
      ? {
          version: 2,
          asset: { generator: 'a test' },
          count,
          means: { mins, maxs, files: ['means_l.webp', 'means_u.webp'] },
          scales: { codebook: codebook(-9, 0.03), files: ['scales.webp'] },
          quats: { files: ['quats.webp'] },
          sh0: { codebook: codebook(-2, 0.017), files: ['sh0.webp'] },
          ...(shDegree > 0 && {
            shN: {
              count: paletteSize,
              bands: shDegree,
              codebook: codebook(-0.5, 0.004),
              files: ['shN_centroids.webp', 'shN_labels.webp'],
            },
          }),
        }
      : {
          means: { shape: [count, 3], dtype: 'float32', mins, maxs, files: ['means_l.webp', 'means_u.webp'] },
          scales: { shape: [count, 3], mins: [-9, -8, -7], maxs: [-1, -2, -3], files: ['scales.webp'] },
          quats: { shape: [count, 4], encoding: 'quaternion_packed', files: ['quats.webp'] },
          sh0: { shape: [count, 1, 4], mins: [-2, -1, -1.5, -6], maxs: [2, 2.5, 1, 8], files: ['sh0.webp'] },
          ...(shDegree > 0 && {
            shN: {
              shape: [count, coefficients],
              mins: -0.5,
              maxs: 0.75,
              quantization: 8,
              files: ['shN_centroids.webp', 'shN_labels.webp'],
            },
          }),
        };

  const scaleOf = (axis: number, value: number) =>
    version === 2 ? -9 + 0.03 * value : between([-9, -8, -7][axis], [-1, -2, -3][axis], value);
  const colorOf = (channel: number, value: number) =>
    version === 2 ? -2 + 0.017 * value : between([-2, -1, -1.5][channel], [2, 2.5, 1][channel], value);
  const harmonicOf = (value: number) => (version === 2 ? -0.5 + 0.004 * value : between(-0.5, 0.75, value));
  const rows = Array.from({ length: count }, (_, i) => {
    const position = mins.map((min, axis) => {
      const n = min + ((maxs[axis] - min) * (high[4 * i + axis] * 256 + low[4 * i + axis])) / 65535;
      return n < 0 ? 1 - Math.exp(-n) : Math.exp(n) - 1;
    });
    const kept = [0, 1, 2].map((k) => (rotations[4 * i + k] / 255 - 0.5) * Math.SQRT2);
    const rotation = [...kept];
    const largest = Math.sqrt(Math.max(0, 1 - kept.reduce((sum, value) => sum + value * value, 0)));
    rotation.splice(rotations[4 * i + 3] - 252, 0, largest);
    const alpha = colors[4 * i + 3];
    const opacity = version === 2 ? Math.log(alpha / 255 / (1 - alpha / 255)) : between(-6, 8, alpha);
    const harmonics = Array.from({ length: coefficients }, (_, k) => {
      const pixel = Math.floor(labelOf[i] / 64) * paletteWidth + (labelOf[i] % 64) * coefficients + k;
      return [0, 1, 2].map((channel) => harmonicOf(palette[4 * pixel + channel]));
    });
    return [
      ...position,
      ...[0, 1, 2].map((axis) => scaleOf(axis, scales[4 * i + axis])),
      ...rotation,
      opacity,
      ...[0, 1, 2].map((channel) => colorOf(channel, colors[4 * i + channel])),
      ...harmonics.flat(),
    ];
  });
  const images: SogExample['images'] = {
    'means_l.webp': rgbaWebp(width, height, low),
    'means_u.webp': rgbaWebp(width, height, high),
    'quats.webp': rgbaWebp(width, height, rotations),
    'scales.webp': rgbaWebp(width, height, scales),
    'sh0.webp': rgbaWebp(width, height, colors),
  };
  if (shDegree > 0) {
    images['shN_labels.webp'] = rgbaWebp(width, height, labels);
    images['shN_centroids.webp'] = rgbaWebp(paletteWidth, paletteHeight, palette);
  }
  return { meta, images, rows };
}

/** The files of a SOG by name; `folder` ends with `/`. */
export function sogFiles({ meta, images }: SogExample, folder = ''): Record<string, Uint8Array<ArrayBuffer>> {
  const files: Record<string, Uint8Array<ArrayBuffer>> = {
    [`${folder}meta.json`]: new TextEncoder().encode(JSON.stringify(meta)),
  };
  for (const [name, bytes] of Object.entries(images)) files[folder + name] = bytes;
  return files;
}

/** Files as a folder that was dropped. */
export function droppedFiles(files: Record<string, Uint8Array<ArrayBuffer>>): { files: File[] } {
  return {
    files: Object.entries(files).map(([path, bytes]) => {
      const file = new File([bytes], path.replace(/^.*\//, ''));
      Object.defineProperty(file, 'webkitRelativePath', { value: path.includes('/') ? path : '' });
      return file;
    }),
  };
}
