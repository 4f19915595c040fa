import { type FileFinding, SplatFileError } from '../../../data/errors.ts';
import type { PackedHarmonics } from '../../../data/packing/harmonics.ts';
import { colorDcOf } from '../../../data/splats/color-values.ts';
import { ROW_SLOT } from '../../../data/splats/splat-row.ts';
import {
  coefficientsPerSplat,
  type FileFacts,
  type SplatColumns,
  type SplatSet,
} from '../../../data/splats/splat-set.ts';
import { MOTION_VALUES, stillMotion } from '../../../features/motion/splat-motion.data.ts';
import { plyKindOf } from '../first-bytes.ts';
import type { FormatReaders, ReadFormat, SplatFormatOptions, SplatInput } from '../read-format.ts';
import { FLAT_LOG_SCALE } from '../rows/flat-scale.ts';
import { ReadProgress } from '../rows/progress.ts';
import { type Passed, type RowsTo, takesCount } from '../rows/row-sink.ts';
import { checkCount } from '../rows/splat-counts.ts';
import { SplatSetBuilder } from '../rows/splat-set-builder.ts';
import { FILTER_NOTE, FILTER_PROPERTY, fuseFilter } from './fuse-filter.ts';
import { hasPlainColors, motionPropertiesOf } from './motion-properties.ts';
import { readAsciiRows } from './ply-ascii.ts';
import { passRows, readBinaryRows, rowLayoutOf } from './ply-binary.ts';
import {
  clip,
  type PlyBody,
  type PlyElement,
  type PlyHeader,
  type PlyProperty,
  readPlyHeader,
  type ShProperties,
  shPropertiesOf,
  TYPE_BYTES,
} from './ply-header.ts';

/** A readable PLY that lacks properties of the standard layout. */
export interface PlyVariant {
  /** Slots of substitute properties, by name. */
  readonly slotOf?: ReadonlyMap<string, number>;
  /** Constants for slots without a property. */
  readonly defaults: readonly (readonly [slot: number, value: number])[];
  /** See `FileFacts`. */
  readonly note: string | undefined;
  /** Converts substitute values to the missing properties. */
  complete?(set: SplatColumns): void;
}

type VariantOf = (
  header: PlyHeader,
  vertex: PlyElement,
  missing: readonly string[],
) => PlyVariant | undefined;

const SLOT_OF_CORE_PROPERTY = new Map<string, number>([
  ...['x', 'y', 'z'].map((name, i): [string, number] => [name, ROW_SLOT.position + i]),
  ...[0, 1, 2].map((i): [string, number] => [`scale_${i}`, ROW_SLOT.logScale + i]),
  ...[0, 1, 2, 3].map((i): [string, number] => [`rot_${i}`, ROW_SLOT.rotation + i]),
  ['opacity', ROW_SLOT.opacity],
  ...[0, 1, 2].map((i): [string, number] => [`f_dc_${i}`, ROW_SLOT.colorDc + i]),
]);

/** 2DGS: discs instead of ellipsoids. */
const FLAT: PlyVariant = {
  defaults: [[ROW_SLOT.logScale + 2, FLAT_LOG_SCALE]],
  note: 'Its splats have no third scale (2DGS): they are flat.',
};

/** See `FileFacts`. */
const MOVING_NOTE = 'It is a moving scene (Spacetime Gaussians).';

/** Most elements in a message. */
const MOST_LISTED = 8;
/** Wait for small files, in milliseconds: packing on the CPU is faster than compiling shaders for it. */
const SOON_MS = 500;
const WIDE_TYPES: readonly string[] = ['float64', 'int32', 'uint32'];

