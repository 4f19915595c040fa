import { shown } from '@websplatter/core';
import {
  BlobReader,
  BlobWriter,
  configure,
  type Entry,
  type FileEntry,
  TextReader,
  TextWriter,
  Uint8ArrayReader,
  Uint8ArrayWriter,
  ZipReader,
  ZipWriter,
} from '@zip.js/zip.js/lib/zip-core-native.js';
import type { LocalFile } from '../engine/local-files.ts';
import { LENGTH_UNITS, type LengthScale } from '../state/inspecting.ts';
import { arrayAt, FieldError, numberAt, objectAt, textAt, vectorAt } from '../state/json-fields.ts';
import type { KeptWork } from './kept-work.ts';

/** A file of a project's scene, or what opens it again. */
export type ProjectPart =
  /** Files of a device, which the project holds. */
  | { readonly title: string; readonly files: readonly LocalFile[] }
  | { readonly title: string; readonly address: string }
  /** A scene of the viewer's own, as `?scene=` names it. */
  | { readonly title: string; readonly scene: string };

/** A scene with all that was made of it, as a `.wsplat` file holds it. */
export interface Project extends KeptWork {
  readonly parts: readonly ProjectPart[];
}

const DOCUMENT = 'project.json';
const VERSION = 1;
const filePath = (place: number, path: string) => `files/${place + 1}/${path}`;
const maskPath = (key: string) => `removed/${key.replace('/', '-')}.bits`;

// A page may forbid workers from blobs, and files that are stored as they are need none.
configure({ useWebWorkers: false });

/**
 * Writes a project as a zip archive: `project.json`, files of this device as they came, and a bit
 * for each removed row.
 *
 * @param onPart called with the part of all files that is written, 0…1.
 * @throws the signal's reason once that is aborted.
 */
export async function writeProject(
  { parts, view, rulers, scale, removed }: Project,
  { signal, onPart }: { readonly signal: AbortSignal; readonly onPart: (part: number) => void },
): Promise<Blob> {
  const held = parts.flatMap((part, place) =>
    'files' in part ? part.files.map(({ path, bytes }) => ({ path: filePath(place, path), bytes })) : [],
  );
  const document = {
    format: 'WebSplatter project',
    version: VERSION,
    parts: parts.map((part) =>
      'files' in part ? { title: part.title, files: part.files.map(({ path }) => path) } : part,
    ),
    view,
    rulers,
    length: scale,
    removed: [...removed.keys()],
  };
  const zip = new ZipWriter(new BlobWriter('application/zip'), { level: 0, signal });
  await zip.add(DOCUMENT, new TextReader(JSON.stringify(document, null, 1)));
  for (const [key, words] of removed)
    await zip.add(maskPath(key), new Uint8ArrayReader(new Uint8Array(words.buffer)), { level: 6 });
  const totalBytes = held.reduce((sum, { bytes }) => sum + bytes.size, 0);
  let writtenBytes = 0;
  for (const { path, bytes } of held) {
    const before = writtenBytes;
    const onprogress = async (doneBytes: number) => onPart((before + doneBytes) / totalBytes);
    await zip.add(path, new BlobReader(bytes), { onprogress });
    writtenBytes += bytes.size;
  }
  return zip.close();
}

/**
 * Reads a project and the files that it holds.
 *
 * @throws FieldError for a file that is no project, is damaged, or was saved by a newer viewer.
 */
export async function readProject(file: Blob): Promise<Project> {
  const zip = new ZipReader(new BlobReader(file));
  try {
    const entries = await zip.getEntries().catch((): Entry[] => {
      throw new FieldError('Its end', undefined, 'that of a zip archive');
    });
    const files = new Map(entries.flatMap((entry) => (entry.directory ? [] : [[entry.filename, entry]])));
    return await projectIn(new Archive(files));
  } finally {
    await zip.close();
  }
}

/** Files of a zip archive by their paths. */
class Archive {
  readonly #entries: ReadonlyMap<string, FileEntry>;

  constructor(entries: ReadonlyMap<string, FileEntry>) {
    this.#entries = entries;
  }

