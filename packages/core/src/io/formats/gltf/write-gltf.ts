import { InvalidArgumentError } from '../../../data/errors.ts';
import { centerBounds } from '../../../data/packing/center-bounds.ts';
import { type Harmonics, readCoefficients } from '../../../data/packing/harmonics.ts';
import { normalizedRotation } from '../../../data/packing/rotation.ts';
import { opacityOf } from '../../../data/splats/color-values.ts';
import { coefficientsPerSplat, type SplatSet } from '../../../data/splats/splat-set.ts';
import { beginGlb } from '../../containers/glb.ts';
import { fileMemory, type WriteFormat, writeInTurns } from '../write-format.ts';
import { BY_DEPTH, harmonicsSemantics, OWN_EXTRAS, SPLATTING } from './gltf-semantics.ts';

const POINTS = 0;
const FLOAT = 5126;
/** The header stores the file's length in 32 bits. */
const MOST_BYTES = 2 ** 32 - 4;

interface Attribute {
  readonly semantic: string;
  /** Numbers per splat. */
  readonly size: 1 | 3 | 4;
}

/**
 * Writes a binary glTF 2.0 with KHR_gaussian_splatting. All attributes are float32, in the set's
 * axes and order. glTF has y up: the caller must have rotated the splats. An origin other than 0
 * becomes the node's translation. `extras` state the sort order by depth, which other readers
 * ignore.
 *
 * Losses: rotations are normalised; scales and opacities are rounded after activation; the
 * antialias flag is dropped.
 *
 * Rejects with InvalidArgumentError 'set' if a scale exceeds float32, or if the file would exceed 4
 * GiB.
 */
export const write: WriteFormat = async (set, options) => {
  const { count, harmonics } = set;
  const attributes: Attribute[] = [
    { semantic: 'POSITION', size: 3 },
    { semantic: `${SPLATTING}:ROTATION`, size: 4 },
    { semantic: `${SPLATTING}:SCALE`, size: 3 },
    { semantic: `${SPLATTING}:OPACITY`, size: 1 },
    ...harmonicsSemantics(harmonics.degree).map((semantic): Attribute => ({ semantic, size: 3 })),
  ];
  const { json, binaryBytes } = describe(set, attributes);
  const { bytes, binary } = beginGlb(json, binaryBytes, (byteCount) => {
    if (byteCount > MOST_BYTES) throw tooLarge(count, byteCount);
    return fileMemory(byteCount);
  });
  let start = binary.byteOffset;
  const [positions, rotations, scales, opacities, colors, ...coefficients] = attributes.map(({ size }) => {
    const column = new Float32Array(bytes.buffer, start, size * count);
    start += column.byteLength;
    return column;
  });
  const rotation = new Float64Array(4);
  const sh = new Float32Array(coefficientsPerSplat(harmonics.degree));
  positions.set(set.positions.subarray(0, 3 * count));
  colors.set(set.colorDc.subarray(0, 3 * count));
  await writeInTurns(count, options, (from, to) => {
    for (let i = from; i < to; i++) {
      normalizedRotation(set.rotations, 4 * i, rotation);
      for (let k = 0; k < 4; k++) rotations[4 * i + k] = rotation[(k + 1) & 3];
      for (let k = 3 * i; k < 3 * i + 3; k++) {
        scales[k] = Math.exp(set.logScales[k]);
        if (scales[k] === Number.POSITIVE_INFINITY) throw tooLong(i, set.logScales[k]);
      }
      opacities[i] = opacityOf(set.opacityLogits[i]);
      readCoefficients(harmonics, i, sh);
      for (let k = 0; k < sh.length; k++) coefficients[Math.floor(k / 3)][3 * i + (k % 3)] = sh[k];
    }
  });
  return bytes;
};

/** The JSON of a glTF with a single node of splats, whose attributes are contiguous. */
function describe(
  set: SplatSet<Harmonics>,
  attributes: readonly Attribute[],
): { readonly json: object; readonly binaryBytes: number } {
  const { count, origin } = set;
  let binaryBytes = 0;
  const bufferViews = attributes.map(({ size }) => {
    const view = { buffer: 0, byteOffset: binaryBytes, byteLength: 4 * size * count };
    binaryBytes += view.byteLength;
    return view;
  });
  const accessors = attributes.map(({ semantic, size }, i) => ({
    bufferView: i,
    componentType: FLOAT,
    count,
    type: size === 1 ? 'SCALAR' : `VEC${size}`,
    // glTF requires bounds of positions.
    ...(semantic === 'POSITION' && centerBounds(set.positions, count)),
  }));
  const isMoved = origin.some((value) => value !== 0);
  const isByDepth = !set.fileFacts?.isSortedByDistance;
  const extension = {
    kernel: 'ellipse',
    colorSpace: 'srgb_rec709_display',
    ...(isByDepth && { extras: { [OWN_EXTRAS]: { sortBy: BY_DEPTH } } }),
  };
  const json = {
    asset: { version: '2.0', generator: 'WebSplatter' },
    extensionsUsed: [SPLATTING],
    scene: 0,
    scenes: [{ nodes: [0] }],
    nodes: [{ mesh: 0, ...(isMoved && { translation: origin }) }],
    meshes: [
      {
        primitives: [
          {
            mode: POINTS,
            attributes: Object.fromEntries(attributes.map(({ semantic }, i) => [semantic, i])),
            extensions: { [SPLATTING]: extension },
          },
        ],
      },
    ],
    buffers: [{ byteLength: binaryBytes }],
    bufferViews,
    accessors,
  };
  return { json, binaryBytes };
}

function tooLong(splat: number, logScale: number): InvalidArgumentError {
  const message = `Splat ${splat} has a scale of e^${logScale}, which float32 cannot hold. Leave it out, or write a PLY.`;
  return new InvalidArgumentError('set', message);
}

function tooLarge(count: number, byteCount: number): InvalidArgumentError {
  const message = `${count} splats make a binary glTF of ${byteCount} bytes; 4 GiB are the most. Write fewer of them, or fewer bands of harmonics.`;
  return new InvalidArgumentError('set', message);
}