/**
 * Reads splats from a PLY: ascii or binary of either byte order, with properties in any order and
 * of any scalar type. Other properties and elements are skipped. Memory grows with the rows that
 * arrive, not with the header's promise; bytes after the splats are not read.
 *
 * Properties:
 * - x y z
 * - scale_0…2: natural logarithms
 * - rot_0…3: w x y z
 * - opacity: a logit
 * - f_dc_0…2
 * - f_rest_0…3K−1: K coefficients of red, then green, then blue; K = 0, 3, 8, 15, or more, of which
 *   15 are read
 *
 * - of moving scenes (Spacetime Gaussians): trbf_center, trbf_scale (a natural logarithm), motion_0…8
 *   and omega_0…3; see `motionPropertiesOf`, and `hasPlainColors` for their f_dc
 *
 * Integer types are read as plain numbers. An additional filter_3D is fused into scales and
 * opacities (`fuseFilter`).
 *
 * 2DGS files have no scale_2: their splats are flat. Float16 values are declared as `half` or
 * `float16`. They may also be declared as `uint16` in a binary file, if all needed properties are:
 * plain integers could not be splats.
 *
 * If all rows have one length and all needed properties are float32, raw rows go to `rowsTo`.
 *
 * @returns `passed` if the rows went to `rowsTo`.
 *
 * Rejects with `SplatFileError` (any code; 'unknown-format' for compressed PLY only),
 * `SplatSourceError`, or the signal's reason.
 */
export const read: ReadFormat = (input, options, rowsTo) => readPlyWith(input, options, rowsTo);

/** For threads that read PLY only. */
export const PLY_READERS: FormatReaders = {
  pick: (firstBytes) => (plyKindOf(firstBytes) === 'ply' ? read : null),
};

/** As `read`, with a function that finds substitutes for further missing properties. */
export async function readPlyWith(
  input: SplatInput,
  options: SplatFormatOptions,
  rowsTo: RowsTo | undefined,
  variantOf?: VariantOf,
): Promise<SplatSet<PackedHarmonics> | Passed> {
  const { reader, name: file } = input;
  const declared = await readPlyHeader(reader, file);
  const { vertexIndex, variant } = findVertex(declared, file, variantOf);
  const sh = shPropertiesOf(declared.elements[vertexIndex], file);
  const shDegree = sh.degree;
  const filteredAxes = filteredAxesOf(declared.elements[vertexIndex]);
  const motionSlot = ROW_SLOT.harmonics + coefficientsPerSplat(shDegree);
  const motion = motionPropertiesOf(declared.elements[vertexIndex], file);
  const isMoving = motion.length > 0;
  const isPlain = hasPlainColors(declared.elements[vertexIndex], declared, file);
  const filterSlot = motionSlot + (isMoving ? MOTION_VALUES : 0);
  const slots = slotsOf(
    declared.elements[vertexIndex],
    sh,
    [
      ...motion.map(([name, slot]) => [name, motionSlot + slot] as const),
      ...(filteredAxes > 0 ? [[FILTER_PROPERTY, filterSlot] as const] : []),
    ],
    variant,
    file,
  );
  const header = withHalves(declared, vertexIndex, slots);
  const vertex = header.elements[vertexIndex];
  const body: PlyBody = { file, header, vertexIndex, slots };
  checkCounts(input, header, vertexIndex, reader.byteOffset, options.maxSplats);
  const progress = new ReadProgress(input, options.onProgress);
  const { isAntialiased, writer } = header;
  const notes = [
    variant?.note,
    sh.note,
    filteredAxes > 0 ? FILTER_NOTE : undefined,
    isMoving ? MOVING_NOTE : undefined,
    input.note,
    isPlain ? 'Its f_dc are taken for red, green and blue (lite model), not for harmonics.' : undefined,
  ].filter((note) => note !== undefined);
  const fileFacts: FileFacts = {
    format: 'ply',
    variant: header.format,
    writer,
    notes: notes.length > 0 ? notes : undefined,
  };
  const layout =
    rowsTo &&
    !variant &&
    filteredAxes === 0 &&
    !isMoving &&
    rowLayoutOf(body, shDegree, rowsTo.files.pieceBytes);
  if (
    rowsTo &&
    layout &&
    mayHold(input, vertex.count * layout.strideBytes) &&
    (takesCount(rowsTo.files, vertex.count) ||
      (vertex.count < rowsTo.files.minRows && (await isSlow(input, vertex.count * layout.strideBytes))))
  ) {
    await rowsTo.sink.begin({ ...layout, isAntialiased, fileFacts });
    await passRows(reader, body, layout, rowsTo.sink, progress);
    progress.finish(vertex.count);
    return 'passed';
  }
  const adjust = (row: Float64Array) => {
    if (filteredAxes > 0) fuseFilter(row, filteredAxes, row[filterSlot]);
    for (let slot = ROW_SLOT.colorDc; isPlain && slot < ROW_SLOT.colorDc + 3; slot++)
      row[slot] = colorDcOf(row[slot]);
  };
  const builder = new SplatSetBuilder({
    file,
    shDegree,
    shPrecision: options.shPrecision,
    widePositions: vertex.properties.some(
      ({ name, type }) => /^[xyz]$/.test(name) && WIDE_TYPES.includes(type),
    ),
    promisedCount: vertex.count,
    // Bytes promised by a server or a header may never arrive.
    isLocal: input.isLocal,
    isAntialiased,
    fileFacts,
    optional: isMoving ? ['motion'] : [],
    // `complete` needs all splats at once.
    onPiece: variant?.complete ? undefined : options.onPiece,
    adjust: filteredAxes > 0 || isPlain ? adjust : undefined,
  });
  for (const [slot, value] of variant?.defaults ?? []) builder.row[slot] = value;
  if (isMoving) builder.row.set(stillMotion(1), motionSlot);
  const readRows = header.format === 'ascii' ? readAsciiRows : readBinaryRows;
  await readRows(reader, body, builder, progress);
  progress.finish(builder.count);
  const set = builder.finish();
  variant?.complete?.(set);
  return set;
}

