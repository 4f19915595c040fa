import { zipFiles } from '@websplatter/core/write';
import { BlobWriter, TextReader, Uint8ArrayReader, ZipWriter } from '@zip.js/zip.js/lib/zip-core-native.js';
import { describe, expect, it, vi } from 'vitest';
import { FieldError } from '../state/json-fields.ts';
import { checkMasks, type RowsOf, rowsIn } from './mask-rows.ts';
import { type Project, readProject, writeProject } from './project-file.ts';

const PROJECT: Project = {
  parts: [
    { title: 'a.ply', files: [{ path: 'a.ply', bytes: new Blob(['first']) }] },
    {
      title: 'sog',
      files: [
        { path: 'sog/meta.json', bytes: new Blob(['{}']) },
        { path: 'sog/means_l.webp', bytes: new Blob([Uint8Array.of(1, 2, 3)]) },
      ],
    },
    // Two files may have one name.
    { title: 'a.ply', files: [{ path: 'a.ply', bytes: new Blob(['second']) }] },
    { title: 'b.spz', address: 'https://example.com/b.spz' },
    { title: 'Still life', scene: 'still-life' },
  ],
  view: 'camera=0,0,0,1,2,1&background=ff8000',
  rulers: [
    [
      [0, 0.1, -1],
      [1e-7, 2, 3],
    ],
  ],
  scale: { perSceneUnit: 0.5, unit: 'm' },
  removed: new Map([
    ['0/0', Uint32Array.of(0b1011, 0, 0xffffffff)],
    ['1/2', Uint32Array.of(1)],
  ]),
};

const write = (project: Project, signal = new AbortController().signal) =>
  writeProject(project, { signal, onPart: () => {} });

/** Rows of a scene that has all of the project's. */
const ROWS: RowsOf = () => ({ most: 96, isExact: true });

/** The project with its removed rows. */
async function readAll(file: Blob, rowsOf = ROWS): Promise<Project> {
  const { readRemoved, ...project } = await readProject(file);
  return { ...project, removed: await readRemoved(rowsOf) };
}

async function withTexts({ parts, ...rest }: Project) {
  const texts = parts.map(async (part) =>
    'files' in part
      ? {
          title: part.title,
          files: await Promise.all(
            part.files.map(async ({ path, bytes }) => [path, ...new Uint8Array(await bytes.arrayBuffer())]),
          ),
        }
      : part,
  );
  return { ...rest, parts: await Promise.all(texts) };
}

/** An archive with a document alone. */
function archiveOf(document: unknown): Blob {
  const text = new TextEncoder().encode(JSON.stringify(document));
  return new Blob([zipFiles({ 'project.json': text })]);
}

