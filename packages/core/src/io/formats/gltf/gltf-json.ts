import {
  type FileFinding,
  type FilePlace,
  SplatFileError,
  type SplatFileErrorCode,
} from '../../../data/errors.ts';
import { shown } from '../../../data/printable.ts';
import { parseJson } from '../file-json.ts';
import { FIRST_SPZ, SPLATTING } from './gltf-semantics.ts';

/** Most JSON values of a file; scenes of splats have a few hundred. */
const MOST_VALUES = 2 ** 20;

/** Extensions that do not affect splats. */
const HARMLESS_EXTENSIONS = /^[A-Z]+_(?:materials|texture|lights)_|^KHR_draco_mesh_compression$/;
/** Draft extensions for splats as an .spz in a bufferView; the second is the earlier name. */
export const SPZ_COMPRESSIONS: readonly string[] = [
  'KHR_gaussian_splatting_compression_spz_2',
  'KHR_gaussian_splatting_compression_spz',
];
/** Extensions for meshopt-compressed bufferViews, the current name first. */
export const MESHOPT_COMPRESSIONS: readonly string[] = ['KHR_meshopt_compression', 'EXT_meshopt_compression'];
const READ_EXTENSIONS: readonly string[] = [
  SPLATTING,
  FIRST_SPZ,
  'KHR_mesh_quantization',
  ...SPZ_COMPRESSIONS,
  ...MESHOPT_COMPRESSIONS,
];

export type JsonObject = Readonly<Record<string, unknown>>;

/** The JSON of a glTF, with checked access to its values. */
export class GltfJson {
  readonly #file: string;
  readonly #root: JsonObject;

  /**
   * @throws SplatFileError 'bad-header', 'too-large'; 'unknown-format' for other versions and
   *   required extensions
   */
  constructor(bytes: Uint8Array, file: string) {
    this.#file = file;
    this.#root = this.#parse(bytes);
    const version = objectOf(this.#root.asset).version;
    if (typeof version !== 'string' || !/^\d+\.\d+$/.test(version)) {
      const message = `its asset.version is ${shown(version)}, not "2.0": this is no glTF, or a damaged one.`;
      throw this.error('bad-header', message, { property: 'version' });
    }
    if (!version.startsWith('2.')) {
      const finding: FileFinding = [
        `is glTF ${shown(version)}`,
        'version 2 is read. Export it again as glTF 2.0',
      ];
      throw this.error('unknown-format', finding, { property: 'version' });
    }
    const required = this.listOf(this.#root, 'extensionsRequired');
    const unknown = required.filter((name) => !isRead(name));
    if (unknown.length > 0) {
      const message = `it cannot be shown without ${shown(unknown)}, which is not read; export it without.`;
      throw this.error('unknown-format', message, { property: 'extensionsRequired' });
    }
  }

  error(code: SplatFileErrorCode, problem: string | FileFinding, place: FilePlace = {}): SplatFileError {
    return new SplatFileError(code, this.#file, problem, place);
  }

  get root(): JsonObject {
    return this.#root;
  }

  /** Entry `index` of a top-level list; `user` is the referring element, for messages. */
  entryOf(list: string, index: unknown, user: string): JsonObject {
    const entries = this.listOf(this.#root, list);
    if (typeof index === 'number' && Object.hasOwn(entries, index)) {
      const entry = entries[index];
      if (isObject(entry)) return entry;
    }
    const message = `${user} refers to ${list}[${shown(index)}], which is not there. Export it again.`;
    throw this.error('damaged', message, { element: user });
  }

  /** A list in `object`; empty if absent. */
  listOf(object: JsonObject, key: string, element?: string): readonly unknown[] {
    const list = object[key] ?? [];
    if (Array.isArray(list)) return list;
    throw this.error('bad-header', `${key} is ${shown(list)}, no list.`, { element, property: key });
  }

  /** A non-negative integer. */
  countOf(object: JsonObject, key: string, element: string, byDefault?: number): number {
    const value = object[key] ?? byDefault;
    if (typeof value === 'number' && Number.isSafeInteger(value) && value >= 0) return value;
    const message = `${key} of ${element} is ${shown(value)}; it must be a whole number, not negative.`;
    throw this.error('bad-header', message, { element, property: key });
  }

  /** `length` finite numbers; undefined if absent. */
  numbersOf(object: JsonObject, key: string, length: number, element: string): readonly number[] | undefined {
    const value = object[key];
    if (value === undefined) return undefined;
    const isRight = Array.isArray(value) && value.length === length && value.every(Number.isFinite);
    if (isRight) return value;
    const message = `${key} of ${element} is ${shown(value)}; it must be ${length} numbers.`;
    throw this.error('bad-header', message, { element, property: key });
  }

  #parse(bytes: Uint8Array): JsonObject {
    const root = parseJson(bytes, this.#file, MOST_VALUES);
    if (isObject(root)) return root;
    throw this.error('bad-header', 'its JSON is no object: this is no glTF.');
  }
}

/** `value` if it is an object; else an empty object. */
export function objectOf(value: unknown): JsonObject {
  return isObject(value) ? value : {};
}

function isObject(value: unknown): value is JsonObject {
  return typeof value === 'object' && value !== null && !Array.isArray(value);
}

function isRead(extension: unknown): boolean {
  return (
    typeof extension === 'string' &&
    (READ_EXTENSIONS.includes(extension) || HARMLESS_EXTENSIONS.test(extension))
  );
}
