import { SplatFileError } from '../../../data/errors.ts';
import { MAX_PALETTE_ENTRIES } from '../../../data/packing/harmonics-palette.ts';
import { SH_REST_COEFFICIENTS, type ShDegree } from '../../../data/splats/splat-set.ts';
import { browserDecoder } from '../../containers/browser-webp.ts';
import { decodeWebp, openWebp, type WebpImage } from '../../containers/webp.ts';
import { unpackedLimit } from '../../sources/read-limits.ts';
import type { SceneFileReader, UncheckedFile } from '../scene-file-reader.ts';
import { type Run, splatsOf } from './scene-tree.ts';
import { PALETTE_COLUMNS } from './sog-layout.ts';
import type { SogHarmonics, SogMeta } from './sog-meta.ts';

/** The used part of a `SceneFileReader`. */
type ImageReader = Pick<SceneFileReader, 'readUnchecked' | 'pause'>;

/** Images of a SOG that were read and checked. */
export interface OpenedImages {
  /** Degree of the harmonics; 0 if there are none. */
  readonly shDegree: ShDegree;
  /** Number of palette entries; 0 if there are no harmonics. */
  readonly paletteSize: number;
  /** Rejects with SplatFileError 'damaged', or the signal's reason. It need not be awaited. */
  readonly decoded: Promise<SogImages>;
}

/** Decoded images of a SOG: R, G, B, A per splat. */
export interface SogImages {
  readonly positionsLow: Uint8Array;
  readonly positionsHigh: Uint8Array;
  readonly rotations: Uint8Array;
  readonly scales: Uint8Array;
  readonly colors: Uint8Array;
  readonly harmonics: SogPaletteImages | null;
}

export interface SogPaletteImages {
  readonly degree: ShDegree;
  /** Number of palette entries. */
  readonly size: number;
  /** R, G, B, A per coefficient and entry. */
  readonly palette: Uint8Array;
  /** Palette index per splat: low byte in R, high byte in G. */
  readonly labels: Uint8Array;
}

/** The pixels of some runs of splats, concatenated. */
export function imagesOfRuns(images: SogImages, runs: readonly Run[]): SogImages {
  const taken = (pixels: Uint8Array) => {
    const result = new Uint8Array(4 * splatsOf(runs));
    let at = 0;
    for (const { offset, count } of runs) {
      result.set(pixels.subarray(4 * offset, 4 * (offset + count)), at);
      at += 4 * count;
    }
    return result;
  };
  const { positionsLow, positionsHigh, rotations, scales, colors, harmonics } = images;
  return {
    positionsLow: taken(positionsLow),
    positionsHigh: taken(positionsHigh),
    rotations: taken(rotations),
    scales: taken(scales),
    colors: taken(colors),
    harmonics: harmonics && { ...harmonics, labels: taken(harmonics.labels) },
  };
}

/** Limits the unpacked bytes of a scene's images, against decompression bombs. */
export class ImageBudget {
  #packedBytes = 0;
  #unpackedBytes = 0;
  readonly #maxBytes: number;

  constructor(maxBytes: number) {
    this.#maxBytes = maxBytes;
  }