  text(path: string): Promise<string> {
    return this.#read(path, new TextWriter());
  }

  bytes(path: string): Promise<Uint8Array> {
    return this.#read(path, new Uint8ArrayWriter());
  }

  blob(path: string): Promise<Blob> {
    return this.#read(path, new BlobWriter());
  }

  async #read<Contents>(path: string, writer: { getData(): Promise<Contents> }): Promise<Contents> {
    const entry = this.#entries.get(path);
    if (!entry) throw new FieldError(`Its file ${shown(path)}`, undefined, 'in the archive');
    try {
      return await entry.getData(writer as never, { checkSignature: true });
    } catch {
      throw new FieldError(`Its file ${shown(path)}`, 'damaged', 'as it was saved');
    }
  }
}

async function projectIn(archive: Archive): Promise<Project> {
  const text = await archive.text(DOCUMENT);
  const json = objectAt(DOCUMENT, jsonIn(text));
  if (json.version !== VERSION)
    throw new FieldError('version', json.version, `${VERSION}: reload this page for a newer viewer`);
  const parts: ProjectPart[] = [];
  for (const [place, part] of arrayAt('parts', json.parts).entries())
    parts.push(await partAt(place, part, archive));
  if (parts.length === 0) throw new FieldError('parts', json.parts, 'a list of files');
  return {
    parts,
    view: textAt('view', json.view),
    rulers: arrayAt('rulers', json.rulers).map((ends, i) => {
      const [from, to] = arrayAt(`rulers[${i}]`, ends);
      return [vectorAt(`rulers[${i}][0]`, from), vectorAt(`rulers[${i}][1]`, to)];
    }),
    scale: scaleAt(json.length),
    removed: await masksAt(json.removed, archive),
  };
}

function jsonIn(text: string): unknown {
  try {
    return JSON.parse(text);
  } catch {
    throw new FieldError(DOCUMENT, text, 'JSON');
  }
}

async function partAt(place: number, value: unknown, archive: Archive): Promise<ProjectPart> {
  const at = `parts[${place}]`;
  const part = objectAt(at, value);
  const title = textAt(`${at}.title`, part.title);
  if (part.scene !== undefined) return { title, scene: textAt(`${at}.scene`, part.scene) };
  if (part.address !== undefined) {
    const address = textAt(`${at}.address`, part.address);
    if (!/^https?:$/.test(URL.parse(address)?.protocol ?? ''))
      throw new FieldError(`${at}.address`, address, 'an address that begins with http');
    return { title, address };
  }
  const files: LocalFile[] = [];
  for (const each of arrayAt(`${at}.files`, part.files)) {
    const path = textAt(`${at}.files`, each);
    files.push({ path, bytes: await archive.blob(filePath(place, path)) });
  }
  if (files.length === 0) throw new FieldError(`${at}.files`, part.files, 'a list of names');
  return { title, files };
}

async function masksAt(value: unknown, archive: Archive): Promise<KeptWork['removed']> {
  const masks = new Map<string, Uint32Array<ArrayBuffer>>();
  for (const each of arrayAt('removed', value)) {
    const key = textAt('removed', each);
    if (!/^\d+\/\d+$/.test(key))
      throw new FieldError('removed', key, 'numbers of a file and a cloud, as in 0/0');
    const bytes = await archive.bytes(maskPath(key));
    if (bytes.length % 4 !== 0) throw new FieldError(maskPath(key), bytes.length, 'a multiple of 4 bytes');
    masks.set(key, new Uint32Array(bytes.slice().buffer));
  }
  return masks;
}

function scaleAt(value: unknown): LengthScale | null {
  if (value === null) return null;
  const { perSceneUnit, unit } = objectAt('length', value);
  const known = LENGTH_UNITS.find((each) => each === unit);
  if (!known) throw new FieldError('length.unit', unit, `one of ${LENGTH_UNITS.join(', ')}`);
  const units = numberAt('length.perSceneUnit', perSceneUnit);
  if (units <= 0) throw new FieldError('length.perSceneUnit', units, 'above 0');
  return { perSceneUnit: units, unit: known };
}
