import { shown } from '@websplatter/core';
import { formatBytes, formatCount } from '@websplatter/kit/format';
import {
  BlobReader,
  BlobWriter,
  configure,
  type Entry,
  type FileEntry,
  TextReader,
  Uint8ArrayReader,
  ZipReader,
  ZipWriter,
} from '@zip.js/zip.js/lib/zip-core-native.js';
import type { LocalFile } from '../engine/open/local-files.ts';
import { isFiniteF32 } from '../state/float32.ts';
import { LENGTH_UNITS, type LengthScale } from '../state/inspecting.ts';
import { arrayAt, FieldError, numberAt, objectAt, pointAt, textAt } from '../state/json-fields.ts';
import type { RowMasks } from '../state/selecting.ts';
import type { KeptWork } from './kept-work.ts';
import { checkMask, maskBytes, type RowsOf } from './mask-rows.ts';

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

/** A project as it is read: the removed rows wait for the scene, which bounds them. */
export interface ReadProject extends Omit<Project, 'removed'> {
  /** @throws FieldError for rows or clouds that the scene does not have. */
  readonly readRemoved: (rowsOf: RowsOf) => Promise<RowMasks>;
}

const DOCUMENT = 'project.json';
/** As `settings.json`: a document with more bytes is something else. */
const MOST_DOCUMENT_BYTES = 16 * 2 ** 20;
/** As many as an archive without the extension zip64 has. */
const MOST_ENTRIES = 65_535;
/** Projects hold files as they came, and people may pack a project anew: that makes texts up to this many times shorter. */
const MOST_RATIO = 16;
const VERSION = 1;
const FILES = 'files/';
const filePath = (place: number, path: string) => `${FILES}${place + 1}/${path}`;
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
 * Reads a project and the files that it holds. All sizes are checked before anything is unpacked.
 *
 * @throws FieldError for a file that is no project, is damaged, is too large when it is unpacked, or
 *   was saved by a newer viewer.
 */
export async function readProject(file: Blob): Promise<ReadProject> {
  const archive = new Archive(await entriesOf(file));
  await archive.checkFiles(file.size);
  return projectIn(archive);
}

async function entriesOf(file: Blob): Promise<ReadonlyMap<string, FileEntry>> {
  const files = new Map<string, FileEntry>();
  let count = 0;
  for await (const entry of listed(file)) {
    if (++count > MOST_ENTRIES) throw new FieldError('Its number of files', count, `at most ${MOST_ENTRIES}`);
    if (entry.directory) continue;
    if (files.has(entry.filename)) throw twice(entry.filename);
    files.set(entry.filename, entry);
  }
  return files;
}

async function* listed(file: Blob): AsyncGenerator<Entry> {
  try {
    yield* new ZipReader(new BlobReader(file)).getEntriesGenerator();
  } catch {
    throw new FieldError('Its end', undefined, 'that of a zip archive');
  }
}

const named = (path: string) => `Its file ${shown(path)}`;
const twice = (path: string) => new FieldError(named(path), 'there twice', 'there once');

/** Files of a zip archive by their paths. */
class Archive {
  readonly #entries: ReadonlyMap<string, FileEntry>;

  constructor(entries: ReadonlyMap<string, FileEntry>) {
    this.#entries = entries;
  }

  /** @throws FieldError if the files of the scene need more room than the browser has, or than such an archive can hold. */
  async checkFiles(archiveBytes: number): Promise<void> {
    const files = [...this.#entries.values()].filter(({ filename }) => filename.startsWith(FILES));
    const bytes = files.reduce((sum, { uncompressedSize }) => sum + uncompressedSize, 0);
    const { quota = Infinity } = (await navigatorStorage()?.estimate()) ?? {};
    const most = Math.min(quota, MOST_DOCUMENT_BYTES + MOST_RATIO * archiveBytes);
    if (bytes > most)
      throw new FieldError('The size of its files', formatBytes(bytes), `at most ${formatBytes(most)}`);
  }

  /** Unpacked. @throws FieldError for a file that is missing. */
  bytesOf(path: string): number {
    return this.#entry(path).uncompressedSize;
  }

  #entry(path: string): FileEntry {
    const entry = this.#entries.get(path);
    if (!entry) throw new FieldError(named(path), undefined, 'in the archive');
    return entry;
  }

  /**
   * @param why `mostBytes` is the limit.
   * @throws FieldError for a file that is missing, damaged, or has more bytes.
   */
  async read(path: string, mostBytes = Infinity, why = ''): Promise<Blob> {
    const entry = this.#entry(path);
    const { uncompressedSize } = entry;
    if (uncompressedSize > mostBytes)
      throw new FieldError(
        `The size of ${shown(path)}`,
        formatBytes(uncompressedSize),
        `at most ${formatBytes(mostBytes)}${why}`,
      );
    try {
      const { readable, writable } = endingAt(uncompressedSize);
      const [blob] = await Promise.all([
        new Response(readable).blob(),
        entry.getData(writable, { checkSignature: true }),
      ]);
      return blob;
    } catch {
      throw new FieldError(named(path), 'damaged', 'as it was saved');
    }
  }
}

