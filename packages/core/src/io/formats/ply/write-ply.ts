import { type Harmonics, readCoefficients } from '../../../data/packing/harmonics.ts';
import { givenSet } from '../../../data/splats/check-set.ts';
import { coefficientsPerSplat, type SplatSet } from '../../../data/splats/splat-set.ts';
import { fileMemory, type WriteFormat, writeInTurns } from '../write-format.ts';

/**
 * Encodes `set` as a PLY in the standard 3DGS layout: binary little-endian, float32 x y z, f_dc, f_rest (all of red,
 * then green, then blue), opacity, scale, rot; no normals. A comment says what is known of an antialias filter. Rows keep
 * the set's order; `fileIndices` and `dropped` are not kept.
 *
 * Where the origin is not 0, x y z are doubles with the origin added, since float32 could not hold them. Read again at
 * shPrecision f32, a set that came from a file gives the same bits. Throws RangeError if no ArrayBuffer can be that
 * large.
 */
export function encodePly(set: SplatSet<Harmonics>): Uint8Array<ArrayBuffer> {
  const { bytes, putRows } = plyOf(set);
  putRows(0, set.count);
  return bytes;
}

/** As `encodePly`, in turns with other work of the thread. */
export const write: WriteFormat = async (set, options) => {
  const { bytes, putRows } = plyOf(set, fileMemory);
  await writeInTurns(set.count, options, putRows);
  return bytes;
};

/** The line by which a PLY says whether its splats were trained with an antialias filter; none where that is not known. */
export function antialiasComments({ isAntialiased }: SplatSet<Harmonics>): string[] {
  if (isAntialiased === undefined) return [];
  // As Brush says it, and what reads its files understands.
  return [`comment SplatRenderMode: ${isAntialiased ? 'mip' : 'default'}`];
}

/** A file with its header, and what puts rows into it, which must be called for all of them in order. */
function plyOf(
  set: SplatSet<Harmonics>,
  memoryOf = (byteCount: number) => new Uint8Array(byteCount),
): { bytes: Uint8Array<ArrayBuffer>; putRows(from: number, to: number): void } {
  const shValues = coefficientsPerSplat(givenSet(set).harmonics.degree);
  const isWide = set.origin.some((value) => value !== 0);
  const positionBytes = isWide ? 8 : 4;
  const header = new TextEncoder().encode(headerText(set, shValues, isWide ? 'double' : 'float'));
  const stride = 3 * positionBytes + 4 * (3 + shValues + 1 + 3 + 4);
  const bytes = memoryOf(header.length + set.count * stride);
  bytes.set(header);
  const view = new DataView(bytes.buffer);
  const sh = new Float32Array(shValues);
  let offset = header.length;
  const put = (value: number) => {
    view.setFloat32(offset, value, true);
    offset += 4;
  };
  const putRows = (from: number, to: number) => {
    for (let i = from; i < to; i++) {
      for (let axis = 0; axis < 3; axis++) {
        const position = absolute(set.positions[3 * i + axis], set.origin[axis]);
        if (isWide) view.setFloat64(offset, position, true);
        else view.setFloat32(offset, position, true);
        offset += positionBytes;
      }
      for (let channel = 0; channel < 3; channel++) put(set.colorDc[3 * i + channel]);
      readCoefficients(set.harmonics, i, sh);
      for (let channel = 0; channel < 3; channel++) for (let k = channel; k < shValues; k += 3) put(sh[k]);
      put(set.opacityLogits[i]);
      for (let axis = 0; axis < 3; axis++) put(set.logScales[3 * i + axis]);
      for (let part = 0; part < 4; part++) put(set.rotations[4 * i + part]);
    }
  };
  return { bytes, putRows };
}

/** −0 would become +0 if 0 were added. */
function absolute(position: number, origin: number): number {
  return origin === 0 ? position : position + origin;
}

function headerText(set: SplatSet<Harmonics>, shValues: number, positionType: 'float' | 'double'): string {
  const floats = [
    ...names('f_dc', 3),
    ...names('f_rest', shValues),
    'opacity',
    ...names('scale', 3),
    ...names('rot', 4),
  ];
  return [
    'ply',
    'format binary_little_endian 1.0',
    ...antialiasComments(set),
    `element vertex ${set.count}`,
    ...['x', 'y', 'z'].map((name) => `property ${positionType} ${name}`),
    ...floats.map((name) => `property float ${name}`),
    'end_header',
    '',
  ].join('\n');
}

function names(stem: string, count: number): string[] {
  return Array.from({ length: count }, (_, i) => `${stem}_${i}`);
}
