import type { Mat4 } from '../../../data/math/mat4.ts';
import { originOfSamples } from '../../../data/packing/origin.ts';
import { sampledRows } from '../../../data/packing/position-sample.ts';
import { shown } from '../../../data/printable.ts';
import type { FileFacts } from '../../../data/splats/splat-set.ts';
import { isGlb, unpackGlb } from '../../containers/glb.ts';
import { readAll } from '../../sources/read-all.ts';
import type { ReadFormat } from '../read-format.ts';
import { type DecodedRows, deliverRows } from '../rows/decoded-rows.ts';
import { joinedRows } from '../rows/joined-rows.ts';
import { ReadProgress } from '../rows/progress.ts';
import { GltfBuffers } from './gltf-buffers.ts';
import { GltfJson, type JsonObject, objectOf } from './gltf-json.ts';
import { meshesOfScene, type PlacedMesh } from './gltf-scene.ts';
import { SPLATTING } from './gltf-semantics.ts';
import { isIdentity, placedPoint, placedRows, reasonNotToPlace } from './placed-rows.ts';
import { isSplats, type SplatPrimitive, splatPrimitiveOf } from './splat-primitive.ts';

/**
 * Limit of splats per byte of the file. Nodes can repeat a mesh and attributes can share bytes, so
 * a few bytes could become any number of splats. A splat has at least 28 bytes: about sixty copies
 * of each are accepted.
 */
const MOST_ROWS_PER_BYTE = 2;
/** This many splats are always accepted. */
const HARMLESS_ROWS = 2 ** 19;
/** Each placement takes time, even for few splats. */
const MOST_PLACES = 2 ** 14;

/** The splats in the scene of a glTF. */
interface GltfSplats {
  readonly rows: DecodedRows;
  /** Whether any splats must be blended in order of distance instead of depth. */
  readonly isSortedByDistance: boolean;
  /** See `FileFacts`; without duplicates. */
  readonly notes: readonly string[];
  /** Number of the scene's primitives that are not splats. */
  readonly otherCount: number;
}

const INSTANCED_NOTE =
  'Its instances (EXT_mesh_gpu_instancing) are left out: splats are shown once for each node.';

/**
 * Reads the splats of a glTF 2.0 with KHR_gaussian_splatting. All meshes of the scene are
 * transformed by their nodes to scene space, with y up. Other geometry is ignored.
 *
 * Rejects with `SplatFileError`, `SplatSourceError`, or the signal's reason.
 */
export const read: ReadFormat = async (input, options, rowsTo) => {
  const { reader, name, isLocal, totalBytes } = input;
  const progress = new ReadProgress(input, options.onProgress);
  const bytes = await readAll(reader, undefined, isLocal ? totalBytes : 0, progress.arrived);
  const isBinary = isGlb(bytes);
  const chunks = isBinary ? unpackGlb(bytes, name) : { json: bytes };
  const json = new GltfJson(chunks.json, name);
  const splats = await splatsOf(json, new GltfBuffers(json, chunks.binary, input, options, progress));
  const fileFacts = factsOf(json, isBinary, splats);
  return deliverRows({ ...splats.rows, fileFacts }, input, options, rowsTo, progress);
};

async function splatsOf(json: GltfJson, buffers: GltfBuffers): Promise<GltfSplats> {
  const meshes = meshesOfScene(json);
  const { splatsByMesh, otherCount } = splatsOfMeshes(json, meshes);
  const readByMesh = new Map<unknown, SplatPrimitive[]>();
  const parts: PlacedPrimitive[] = [];
  const notes = new Set<string>();
  let isSortedByDistance = false;
  let unpackedBytes = 0;
  let rowCount = 0;
  for (const { mesh, element, matrix, isInstanced } of meshes) {
    let primitives = readByMesh.get(mesh);
    if (!primitives) {
      primitives = [];
      for (const [name, primitive] of splatsByMesh.get(mesh)!) {
        primitives.push(await splatPrimitiveOf(json, buffers, primitive, name));
        unpackedBytes += primitives.at(-1)!.unpackedBytes;
        if (unpackedBytes > buffers.mostUnpackedBytes) {
          const message = `its splats unpack to ${unpackedBytes} bytes or more, out of ${buffers.byteCount}. Pass a larger maxBytes if that is right.`;
          throw json.error('too-large', message, { element: name });
        }
      }
      readByMesh.set(mesh, primitives);
    }
    if (primitives.length === 0) continue;
    if (isInstanced) notes.add(INSTANCED_NOTE);
    const reason = reasonNotToPlace(matrix);
    if (reason) {
      const message = `${element} cannot place splats: ${reason}. Apply its transformation to them, and export it again.`;
      throw json.error('bad-property', message, { element, property: 'matrix' });
    }
    for (const primitive of primitives) {
      rowCount += primitive.count;
      const byteCount = buffers.byteCount + buffers.unpackedBytes + unpackedBytes;
      if (rowCount > Math.max(HARMLESS_ROWS, MOST_ROWS_PER_BYTE * byteCount)) {
        const message = `its nodes show ${rowCount} splats or more, in ${parts.length + 1} places, out of ${byteCount} bytes. Show them less often.`;
        throw json.error('too-large', message, { element });
      }
      isSortedByDistance ||= primitive.isSortedByDistance;
      for (const note of primitive.notes ?? []) notes.add(note);
      parts.push({ primitive, matrix });
    }
  }
  if (parts.length > 0) {
    const rows = joinedRows(rowsOf(parts, rowCount));
    return { rows, isSortedByDistance, notes: [...notes], otherCount };
  }
  const found =
    otherCount > 0
      ? `its scene has ${otherCount} primitives, all of them without`
      : 'nothing in its scene has';
  throw json.error('not-splats', ['is a glTF without splats', `${found} ${SPLATTING}`]);
}