/** Passes bytes on, and fails at the first one beyond `size`: an archive may say less than it unpacks to. */
function endingAt(size: number): TransformStream<Uint8Array<ArrayBuffer>, Uint8Array<ArrayBuffer>> {
  let bytes = 0;
  return new TransformStream({
    transform(piece, controller) {
      bytes += piece.length;
      if (bytes > size) throw new RangeError(`more than ${size} bytes`);
      controller.enqueue(piece);
    },
  });
}

/** Undefined outside of browsers, and where a page has no storage. */
function navigatorStorage(): StorageManager | undefined {
  return globalThis.navigator?.storage;
}

async function projectIn(archive: Archive): Promise<ReadProject> {
  const text = await (await archive.read(DOCUMENT, MOST_DOCUMENT_BYTES)).text();
  const json = objectAt(DOCUMENT, jsonIn(text));
  if (json.version !== VERSION)
    throw new FieldError('version', json.version, `${VERSION}: reload this page for a newer viewer`);
  const parts: ProjectPart[] = [];
  for (const [place, part] of arrayAt('parts', json.parts).entries())
    parts.push(await partAt(place, part, archive));
  if (parts.length === 0) throw new FieldError('parts', json.parts, 'a list of files');
  const masks = maskKeysAt(json.removed, archive);
  return {
    parts,
    view: textAt('view', json.view),
    rulers: arrayAt('rulers', json.rulers).map((ends, i) => {
      const [from, to] = arrayAt(`rulers[${i}]`, ends);
      return [pointAt(`rulers[${i}][0]`, from), pointAt(`rulers[${i}][1]`, to)];
    }),
    scale: scaleAt(json.length),
    readRemoved: (rowsOf) => readMasks(masks, rowsOf, archive),
  };
}

function jsonIn(text: string): unknown {
  try {
    return JSON.parse(text);
  } catch {
    throw new FieldError(DOCUMENT, text.slice(0, 100), 'JSON');
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
  const paths = arrayAt(`${at}.files`, part.files).map((each) => textAt(`${at}.files`, each));
  for (const path of unique(paths)) files.push({ path, bytes: await archive.read(filePath(place, path)) });
  if (files.length === 0) throw new FieldError(`${at}.files`, part.files, 'a list of names');
  return { title, files };
}

/** @throws FieldError for a name that is there twice. */
function unique(names: readonly string[]): ReadonlySet<string> {
  const found = new Set<string>();
  for (const name of names) {
    if (found.has(name)) throw twice(name);
    found.add(name);
  }
  return found;
}

/** Keys of clouds with removed rows: the place of their file, and of the cloud in it. */
function maskKeysAt(value: unknown, archive: Archive): ReadonlySet<string> {
  const keys = arrayAt('removed', value).map((each) => textAt('removed', each));
  for (const key of keys) {
    if (!/^(0|[1-9]\d{0,8})\/(0|[1-9]\d{0,8})$/.test(key))
      throw new FieldError('removed', key, 'numbers of a file and a cloud, as in 0/0');
    const bytes = archive.bytesOf(maskPath(key));
    if (bytes % 4 !== 0) throw new FieldError(maskPath(key), bytes, 'a multiple of 4 bytes');
  }
  return unique(keys);
}

async function readMasks(
  keys: ReadonlySet<string>,
  rowsOf: RowsOf,
  archive: Archive,
): Promise<KeptWork['removed']> {
  const masks = new Map<string, Uint32Array<ArrayBuffer>>();
  for (const key of keys) {
    const rows = rowsOf(key);
    // Its file could not be opened, which was said.
    if (rows === undefined) continue;
    if (rows === null) throw new FieldError('removed', key, 'a cloud that its file has');
    const why = `, as its cloud has ${formatCount(rows.most)} rows`;
    const bytes = await archive.read(maskPath(key), maskBytes(rows.most), why);
    const words = new Uint32Array(await bytes.arrayBuffer());
    checkMask(key, words, rows);
    masks.set(key, words);
  }
  return masks;
}

function scaleAt(value: unknown): LengthScale | null {
  if (value === null) return null;
  const { perSceneUnit, unit } = objectAt('length', value);
  const known = LENGTH_UNITS.find((each) => each === unit);
  if (!known) throw new FieldError('length.unit', unit, `one of ${LENGTH_UNITS.join(', ')}`);
  const units = numberAt('length.perSceneUnit', perSceneUnit);
  if (units <= 0 || !isFiniteF32(units))
    throw new FieldError('length.perSceneUnit', units, 'above 0, and a number of float32');
  return { perSceneUnit: units, unit: known };
}
