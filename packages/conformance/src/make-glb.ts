import type { SplatSet } from '@websplatter/core';

/** A node of a glTF, whose child is the next one. */
export interface GlbNode {
  /** 16 numbers, column-major. */
  readonly matrix: readonly number[];
}

const SPLATTING = 'KHR_gaussian_splatting';
const DEGREE_COEFFICIENTS = [1, 3, 5, 7];

/**
 * Encodes `set` as a binary glTF by KHR_gaussian_splatting, in float32, below a chain of nodes; the
 * last one shows the splats.
 *
 * @param set about the origin 0, and of opacities that float32 can hold.
 */
export function glbOf(set: SplatSet, nodes: readonly GlbNode[]): Uint8Array<ArrayBuffer> {
  const { count } = set;
  const views: Float32Array[] = [];
  const attributes: Record<string, number> = {};
  const accessors: object[] = [];
  const add = (
    semantic: string,
    type: 'SCALAR' | 'VEC3' | 'VEC4',
    numberAt: (row: number, i: number) => number,
  ) => {
    const size = { SCALAR: 1, VEC3: 3, VEC4: 4 }[type];
    views.push(
      Float32Array.from({ length: size * count }, (_, k) => numberAt(Math.floor(k / size), k % size)),
    );
    attributes[semantic] = accessors.length;
    accessors.push({ bufferView: accessors.length, componentType: 5126, count, type });
  };
  add('POSITION', 'VEC3', (row, i) => set.positions[3 * row + i]);
  add(`${SPLATTING}:ROTATION`, 'VEC4', (row, i) => set.rotations[4 * row + ((i + 1) % 4)]);
  add(`${SPLATTING}:SCALE`, 'VEC3', (row, i) => Math.exp(set.logScales[3 * row + i]));
  add(`${SPLATTING}:OPACITY`, 'SCALAR', (row) => 1 / (1 + Math.exp(-set.opacityLogits[row])));
  add(`${SPLATTING}:SH_DEGREE_0_COEF_0`, 'VEC3', (row, i) => set.colorDc[3 * row + i]);
  const { degree, coefficients } = set.harmonics;
  const width = coefficients.length / count;
  for (let l = 1, k = 0; l <= degree; l++)
    for (let n = 0; n < DEGREE_COEFFICIENTS[l]; n++, k++) {
      const first = 3 * k;
      add(`${SPLATTING}:SH_DEGREE_${l}_COEF_${n}`, 'VEC3', (row, i) => coefficients[width * row + first + i]);
    }
  let byteOffset = 0;
  const bufferViews = views.map(({ byteLength }) => {
    const view = { buffer: 0, byteOffset, byteLength };
    byteOffset += byteLength;
    return view;
  });
  const extension = { kernel: 'ellipse', colorSpace: 'srgb_rec709_display', sortingMethod: 'zDepth' };
  const primitive = { mode: 0, attributes, extensions: { [SPLATTING]: extension } };
  const json = {
    ...{ asset: { version: '2.0' }, extensionsUsed: [SPLATTING], scene: 0, scenes: [{ nodes: [0] }] },
    nodes: nodes.map(({ matrix }, i) => ({
      matrix,
      ...(i < nodes.length - 1 ? { children: [i + 1] } : { mesh: 0 }),
    })),
    ...{
      meshes: [{ primitives: [primitive] }],
      accessors,
      bufferViews,
      buffers: [{ byteLength: byteOffset }],
    },
  };
  return glbBytes(JSON.stringify(json), views, byteOffset);
}

function glbBytes(
  json: string,
  views: readonly Float32Array[],
  binaryBytes: number,
): Uint8Array<ArrayBuffer> {
  const text = new TextEncoder().encode(json.padEnd(4 * Math.ceil(json.length / 4)));
  const bytes = new Uint8Array(12 + 8 + text.length + 8 + binaryBytes);
  const words = new DataView(bytes.buffer);
  const header = [0x46546c67, 2, bytes.length, text.length, 0x4e4f534a];
  for (const [i, word] of header.entries()) words.setUint32(4 * i, word, true);
  bytes.set(text, 20);
  words.setUint32(20 + text.length, binaryBytes, true);
  words.setUint32(24 + text.length, 0x004e4942, true);
  let at = 28 + text.length;
  for (const view of views) {
    bytes.set(new Uint8Array(view.buffer), at);
    at += view.byteLength;
  }
  return bytes;
}
