import type { Vec3 } from '../../../data/math/mat4.ts';
import { shown } from '../../../data/printable.ts';
import type { DecodedRows } from '../rows/decoded-rows.ts';
import { readSpzContents } from '../spz/read-spz.ts';
import { emptyAttributes, type SpzAttributes, spzPosition, spzRows } from '../spz/spz-rows.ts';
import type { GltfBuffers } from './gltf-buffers.ts';
import { type GltfJson, type JsonObject, objectOf, SPZ_COMPRESSIONS } from './gltf-json.ts';
import { BY_DEPTH, FIRST_SPZ, OWN_EXTRAS, SPLATTING } from './gltf-semantics.ts';
import { attributePosition, attributeRows, splatAttributesOf } from './splat-attributes.ts';

const POINTS = 0;
/** Sort order by distance from the camera instead of depth. */
const BY_DISTANCE = 'cameraDistance';

/**
 * Supported property values, the current name first; the others are from drafts, where the first is
 * also the default. `lin_rec709_display`, BT.709-linear in drafts, is missing. Such splats must be
 * blended in linear colours before display encoding. A renderer that blends encoded colours cannot
 * compensate by changing single splats.
 */
const VALUES_READ: Readonly<Record<string, readonly string[]>> = {
  kernel: ['ellipse'],
  colorSpace: ['srgb_rec709_display', 'BT.709-sRGB', 'BT.709-srgb', 'BT.709'],
  projection: ['perspective'],
  sortingMethod: [BY_DISTANCE, 'zDepth'],
};

/** Splats of a primitive. Their rows can be read repeatedly. */
export interface SplatPrimitive {
  readonly count: number;
  /** Bytes unpacked from the buffers for this primitive. */
  readonly unpackedBytes: number;
  /** Whether splats must be blended in order of distance instead of depth. */
  readonly isSortedByDistance: boolean;
  /** See `FileFacts`; undefined if there are none. */
  readonly notes: readonly string[] | undefined;
  rows(): DecodedRows;
  /** Position of a splat, equal to its row's. */
  positionOf(row: number): Vec3;
}

/** Whether a primitive has a splat extension. */
export function isSplats(primitive: JsonObject): boolean {
  const extensions = objectOf(primitive.extensions);
  return extensions[SPLATTING] !== undefined || extensions[FIRST_SPZ] !== undefined;
}

/**
 * Reads the extension of a splat primitive and locates its splats.
 *
 * Rejects with SplatFileError 'bad-property', and as `splatAttributesOf` or, for an embedded .spz,
 * `readSpzContents`.
 *
 * @param element JSON path of the primitive, for messages.
 */
export async function splatPrimitiveOf(
  json: GltfJson,
  buffers: GltfBuffers,
  primitive: JsonObject,
  element: string,
): Promise<SplatPrimitive> {
  const extensions = objectOf(primitive.extensions);
  const extension = objectOf(extensions[SPLATTING]);
  if (primitive.mode !== POINTS) {
    const message = `the mode of ${element} is ${shown(primitive.mode)}; that of splats is 0, points. Export it again.`;
    throw json.error('bad-property', message, { element, property: 'mode' });
  }
  // The first draft defines no sort order, so the usual order by depth is kept.
  if (extensions[SPLATTING] === undefined)
    return spzPrimitiveOf(buffers, objectOf(extensions[FIRST_SPZ]), element, false);
  const [compression, spz] =
    Object.entries(objectOf(extension.extensions)).find(([name]) => SPZ_COMPRESSIONS.includes(name)) ?? [];
  for (const [property, read] of Object.entries(VALUES_READ))
    checkValue(json, extension, property, read, element);
  const { sortBy } = objectOf(objectOf(extension.extras)[OWN_EXTRAS]);
  const isSortedByDistance = (extension.sortingMethod ?? BY_DISTANCE) === BY_DISTANCE && sortBy !== BY_DEPTH;
  if (compression) return spzPrimitiveOf(buffers, objectOf(spz), element, isSortedByDistance);
  const splats = await splatAttributesOf(json, buffers, objectOf(primitive.attributes), element);
  return {
    count: splats.count,
    unpackedBytes: 0,
    isSortedByDistance,
    notes: splats.note === undefined ? undefined : [splats.note],
    rows: () => attributeRows(splats),
    positionOf: (row) => attributePosition(splats, row),
  };
}

/**
 * Reads splats from an .spz in a bufferView. The draft requires other axes than .spz has (left, up,
 * front instead of right, up, back). Writers and readers of such files ignore this, and so does
 * this reader.
 */
async function spzPrimitiveOf(
  buffers: GltfBuffers,
  { bufferView }: JsonObject,
  element: string,
  isSortedByDistance: boolean,
): Promise<SplatPrimitive> {
  const { header, attributes } = await buffers.readView(bufferView, element, readSpzContents);
  return {
    count: header.count,
    unpackedBytes: Object.values(attributes).reduce((sum, { bytes }) => sum + bytes.length, 0),
    isSortedByDistance,
    notes: spzRows(header, attributes, null).fileFacts?.notes,
    rows: () => spzRows(header, fromTheFirst(attributes), null),
    positionOf: (row) => spzPosition(header, attributes.positions, row),
  };
}

/** A copy with its own read positions, so that several nodes can decode the same splats. */
function fromTheFirst(attributes: SpzAttributes): SpzAttributes {
  const copy = emptyAttributes();
  for (const name of Object.keys(copy) as (keyof SpzAttributes)[]) copy[name] = { ...attributes[name] };
  return copy;
}

function checkValue(
  json: GltfJson,
  extension: JsonObject,
  property: string,
  read: readonly string[],
  element: string,
): void {
  const value = extension[property];
  if (value === undefined || (typeof value === 'string' && read.includes(value))) return;
  const message = `${property} of ${element} is ${shown(value)}; only ${read.join(' or ')} can be drawn as meant.`;
  throw json.error('bad-property', message, { element, property });
}
