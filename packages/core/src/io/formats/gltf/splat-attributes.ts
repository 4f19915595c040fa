import type { Vec3 } from '../../../data/math/mat4.ts';
import { shown } from '../../../data/printable.ts';
import { logitOf } from '../../../data/splats/color-values.ts';
import { ROW_SLOT } from '../../../data/splats/splat-row.ts';
import { SH_REST_COEFFICIENTS, type ShDegree } from '../../../data/splats/splat-set.ts';
import { type DecodedRows, rowLength } from '../rows/decoded-rows.ts';
import { logScaleOf } from '../rows/flat-scale.ts';
import { leftOutBands } from '../rows/left-out-bands.ts';
import {
  type AccessorColumn,
  type AttributeRule,
  columnOf,
  copyRows,
  rowCountOf,
} from './accessor-column.ts';
import type { GltfBuffers } from './gltf-buffers.ts';
import type { GltfJson, JsonObject } from './gltf-json.ts';
import { harmonicsSemantics, SPLATTING } from './gltf-semantics.ts';

/**
 * Attribute rules of the extension, and of KHR_mesh_quantization for POSITION. Scales and opacities
 * are linear; rotations are x, y, z, w.
 */
const RULES = {
  position: {
    semantic: 'POSITION',
    type: 'VEC3',
    kinds: ['float', 'signed', 'signed normalized', 'unsigned', 'unsigned normalized'],
  },
  scale: {
    semantic: `${SPLATTING}:SCALE`,
    type: 'VEC3',
    // The last type is from drafts.
    kinds: ['float', 'unsigned', 'unsigned normalized', 'signed normalized'],
  },
  rotation: { semantic: `${SPLATTING}:ROTATION`, type: 'VEC4', kinds: ['float', 'signed normalized'] },
  opacity: { semantic: `${SPLATTING}:OPACITY`, type: 'SCALAR', kinds: ['float', 'unsigned normalized'] },
} as const satisfies Readonly<Record<string, AttributeRule>>;
const HARMONICS = new RegExp(`^${SPLATTING}:SH_DEGREE_(\\d{1,2})_COEF_\\d+$`);
/** Rows per block: they stay in the L1 cache while column after column is copied. */
const ROWS_AT_ONCE = 128;

interface PlacedColumn {
  readonly column: AccessorColumn;
  /** Index within a row. */
  readonly slot: number;
}

/** Splats as attributes of a primitive. Their rows can be read repeatedly. */
export interface SplatAttributes {
  readonly count: number;
  readonly shDegree: ShDegree;
  /** Note about ignored bands; undefined if all are read. */
  readonly note: string | undefined;
  /** The column of positions is the first. */
  readonly columns: readonly PlacedColumn[];
}

/**
 * Locates the attributes of a splat primitive.
 *
 * Rejects with SplatFileError 'not-splats', 'bad-property', and as `columnOf`.
 *
 * @param element JSON path of the primitive, for messages.
 */
export async function splatAttributesOf(
  json: GltfJson,
  buffers: GltfBuffers,
  attributes: JsonObject,
  element: string,
): Promise<SplatAttributes> {
  const fileDegree = degreesIn(attributes).reduce((most, degree) => Math.max(most, degree), 0);
  const shDegree = shDegreeOf(json, attributes, element);
  const rules = [
    { ...RULES.position, slot: ROW_SLOT.position },
    { ...RULES.scale, slot: ROW_SLOT.logScale },
    { ...RULES.rotation, slot: ROW_SLOT.rotation },
    { ...RULES.opacity, slot: ROW_SLOT.opacity },
    ...harmonicsSemantics(shDegree).map((semantic, k) => ({
      semantic,
      type: 'VEC3' as const,
      // The second type is from drafts.
      kinds: ['float', 'signed normalized'] as const,
      slot: k === 0 ? ROW_SLOT.colorDc : ROW_SLOT.harmonics + 3 * (k - 1),
    })),
  ];
  const missing = rules
    .map(({ semantic }) => semantic)
    .filter((semantic) => attributes[semantic] === undefined);
  if (missing.length > 0) {
    const names = missing.map((semantic) => semantic.replace(`${SPLATTING}:`, '')).join(', ');
    const advice = 'Drafts of the extension had others; export it again.';
    const message = `${element} lacks ${shown(names)}, which splats need. ${advice}`;
    throw json.error('not-splats', message, { element });
  }
  const count = rowCountOf(json, attributes.POSITION, element);
  const columns: PlacedColumn[] = [];
  for (const { slot, ...rule } of rules) {
    columns.push({ slot, column: await columnOf(json, buffers, attributes[rule.semantic], rule, count) });
  }
  return { count, shDegree, note: leftOutBands(fileDegree), columns };
}

/** Degrees of the harmonics attributes, one per coefficient. */
function degreesIn(attributes: JsonObject): number[] {
  return Object.keys(attributes).flatMap((semantic) => {
    const match = HARMONICS.exec(semantic);
    return match ? Number(match[1]) : [];
  });
}

/** The highest readable degree, at most 3. */
function shDegreeOf(json: GltfJson, attributes: JsonObject, element: string): ShDegree {
  const found = degreesIn(attributes).filter((degree) => degree <= 3);
  for (const degree of [0, 1, 2, 3] as const) {
    const expected = harmonicsSemantics(degree);
    if (found.length > expected.length) continue;
    const missing = expected.filter((semantic) => attributes[semantic] === undefined);
    // A primitive without any harmonics is reported with its other missing attributes.
    if (missing.length === 0 || degree === 0) return degree;
    const message = `${element} has ${found.length} coefficients of spherical harmonics, and lacks ${missing[0]}; degrees must be whole.`;
    throw json.error('bad-property', message, { element, property: missing[0] });
  }
  const most = SH_REST_COEFFICIENTS[3] + 1;
  const message = `${element} has ${found.length} coefficients of spherical harmonics; degree 3, the highest, has ${most}.`;
  throw json.error('bad-property', message, { element });
}

/** Rows of the splats, from the first. */
export function attributeRows({ count, shDegree, columns }: SplatAttributes): DecodedRows {
  const length = rowLength(shDegree);
  let next = 0;
  return {
    count,
    shDegree,
    decode(values, rowCount) {
      for (let done = 0; done < rowCount; done += ROWS_AT_ONCE) {
        const rows = Math.min(ROWS_AT_ONCE, rowCount - done);
        const start = done * length;
        for (const { column, slot } of columns) copyRows(column, next, rows, values, start + slot, length);
        for (let row = 0; row < rows; row++) undoActivations(values, start + row * length);
        next += rows;
      }
    },
  };
}

/** Position of a splat, equal to its row's. */
export function attributePosition({ columns }: SplatAttributes, row: number): Vec3 {
  const [{ column }] = columns;
  const position = new Float32Array(3);
  copyRows(column, row, 1, position, 0, 3);
  return [position[0], position[1], position[2]];
}

/** Inverts activations: scales to logarithms, opacities to logits, rotations to w, x, y, z. */
function undoActivations(values: Float32Array, at: number): void {
  for (let i = at + ROW_SLOT.logScale; i < at + ROW_SLOT.logScale + 3; i++) values[i] = logScaleOf(values[i]);
  values[at + ROW_SLOT.opacity] = logitOf(values[at + ROW_SLOT.opacity]);
  const rotation = at + ROW_SLOT.rotation;
  const w = values[rotation + 3];
  values[rotation + 3] = values[rotation + 2];
  values[rotation + 2] = values[rotation + 1];
  values[rotation + 1] = values[rotation];
  values[rotation] = w;
}
