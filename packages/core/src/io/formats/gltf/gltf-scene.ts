import { identity4, type Mat4, multiply4 } from '../../../data/math/mat4.ts';
import { type GltfJson, type JsonObject, objectOf } from './gltf-json.ts';

/** Draws a mesh at many places; the instances are not read. */
const INSTANCING = 'EXT_mesh_gpu_instancing';

/** A mesh with the transformation of a node. */
export interface PlacedMesh {
  readonly mesh: unknown;
  /** JSON path of the node, for messages. */
  readonly element: string;
  /** Whether the node uses EXT_mesh_gpu_instancing. */
  readonly isInstanced: boolean;
  /** Transformation from mesh space to scene space. */
  readonly matrix: Mat4;
}

interface Visit {
  readonly index: unknown;
  /** Referring element, for messages. */
  readonly user: string;
  readonly parent: Mat4;
}

/**
 * Lists the meshes of a glTF's default scene. If there is no default, the first scene is used;
 * without scenes, all nodes.
 *
 * @throws SplatFileError 'bad-header'; 'damaged' if the nodes do not form trees.
 */
export function meshesOfScene(json: GltfJson): PlacedMesh[] {
  const meshes: PlacedMesh[] = [];
  const visited = new Set<unknown>();
  // A stack instead of recursion: chains of nodes may have any length.
  const toVisit = rootsOf(json).reverse();
  for (let visit = toVisit.pop(); visit; visit = toVisit.pop()) {
    const { index, user, parent } = visit;
    const node = json.entryOf('nodes', index, user);
    const element = `nodes[${index}]`;
    if (visited.has(index)) {
      const message = `${element} hangs below two nodes, or below itself; each may do so once. Export it again.`;
      throw json.error('damaged', message, { element });
    }
    visited.add(index);
    const matrix = isMoved(node) ? multiply4(parent, localMatrix(json, node, element)) : parent;
    const isInstanced = objectOf(node.extensions)[INSTANCING] !== undefined;
    if (node.mesh !== undefined) meshes.push({ mesh: node.mesh, element, matrix, isInstanced });
    const children = json.listOf(node, 'children', element);
    for (let i = children.length - 1; i >= 0; i--)
      toVisit.push({ index: children[i], user: element, parent: matrix });
  }
  return meshes;
}

function rootsOf(json: GltfJson): Visit[] {
  const parent = identity4();
  const { root } = json;
  if (json.listOf(root, 'scenes').length > 0) {
    const index = root.scene ?? 0;
    const scene = json.entryOf('scenes', index, 'the file');
    const user = `scenes[${index}]`;
    return json.listOf(scene, 'nodes', user).map((node) => ({ index: node, user, parent }));
  }
  const nodes = json.listOf(root, 'nodes');
  const children = new Set(nodes.flatMap((node) => json.listOf(objectOf(node), 'children', 'nodes')));
  return [...nodes.keys()]
    .filter((index) => !children.has(index))
    .map((index) => ({ index, user: 'the file', parent }));
}

function isMoved({ matrix, translation, rotation, scale }: JsonObject): boolean {
  return (matrix ?? translation ?? rotation ?? scale) !== undefined;
}

/** The node's matrix, or the product of its translation, rotation and scale. */
function localMatrix(json: GltfJson, node: JsonObject, element: string): Mat4 {
  const matrix = json.numbersOf(node, 'matrix', 16, element);
  if (matrix) {
    const isAffine = [0, 0, 0, 1].every((value, column) => matrix[4 * column + 3] === value);
    if (isAffine) return Float64Array.from(matrix);
    const message = `the last row of the matrix of ${element} is not 0, 0, 0, 1. Export it again.`;
    throw json.error('bad-header', message, { element, property: 'matrix' });
  }
  const [tx, ty, tz] = json.numbersOf(node, 'translation', 3, element) ?? [0, 0, 0];
  const [x, y, z, w] = json.numbersOf(node, 'rotation', 4, element) ?? [0, 0, 0, 1];
  const [sx, sy, sz] = json.numbersOf(node, 'scale', 3, element) ?? [1, 1, 1];
  // Normalises quaternions, whose rounding error would scale the splats.
  const twice = 2 / (x * x + y * y + z * z + w * w);
  if (!Number.isFinite(twice)) {
    const message = `the rotation of ${element} is no unit quaternion. Export it again.`;
    throw json.error('bad-header', message, { element, property: 'rotation' });
  }
  return Float64Array.of(
    ...[sx * (1 - twice * (y * y + z * z)), sx * twice * (x * y + w * z), sx * twice * (x * z - w * y), 0],
    ...[sy * twice * (x * y - w * z), sy * (1 - twice * (x * x + z * z)), sy * twice * (y * z + w * x), 0],
    ...[sz * twice * (x * z + w * y), sz * twice * (y * z - w * x), sz * (1 - twice * (x * x + y * y)), 0],
    ...[tx, ty, tz, 1],
  );
}
