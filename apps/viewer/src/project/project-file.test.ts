import { zipFiles } from '@websplatter/core/write';
import { describe, expect, it } from 'vitest';
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
    const read = await readProject(await write(PROJECT));
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
    [{ length: { perSceneUnit: 1, unit: 'mile' } }, 'length.unit'],
    [{ removed: ['0'] }, 'removed is "0"'],
    [{ removed: ['7/7'] }, 'removed/7-7.bits'],
  ])('is refused with %j', async (change, message) => {
    const parts = [{ title: 'Still life', scene: 'still-life' }];
    const document = { version: 1, parts, view: '', rulers: [], length: null, removed: [] };
    await readProject(archiveOf(document));
    await expect(readProject(archiveOf({ ...document, ...change }))).rejects.toThrow(message);
  });
});