describe('a project file', () => {
  it('holds files, addresses and all that was made of a scene', async () => {
    const read = await readAll(await write(PROJECT));
    expect(await withTexts(read)).toEqual(await withTexts(PROJECT));
  });

  it('stores files as they are, and tells how much is written', async () => {
    const parts: number[] = [];
    const bytes = new Blob([new Uint8Array(3e6)]);
    const project = { ...PROJECT, parts: [{ title: 'large', files: [{ path: 'l', bytes }] }] };
    const { signal } = new AbortController();
    const file = await writeProject(project, { signal, onPart: (part) => parts.push(part) });
    expect(file.size).toBeGreaterThan(3e6);
    expect(parts.every((part) => part >= 0 && part <= 1)).toBe(true);
    expect(Math.max(...parts)).toBeGreaterThan(0.5);
  });

  it('is not written after it was cancelled', async () => {
    const work = new AbortController();
    work.abort(new Error('cancelled'));
    await expect(write(PROJECT, work.signal)).rejects.toThrow('cancelled');
  });

  it('is refused where it is no project', async () => {
    const whole = await write(PROJECT);
    await expect(readProject(new Blob(['no zip']))).rejects.toThrow('must be that of a zip archive');
    await expect(readProject(whole.slice(0, whole.size - 30))).rejects.toThrow(
      'must be that of a zip archive',
    );
    const other = new Blob([zipFiles({ 'meta.json': Uint8Array.of(1) })]);
    await expect(readProject(other)).rejects.toThrow('project.json');
    await expect(readProject(archiveOf([]))).rejects.toThrow('project.json is');
  });

  it('is refused where a file in it is damaged', async () => {
    const whole = new Uint8Array(await (await write(PROJECT)).arrayBuffer());
    const text = new TextDecoder('latin1').decode(whole);
    whole[text.indexOf('first')] ^= 1;
    await expect(readProject(new Blob([whole]))).rejects.toThrow('files/1/a.ply');
  });

  it.each([
    [{ version: 2 }, 'version is 2, but must be 1: reload'],
    [{ parts: [] }, 'parts is'],
    [{ parts: [{ title: 'x' }] }, 'parts[0].files is missing'],
    [{ parts: [{ title: 'x', address: 'javascript:alert(1)' }] }, 'parts[0].address'],
    [{ parts: [{ title: 'x', files: ['../x'] }] }, 'files/1/../x'],
    [{ view: 3 }, 'view is 3, but must be a string'],
    [{ rulers: [[[0, 0, 0]]] }, 'rulers[0][1]'],
    [
      {
        rulers: [
          [
            [0, 0, 0],
            [0, 'x', 0],
          ],
        ],
      },
      'rulers[0][1][1]',
    ],
    [{ length: { perSceneUnit: 0, unit: 'm' } }, 'length.perSceneUnit is 0'],
    [{ length: { perSceneUnit: 1e39, unit: 'm' } }, 'length.perSceneUnit is 1e+39'],
    [{ length: { perSceneUnit: 1, unit: 'mile' } }, 'length.unit'],
    [{ removed: ['0'] }, 'removed is "0"'],
    [{ removed: ['00/00'] }, 'removed is "00/00"'],
    [{ removed: ['0/0x'] }, 'removed is "0/0x"'],
    [
      {
        rulers: [
          [
            [0, 0, 0],
            [0, 1e39, 0],
          ],
        ],
      },
      'rulers[0][1][1] is 1e+39, but must be a number of float32',
    ],
    [{ removed: ['7/7'] }, 'removed/7-7.bits'],
  ])('is refused with %j', async (change, message) => {
    const parts = [{ title: 'Still life', scene: 'still-life' }];
    const document = { version: 1, parts, view: '', rulers: [], length: null, removed: [] };
    await readProject(archiveOf(document));
    await expect(readProject(archiveOf({ ...document, ...change }))).rejects.toThrow(message);
  });
});

/** An archive with a document and other files, packed as tightly as can be. */
async function packed(document: object, files: Readonly<Record<string, Uint8Array>>): Promise<Blob> {
  const zip = new ZipWriter(new BlobWriter());
  const whole = {
    version: 1,
    parts: [STILL_LIFE],
    view: '',
    rulers: [],
    length: null,
    removed: [],
    ...document,
  };
  await zip.add('project.json', new TextReader(JSON.stringify(whole)));
  for (const [path, bytes] of Object.entries(files)) await zip.add(path, new Uint8ArrayReader(bytes));
  return zip.close();
}

const STILL_LIFE = { title: 'Still life', scene: 'still-life' };
const MB = 2 ** 20;

/**
 * @fault Files: a project unpacks to a thousand times its size, or names a file many times
 * @consequence It is refused before anything is unpacked.
 */
describe('a project that is larger than it looks', () => {
  it('has a document of 16 MB at most', async () => {
    const zip = new ZipWriter(new BlobWriter());
    await zip.add('project.json', new TextReader(' '.repeat(17 * MB)));
    await expect(readProject(await zip.close())).rejects.toThrow(
      'project.json is "18 MB", but must be at most 17 MB',
    );
  });

  it('has files of about its own size', async () => {
    const parts = [{ title: 'a', files: ['a.ply'] }];
    const archive = await packed({ parts }, { 'files/1/a.ply': new Uint8Array(64 * MB) });
    expect(archive.size).toBeLessThan(MB);
    await expect(readProject(archive)).rejects.toThrow(
      'The size of its files is "67 MB", but must be at most 18 MB',
    );
    // Texts are packed well by people who pack a project anew.
    const { parts: read } = await readProject(
      await packed({ parts }, { 'files/1/a.ply': new Uint8Array(8 * MB) }),
    );
    expect('files' in read[0] && read[0].files[0].bytes.size).toBe(8 * MB);
  });

  it('has files of at most what the browser can hold', async () => {
    vi.stubGlobal('navigator', { storage: { estimate: async () => ({ quota: 3 }) } });
    await expect(readProject(await write(PROJECT))).rejects.toThrow('must be at most 3 B');
    vi.unstubAllGlobals();
  });

  it('does not unpack to more than it says', async () => {
    const parts = [{ title: 'a', files: ['a.ply'] }];
    const bytes = new Uint8Array(
      await (await packed({ parts }, { 'files/1/a.ply': new Uint8Array(8 * MB) })).arrayBuffer(),
    );
    const view = new DataView(bytes.buffer);
    for (let at = 0; at + 4 < bytes.length; at++)
      if (view.getUint32(at, true) === 8 * MB) view.setUint32(at, 10, true);
    await expect(readProject(new Blob([bytes]))).rejects.toThrow(FieldError);
  });

  it('names each file once', async () => {
    const parts = [{ title: 'a', files: Array.from({ length: 5000 }, () => 'x') }];
    const files = { 'files/1/x': new Uint8Array(1000), 'removed/0-0.bits': new Uint8Array(4) };
    await expect(readProject(await packed({ parts }, files))).rejects.toThrow('Its file x is "there twice"');
    await expect(readProject(await packed({ removed: ['0/0', '0/0'] }, files))).rejects.toThrow(
      'there twice',
    );
    const once = await packed({}, { 'files/1/x': new Uint8Array(1), 'files/1/y': new Uint8Array(1) });
    const text = new TextDecoder('latin1')
      .decode(await once.arrayBuffer())
      .replaceAll('files/1/y', 'files/1/x');
    const twice = new Blob([Uint8Array.from(text, (character) => character.charCodeAt(0))]);
    await expect(readProject(twice)).rejects.toThrow('files/1/x is "there twice"');
  });
});

