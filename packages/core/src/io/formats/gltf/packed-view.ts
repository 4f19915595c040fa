import { shown } from '../../../data/printable.ts';
import type { PackedView } from '../../containers/meshopt.ts';
import { type GltfJson, type JsonObject, MESHOPT_COMPRESSIONS, objectOf } from './gltf-json.ts';

/** Larger views would exhaust WebAssembly's 4 GiB. */
const MOST_UNPACKED_BYTES = 2 ** 30;

/** Element sizes in bytes allowed by each filter, and by each mode other than ATTRIBUTES. */
const STRIDES: Readonly<Record<string, (strideBytes: number) => boolean>> = {
  NONE: () => true,
  OCTAHEDRAL: (bytes) => bytes === 4 || bytes === 8,
  QUATERNION: (bytes) => bytes === 8,
  EXPONENTIAL: () => true,
  COLOR: (bytes) => bytes === 4 || bytes === 8,
};
const MODES: Readonly<Record<string, (strideBytes: number) => boolean>> = {
  ATTRIBUTES: (bytes) => bytes % 4 === 0 && bytes > 0 && bytes <= 256,
  TRIANGLES: (bytes) => bytes === 2 || bytes === 4,
  INDICES: (bytes) => bytes === 2 || bytes === 4,
};

/** The meshopt extension object of a bufferView; undefined if the view is not compressed. */
export function meshoptOf(view: JsonObject): JsonObject | undefined {
  const extensions = objectOf(view.extensions);
  const name = MESHOPT_COMPRESSIONS.find((each) => extensions[each] !== undefined);
  return name === undefined ? undefined : objectOf(extensions[name]);
}

/**
 * Checks the meshopt parameters of a bufferView.
 *
 * @param packed result of `meshoptOf`.
 * @throws SplatFileError 'bad-header', 'bad-property', 'damaged', 'too-large'.
 */
export function packedViewOf(
  json: GltfJson,
  view: JsonObject,
  packed: JsonObject,
  element: string,
): Omit<PackedView, 'bytes'> {
  const count = json.countOf(packed, 'count', element);
  const strideBytes = json.countOf(packed, 'byteStride', element);
  const { mode, filter = 'NONE' } = packed;
  if (typeof mode !== 'string' || !Object.hasOwn(MODES, mode)) throw unknown('mode', mode, MODES);
  if (typeof filter !== 'string' || !Object.hasOwn(STRIDES, filter)) throw unknown('filter', filter, STRIDES);
  const suits =
    MODES[mode](strideBytes) &&
    STRIDES[filter](strideBytes) &&
    (filter === 'NONE' || mode === 'ATTRIBUTES') &&
    (mode !== 'TRIANGLES' || count % 3 === 0);
  if (!suits) {
    const found = `${count} elements of ${strideBytes} bytes, ${mode}, filter ${filter}`;
    throw json.error('bad-property', `${element} is packed as no meshopt is: ${found}. Export it again.`, {
      element,
    });
  }
  const bytes = count * strideBytes;
  if (bytes > MOST_UNPACKED_BYTES) {
    const message = `${element} unpacks to ${bytes} bytes; at most ${MOST_UNPACKED_BYTES} are unpacked at once. Export it in parts.`;
    throw json.error('too-large', message, { element });
  }
  const length = json.countOf(view, 'byteLength', element);
  if (length !== bytes) {
    const message = `${element} has ${length} bytes, and unpacks to ${bytes}. Export it again.`;
    throw json.error('damaged', message, { element });
  }
  return { count, strideBytes, mode: mode as PackedView['mode'], filter: filter as PackedView['filter'] };

  function unknown(property: string, value: unknown, known: object): Error {
    const message = `the ${property} of ${element} is ${shown(value)}; meshopt has ${Object.keys(known).join(', ')}.`;
    return json.error('bad-property', message, { element, property });
  }
}
