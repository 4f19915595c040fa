import { shown } from '../../../data/printable.ts';
import type { GltfBuffers } from './gltf-buffers.ts';
import type { GltfJson, JsonObject } from './gltf-json.ts';

type ColumnValues = Float32Array | Int8Array | Uint8Array | Int16Array | Uint16Array;

/** The values of an accessor, as a view of the file. */
export interface AccessorColumn {
  readonly values: ColumnValues;
  /** Numbers per row, contiguous. */
  readonly size: number;
  /** Numbers from one row to the next. */
  readonly stride: number;
  /** Factor of each number; below 1 for normalized integers. */
  readonly factor: number;
  /** Lower clamp: in signed normalized integers, the two lowest values both mean −1. */
  readonly least: number;
}

type NumberKind = 'float' | 'unsigned' | 'unsigned normalized' | 'signed' | 'signed normalized';

/** Component types and element sizes allowed for an attribute. */
export interface AttributeRule {
  readonly semantic: string;
  readonly type: 'SCALAR' | 'VEC3' | 'VEC4';
  readonly kinds: readonly NumberKind[];
}

const SIZES = { SCALAR: 1, VEC3: 3, VEC4: 4 } as const;

interface Component {
  readonly Values: {
    new (buffer: ArrayBuffer, byteOffset: number, length: number): ColumnValues;
    readonly BYTES_PER_ELEMENT: number;
  };
  readonly kind: 'float' | 'unsigned' | 'signed';
  /** Integer that means 1 when normalized. */
  readonly one: number;
}

const COMPONENTS: ReadonlyMap<unknown, Component> = new Map<unknown, Component>([
  [5120, { Values: Int8Array, kind: 'signed', one: 127 }],
  [5121, { Values: Uint8Array, kind: 'unsigned', one: 255 }],
  [5122, { Values: Int16Array, kind: 'signed', one: 32767 }],
  [5123, { Values: Uint16Array, kind: 'unsigned', one: 65535 }],
  [5126, { Values: Float32Array, kind: 'float', one: 1 }],
]);

/** Row count stated by an accessor. */
export function rowCountOf(json: GltfJson, index: unknown, user: string): number {
  return json.countOf(json.entryOf('accessors', index, user), 'count', `accessors[${index}]`);
}

/**
 * Locates the values of an attribute and checks that all `rowCount` rows are present.
 *
 * Rejects with SplatFileError 'bad-property', 'damaged'; and as `GltfBuffers.view`.
 *
 * @param index index of its accessor.
 */
export async function columnOf(
  json: GltfJson,
  buffers: GltfBuffers,
  index: unknown,
  rule: AttributeRule,
  rowCount: number,
): Promise<AccessorColumn> {
  const { semantic, type } = rule;
  const accessor = json.entryOf('accessors', index, semantic);
  const element = `accessors[${index}]`;
  const fail = (code: 'bad-property' | 'damaged', message: string): never => {
    throw json.error(code, `${element} ${message} Export it again.`, { element, property: semantic });
  };
  const component = COMPONENTS.get(accessor.componentType);
  const kind = kindOf(component, accessor);
  if (accessor.type !== type || component === undefined || kind === undefined || !rule.kinds.includes(kind)) {
    const found = `${shown(accessor.type)} of ${kind ?? `component type ${shown(accessor.componentType)}`}`;
    return fail('bad-property', `is ${found}; ${semantic} must be ${type} of ${rule.kinds.join(' or ')}.`);
  }
  if (accessor.sparse !== undefined) return fail('bad-property', 'is sparse, which is not read for splats.');
  if (accessor.bufferView === undefined) return fail('damaged', 'has no bufferView and so no values.');
  const rows = rowCountOf(json, index, semantic);
  if (rows !== rowCount)
    return fail('damaged', `has ${rows} rows; POSITION of the same splats has ${rowCount}.`);
  const { bytes, strideBytes } = await buffers.view(accessor.bufferView, element);
  const { Values, one } = component;
  const componentBytes = Values.BYTES_PER_ELEMENT;
  const size = SIZES[type];
  const stride = (strideBytes ?? size * componentBytes) / componentBytes;
  const start = json.countOf(accessor, 'byteOffset', element, 0);
  const byteOffset = bytes.byteOffset + start;
  if (!Number.isInteger(stride) || stride < size)
    return fail('damaged', `has rows ${strideBytes} bytes apart, which does not suit their numbers.`);
  if (byteOffset % componentBytes !== 0)
    return fail('damaged', `begins at a byte that is no multiple of ${componentBytes}.`);
  const length = Math.max(0, (rowCount - 1) * stride + size);
  if (!(length * componentBytes <= bytes.length - start)) {
    const needed = `needs ${start + length * componentBytes} bytes of a bufferView that has ${bytes.length}`;
    return fail('damaged', `${needed}.`);
  }
  const isNormalized = kind.endsWith(' normalized');
  return {
    values: new Values(bytes.buffer, byteOffset, length),
    size,
    stride,
    factor: isNormalized ? 1 / one : 1,
    least: isNormalized ? -1 : Number.NEGATIVE_INFINITY,
  };
}

function kindOf(component: Component | undefined, { normalized }: JsonObject): NumberKind | undefined {
  if (component === undefined) return undefined;
  const { kind } = component;
  return kind !== 'float' && normalized === true ? `${kind} normalized` : kind;
}

/**
 * Copies rows of a column into the rows of their splats.
 *
 * @param at index in `target` of the first row's first number.
 * @param targetStride numbers from one row to the next in `target`.
 */
export function copyRows(
  column: AccessorColumn,
  firstRow: number,
  rowCount: number,
  target: Float32Array,
  at: number,
  targetStride: number,
): void {
  if (column.values instanceof Float32Array)
    copyFloats(column.values, column, firstRow, rowCount, target, at, targetStride);
  else copyIntegers(column.values, column, firstRow, rowCount, target, at, targetStride);
}

function copyFloats(
  values: Float32Array,
  { size, stride }: AccessorColumn,
  firstRow: number,
  rowCount: number,
  target: Float32Array,
  at: number,
  targetStride: number,
): void {
  for (let row = 0; row < rowCount; row++) {
    const from = (firstRow + row) * stride;
    const to = at + row * targetStride;
    for (let i = 0; i < size; i++) target[to + i] = values[from + i];
  }
}

function copyIntegers(
  values: ColumnValues,
  { size, stride, factor, least }: AccessorColumn,
  firstRow: number,
  rowCount: number,
  target: Float32Array,
  at: number,
  targetStride: number,
): void {
  for (let row = 0; row < rowCount; row++) {
    const from = (firstRow + row) * stride;
    const to = at + row * targetStride;
    for (let i = 0; i < size; i++) target[to + i] = Math.max(least, values[from + i] * factor);
  }
}