/** Waits briefly for all splats. Returns whether they are too slow, so that partial scenes are shown. */
async function isSlow({ reader, isLocal }: SplatInput, splatBytes: number): Promise<boolean> {
  if (isLocal) return false;
  const endMs = performance.now() + SOON_MS;
  while (reader.available < splatBytes) {
    if (performance.now() >= endMs) return true;
    // At the end of the file, the reader reports the missing rows.
    if (!(await reader.fill(reader.available + 1))) return false;
  }
  return false;
}

/** Finds the element with the splats, and substitutes for missing properties. Throws if there is none. */
function findVertex(
  header: PlyHeader,
  file: string,
  variantOf: VariantOf | undefined,
): { readonly vertexIndex: number; readonly variant: PlyVariant | undefined } {
  const index = header.elements.findIndex((element) => element.name === 'vertex');
  const vertex = header.elements[index];
  const names = new Set(vertex?.properties.map((property) => property.name));
  if (names.has('packed_position')) {
    const finding: FileFinding = [
      'is a compressed PLY (it has packed_position) with an unusual header',
      'move the comments that precede its element chunk to after it',
    ];
    const place = { element: 'vertex', property: 'packed_position' };
    throw new SplatFileError('unknown-format', file, finding, place);
  }
  const missing = [...SLOT_OF_CORE_PROPERTY.keys()].filter((name) => !names.has(name));
  const variant = String(missing) === 'scale_2' ? FLAT : vertex && variantOf?.(header, vertex, missing);
  if (missing.length > 0 && !variant) throw notSplatsError(header, vertex, missing, file);
  return { vertexIndex: index, variant };
}

function notSplatsError(
  header: PlyHeader,
  vertex: PlyElement | undefined,
  missing: readonly string[],
  file: string,
): SplatFileError {
  if (vertex === undefined) {
    const { elements } = header;
    const listed = elements.slice(0, MOST_LISTED).map((element) => clip(element.name));
    if (listed.length < elements.length) listed.push(`and ${elements.length - listed.length} others`);
    const found = listed.join(', ') || 'none';
    return new SplatFileError('not-splats', file, `there is no element vertex; elements found: ${found}.`);
  }
  const finding: FileFinding = [
    describeKind(header, missing),
    `its vertices lack ${missing.join(', ')}. Splats come from Gaussian-splatting training`,
  ];
  return new SplatFileError('not-splats', file, finding, { element: 'vertex' });
}

function describeKind(header: PlyHeader, missing: readonly string[]): string {
  const lacksShape = ['scale_0', 'rot_0', 'f_dc_0'].every((name) => missing.includes(name));
  const isAnchors = header.elements.some(({ properties }) =>
    properties.some(({ name }) => name === 'f_anchor_feat_0'),
  );
  if (isAnchors) return 'is a Scaffold-GS model (its anchors need a network to become splats)';
  if (!lacksShape) return 'has no complete splats';
  const faces = header.elements.find(
    ({ name, count }) => (name === 'face' || name === 'tristrips') && count > 0,
  );
  return faces
    ? `is a mesh (${faces.count} ${faces.name} rows), not splats`
    : 'is a plain point cloud, not splats';
}