/**
 * @fault Files: a project's removed rows are not of its scene: too many, of another cloud, or a file has changed
 * @consequence It is refused with the name of the cloud and the number of its rows.
 */
describe('the removed rows of a project', () => {
  const ofRows =
    (most: number): RowsOf =>
    () => ({ most, isExact: true });
  const mask = (bytes: Uint8Array) => packed({ removed: ['0/0'] }, { 'removed/0-0.bits': bytes });

  it('are unpacked only as far as the cloud has rows', async () => {
    const reading = readAll(await mask(new Uint8Array(32 * MB)), ofRows(10_000));
    await expect(reading).rejects.toThrow('but must be at most 1.3 kB, as its cloud has 10,000 rows');
    await expect(readAll(await mask(new Uint8Array(3)))).rejects.toThrow('a multiple of 4 bytes');
  });

  it.each([0, 1, 31, 32, 33, 1250])('are those of a cloud of %i', async (rows) => {
    const words = new Uint32Array(Math.ceil(rows / 32));
    for (let row = 0; row < rows; row++) words[row >>> 5] |= 1 << (row & 31);
    const bytes = new Uint8Array(words.buffer);
    const { removed } = await readAll(await mask(bytes), ofRows(rows));
    expect(removed.get('0/0')).toEqual(words);
    if (rows > 0)
      await expect(readAll(await mask(bytes), ofRows(rows - 1))).rejects.toThrow(
        /at most|last row of removed 0\/0/,
      );
  });

  it('are of clouds that the file has', async () => {
    await expect(readAll(await mask(Uint8Array.of(1, 0, 0, 0)), () => null)).rejects.toThrow(
      'removed is "0/0", but must be a cloud that its file has',
    );
    // Of a file that could not be opened.
    expect((await readAll(await mask(Uint8Array.of(1, 0, 0, 0)), () => undefined)).removed.size).toBe(0);
  });

  it('of a shown scene are as many as its file has, dropped ones too', () => {
    const cloud = { count: 30, dropped: { 'non-finite-color': 5 }, facts: {}, stream: null };
    const loaded = { clouds: [{ cloud }] };
    const source = { kind: 'url', url: new URL('https://example.com/a.ply') };
    const rowsOf = rowsIn([undefined, { loaded, source } as never]);
    expect(rowsOf('1/0')).toEqual({ most: 35, isExact: true });
    expect([rowsOf('1/1'), rowsOf('0/0'), rowsOf('2/0')]).toEqual([null, undefined, undefined]);
    expect(() => checkMasks(new Map([['1/0', Uint32Array.of(0, 0b111)]]), rowsOf)).not.toThrow();
    expect(() => checkMasks(new Map([['1/0', Uint32Array.of(0, 0b1000)]]), rowsOf)).toThrow(FieldError);
    const frames = { count: 3, perS: 30, bytes: 100 };
    const moving = { clouds: [{ cloud: { ...cloud, facts: { fileFacts: { frames } } } }] };
    const rowsOfFrames = rowsIn([{ loaded: moving, source } as never]);
    expect([rowsOfFrames('0/2'), rowsOfFrames('0/3')]).toEqual([{ most: 800, isExact: false }, null]);
  });
});