  /** @throws SplatFileError 'too-large' */
  take(images: readonly WebpImage[]): void {
    for (const { file, data, width, height } of images) {
      this.#packedBytes += data.length;
      this.#unpackedBytes += 4 * width * height;
      const most = Math.min(this.#maxBytes, unpackedLimit({}, { totalBytes: this.#packedBytes }));
      if (this.#unpackedBytes <= most) continue;
      const message = `with its ${width} x ${height} pixels, the images take ${this.#unpackedBytes} bytes, more than ${most}. `;
      throw new SplatFileError('too-large', file, `${message}Pass a larger maxBytes if that is right.`);
    }
  }
}

/**
 * Reads the images named in a SOG's metadata, checks all sizes, and starts to decode them.
 *
 * Rejects with SplatFileError, SplatSourceError, or the signal's reason.
 *
 * @param folder folder of the metadata, relative to the scene's folder; it ends with `/`, or is
 *   empty.
 */
export async function openSogImages(
  parts: ImageReader,
  folder: string,
  { count, files, harmonics }: SogMeta,
  budget: ImageBudget,
): Promise<OpenedImages> {
  const read: UncheckedFile[] = [];
  const openImage = async (name: string) => {
    const part = await parts.readUnchecked(folder + name);
    read.push(part);
    return openWebp(part.bytes, folder + name);
  };
  /** Damaged bytes are the root cause of any other error, so they are reported first. */
  const checkRead = async () => {
    for (const part of read) await part.check();
  };
  try {
    // In parallel, because each may be a request.
    const images = await Promise.all(imageNames({ files, harmonics }).map(openImage));
    checkSizes(images.slice(0, harmonics ? -1 : undefined), count);
    const shDegree = harmonics ? degreeOf(harmonics, images[images.length - 1]) : 0;
    budget.take(images);
    const paletteSize = harmonics ? paletteSizeOf(harmonics, images[images.length - 1]) : 0;
    const decode = async (): Promise<SogImages> => {
      const decoding = decodeAll(images, parts);
      // Decoding runs in other threads in the meantime.
      decoding.catch(() => {});
      await checkRead();
      const [positionsLow, positionsHigh, rotations, scales, colors, labels, palette] = await decoding;
      return {
        positionsLow,
        positionsHigh,
        rotations,
        scales,
        colors,
        harmonics: harmonics && { degree: shDegree, size: paletteSize, palette, labels },
      };
    };
    const decoded = decode();
    // Callers may await it late.
    decoded.catch(() => {});
    return { shDegree, paletteSize, decoded };
  } catch (error) {
    await checkRead();
    throw error;
  }
}

function paletteSizeOf({ paletteSize }: SogHarmonics, { height }: WebpImage): number {
  return Math.min(paletteSize ?? MAX_PALETTE_ENTRIES, PALETTE_COLUMNS * height, MAX_PALETTE_ENTRIES);
}

/** File names of a SOG's images, without folder. */
export function imageNames({ files, harmonics }: Pick<SogMeta, 'files' | 'harmonics'>): string[] {
  const names = [files.positionsLow, files.positionsHigh, files.rotations, files.scales, files.colors];
  if (harmonics) names.push(harmonics.labelsFile, harmonics.paletteFile);
  return names;
}

/** Decodes in the browser if possible, else one after another in this thread. */
async function decodeAll(images: readonly WebpImage[], parts: ImageReader): Promise<Uint8Array[]> {
  const byBrowser = await browserDecoder();
  const found = await Promise.all(images.map((image) => byBrowser?.(image)));
  const decoded: Uint8Array[] = [];
  for (const [i, image] of images.entries()) {
    decoded.push(found[i] ?? decodeWebp(image));
    await parts.pause();
  }
  return decoded;
}

/** Throws unless all images have equal dimensions and a pixel for every splat. */
function checkSizes(images: readonly WebpImage[], count: number): void {
  const [{ width, height }] = images;
  for (const image of images) {
    const size = `${image.width} x ${image.height} pixels`;
    if (image.width !== width || image.height !== height) {
      const message = `it has ${size}, other images of the scene ${width} x ${height}. Export the scene again.`;
      throw new SplatFileError('damaged', image.file, message);
    }
    if (width * height < count) {
      const message = `it has ${size}, too few for ${count} splats. Export the scene again.`;
      throw new SplatFileError('damaged', image.file, message);
    }
  }
}

function degreeOf({ degree }: SogHarmonics, { file, width }: WebpImage): ShDegree {
  const found = ([1, 2, 3] as const).find((each) => PALETTE_COLUMNS * SH_REST_COEFFICIENTS[each] === width);
  if (found !== undefined && found === (degree ?? found)) return found;
  const message = `it is ${width} pixels wide, which is no palette of harmonics of degree ${degree ?? '1, 2 or 3'}. `;
  throw new SplatFileError('damaged', file, `${message}Export the scene again.`);
}