/** Number of scales to widen by a filter_3D; 0 if there is no filter, or no scale. */
function filteredAxesOf({ properties }: PlyElement): number {
  const has = (name: string) => properties.some((property) => property.name === name);
  if (!has(FILTER_PROPERTY) || !has('opacity')) return 0;
  const axes = ['scale_0', 'scale_1', 'scale_2'].findIndex((name) => !has(name));
  return axes < 0 ? 3 : axes;
}

/** Builder slot of each property of `vertex`; -1 for unused properties. */
function slotsOf(
  vertex: PlyElement,
  sh: ShProperties,
  beside: readonly (readonly [name: string, slot: number])[],
  variant: PlyVariant | undefined,
  file: string,
): number[] {
  const names = new Set(vertex.properties.map(({ name }) => name));
  // Missing properties have substitutes by now.
  const slotOf = new Map([...SLOT_OF_CORE_PROPERTY].filter(([name]) => names.has(name)));
  for (const [name, slot] of [...beside, ...(variant?.slotOf ?? [])]) slotOf.set(name, slot);
  for (const [i, name] of sh.names.entries()) slotOf.set(name, ROW_SLOT.harmonics + i);
  const fail = (property: string, message: string): never => {
    throw new SplatFileError('bad-property', file, message, { element: 'vertex', property });
  };
  const seen = new Set<string>();
  for (const { name, countType } of vertex.properties) {
    if (!slotOf.has(name)) continue;
    if (countType !== undefined) fail(name, `${name} is a list; it must be one number.`);
    if (seen.has(name)) fail(name, `${name} is declared twice.`);
    seen.add(name);
  }
  const missing = [...slotOf.keys()].find((name) => !seen.has(name));
  if (missing !== undefined) fail(missing, `${missing} is missing though others of its kind are there.`);
  return vertex.properties.map(({ name }) => slotOf.get(name) ?? -1);
}

/** Reinterprets uint16 as float16, if all needed splat properties are uint16. */
function withHalves(header: PlyHeader, vertexIndex: number, slots: readonly number[]): PlyHeader {
  const vertex = header.elements[vertexIndex];
  const isPacked = vertex.properties.every(({ type }, i) => slots[i] < 0 || type === 'uint16');
  if (!isPacked || header.format === 'ascii' || !slots.includes(ROW_SLOT.rotation)) return header;
  const properties = vertex.properties.map((property, i): PlyProperty => {
    return slots[i] < 0 ? property : { ...property, type: 'float16' };
  });
  const elements = header.elements.map((each) => (each === vertex ? { ...vertex, properties } : each));
  return { ...header, elements };
}

/** Whether a source can contain `bytes` bytes. Only then is memory for all rows allocated at once. */
function mayHold({ totalBytes }: SplatInput, bytes: number): boolean {
  return totalBytes !== undefined && totalBytes >= bytes;
}

/** Throws if the source is too small for the promised rows, or if there are too many rows. */
function checkCounts(
  source: SplatInput,
  header: PlyHeader,
  vertexIndex: number,
  bodyStart: number,
  maxSplats: number,
): void {
  const vertex = header.elements[vertexIndex];
  if (vertex.count > 0 && source.totalBytes !== undefined && source.totalBytesCertain) {
    const elements = header.elements.slice(0, vertexIndex + 1);
    const neededBytes = elements.reduce(
      (sum, element) => sum + element.count * leastRowBytes(element, header),
      0,
    );
    // The last line of a text body may lack its line end.
    const availableBytes = source.totalBytes - bodyStart + (header.format === 'ascii' ? 1 : 0);
    if (neededBytes > availableBytes) {
      throw new SplatFileError(
        'truncated',
        source.name,
        `${vertex.count} splats need at least ${neededBytes} bytes after the header, the file has ${availableBytes}. ` +
          'Download or export it again.',
        { element: 'vertex', byte: source.totalBytes, expectedBytes: bodyStart + neededBytes },
      );
    }
  }
  checkCount(vertex.count, source.name, maxSplats, { element: 'vertex' });
}

/** Least bytes per row: lists are empty; a number in text is one digit and a separator. */
function leastRowBytes(element: PlyElement, header: PlyHeader): number {
  if (header.format === 'ascii') return 2 * element.properties.length;
  return element.properties.reduce((sum, { type, countType }) => sum + TYPE_BYTES[countType ?? type], 0);
}