/** Splats with the transformation of a node. */
interface PlacedPrimitive {
  readonly primitive: SplatPrimitive;
  readonly matrix: Mat4;
}

/** Rows of all parts; relative to one common origin, if any part is transformed. */
function rowsOf(parts: readonly PlacedPrimitive[], rowCount: number): DecodedRows[] {
  if (parts.every(({ matrix }) => isIdentity(matrix))) return parts.map(({ primitive }) => primitive.rows());
  const origin = originOfSamples(sampledPositions(parts, rowCount));
  return parts.map(({ primitive, matrix }) => placedRows(primitive.rows(), matrix, origin));
}

/** Positions sampled from all parts: 3N float64 coordinates in scene space. */
function sampledPositions(parts: readonly PlacedPrimitive[], rowCount: number): Float64Array {
  const rows = sampledRows(rowCount);
  const positions = new Float64Array(3 * rows.length);
  let part = 0;
  let firstRow = 0;
  for (const [i, row] of rows.entries()) {
    while (row >= firstRow + parts[part].primitive.count) firstRow += parts[part++].primitive.count;
    const { primitive, matrix } = parts[part];
    positions.set(placedPoint(primitive.positionOf(row - firstRow), matrix), 3 * i);
  }
  return positions;
}

interface MeshSplats {
  /** Splat primitives per mesh, by their names in messages. */
  readonly splatsByMesh: ReadonlyMap<unknown, ReadonlyMap<string, JsonObject>>;
  /** Number of primitives that are not splats. */
  readonly otherCount: number;
}

/**
 * Finds the splat primitives of meshes. @throws SplatFileError 'too-large' if there are too many
 * placements.
 */
function splatsOfMeshes(json: GltfJson, meshes: readonly PlacedMesh[]): MeshSplats {
  const splatsByMesh = new Map<unknown, Map<string, JsonObject>>();
  let otherCount = 0;
  let placeCount = 0;
  for (const { mesh: index, element } of meshes) {
    let splats = splatsByMesh.get(index);
    if (!splats) {
      splats = new Map();
      const mesh = json.entryOf('meshes', index, element);
      for (const [i, entry] of json.listOf(mesh, 'primitives', `meshes[${index}]`).entries()) {
        const primitive = objectOf(entry);
        if (isSplats(primitive)) splats.set(`meshes[${index}].primitives[${i}]`, primitive);
        else otherCount++;
      }
      splatsByMesh.set(index, splats);
    }
    placeCount += splats.size;
  }
  if (placeCount <= MOST_PLACES) return { splatsByMesh, otherCount };
  const message = `its nodes show splats in ${placeCount} places; at most ${MOST_PLACES} are read. Export it with fewer, larger primitives.`;
  throw json.error('too-large', message);
}

function factsOf(
  json: GltfJson,
  isBinary: boolean,
  { isSortedByDistance, notes: ofSplats, otherCount }: GltfSplats,
): FileFacts {
  const { generator } = objectOf(json.root.asset);
  const notes = [...ofSplats];
  if (otherCount > 0)
    notes.push(`${otherCount} other primitive${otherCount === 1 ? ' is' : 's are'} left out.`);
  return {
    format: 'gltf',
    variant: isBinary ? 'glb' : 'gltf',
    ...(typeof generator === 'string' && { writer: shown(generator) }),
    ...(isSortedByDistance && { isSortedByDistance }),
    ...(notes.length > 0 && { notes }),
  };
}
