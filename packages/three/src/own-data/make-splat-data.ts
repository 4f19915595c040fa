import {
  type AccuracyRequest,
  checkAccuracy,
  DEFAULT_ACCURACY,
  InvalidArgumentError,
  printable,
  resolveAccuracy,
  type SplatSet,
} from '@websplatter/core';
import { colorDcOf, packSet, type SplatArrays, splatsFromArrays } from '@websplatter/core/own-data';
import type { BufferAttribute, BufferGeometry } from 'three/webgpu';
import { SplatData } from '../cloud/splat-data.ts';

/** What `makeSplatData` takes: arrays, a set of core's, or a geometry of three's splat loaders. */
export type SplatDataInput = SplatArrays | SplatSet | BufferGeometry;

/** Options of `makeSplatData` and `makeMorphData`. */
export interface MakeSplatDataOptions {
  /** For messages and labels. Default `splats`. */
  readonly name?: string;
  /** Accuracy that the splats are packed for, as files are by a SplatLoader. Default `balanced`. */
  readonly accuracy?: AccuracyRequest;
}

/**
 * Makes data, for `<Splats src={data}>` or a SplatCloudObject, of splats in memory: arrays, a set
 * of core's, or the geometry that three's own splat loaders return (`GaussianSplatPLYLoader`,
 * `SPLATLoader`, `SPZLoader`, `KSPLATLoader`) or that a `GaussianSplat` of its glTF loader shows
 * (`splatGeometry`), with their rounded colours. Row i is the i-th splat.
 *
 * Packs on the calling thread. The splats stay in memory for other renderers and precisions, and for
 * the renderer after a lost device.
 *
 * @throws InvalidArgumentError naming the array or attribute that is missing or wrong, and the
 *   value found.
 * @example
 * const data = makeSplatData({
 *   positions: [0, 0, 0, 1, 0, 0],
 *   scales: [0.1, 0.1, 0.1, 0.2, 0.1, 0.1],
 *   colors: [1, 0, 0, 0, 0, 1],
 * });
 * scene.add(new SplatCloudObject(data));
 */
export function makeSplatData(
  splats: SplatDataInput,
  { name = 'splats', accuracy = DEFAULT_ACCURACY }: MakeSplatDataOptions = {},
): SplatData {
  const set = setOf(splats);
  const data = new SplatData(packSet(set, checkAccuracy(accuracy) ?? resolveAccuracy()), name);
  data.set = set;
  return data;
}

export function setOf(splats: SplatDataInput): SplatSet {
  if ('isBufferGeometry' in splats) return splatsFromArrays(arraysOf(splats));
  return 'logScales' in splats ? splats : splatsFromArrays(splats);
}

/** Words of three's attributes of each band, which hold four bytes each. */
const BAND_WORDS = [3, 4, 6] as const;

/** The splats of a geometry of three's. */
function arraysOf(geometry: BufferGeometry): SplatArrays {
  const positions = attributeOf(geometry, 'position', 3)!;
  const covariances = attributeOf(geometry, 'covariance', 6)!;
  const colors = attributeOf(geometry, 'color', 4)!;
  const bands: Uint8Array[] = [];
  for (const [index, words] of BAND_WORDS.entries()) {
    const band = attributeOf(geometry, `sphericalHarmonics${index + 1}`, words, false);
    if (!band) break;
    bands.push(new Uint8Array(band.array.buffer, band.array.byteOffset, band.array.byteLength));
  }
  const { count } = positions;
  const width = 3 * (bands.length + 1) ** 2;
  const sh = new Float32Array(width * count);
  for (let i = 0; i < count; i++) {
    let at = width * i;
    for (const channel of [colors.getX(i), colors.getY(i), colors.getZ(i)]) sh[at++] = colorDcOf(channel);
    for (const [index, bytes] of bands.entries()) {
      const from = 4 * BAND_WORDS[index] * i;
      const values = 3 * (2 * index + 3);
      for (let k = 0; k < values; k++) sh[at++] = (bytes[from + k] - 128) / 128;
    }
  }
  return {
    positions: positions.array,
    covariances: covariances.array,
    opacities: Float32Array.from({ length: count }, (_, i) => colors.getW(i)),
    sh,
  };
}

function attributeOf(
  geometry: BufferGeometry,
  name: string,
  itemSize: number,
  isNeeded = true,
): BufferAttribute | null {
  const attribute = geometry.getAttribute(name) as BufferAttribute | undefined;
  if (!attribute && !isNeeded) return null;
  const count = geometry.getAttribute('position')?.count;
  if (attribute?.itemSize === itemSize && attribute.count === count) return attribute;
  const found = attribute ? `${attribute.count} × ${attribute.itemSize} values` : 'missing';
  const message = `The geometry's attribute ${printable(name)} is ${found}; one of three's splat loaders has ${itemSize} values of each splat.`;
  throw new InvalidArgumentError(name, message);
}
