import { describe, expect, it } from 'vitest';
import { decideFiles } from './decide-files.ts';
import { chosenFiles, droppedFiles, type FoundFile } from './file-drop.ts';

const fileNamed = (name: string) => new File([], name);
const item = (name: string) => ({
  kind: 'file',
  getAsFile: () => fileNamed(name),
  webkitGetAsEntry: () => ({ isDirectory: false, fullPath: `/${name}` }),
});

/** A dropped folder, which gives its entries one by one. */
function folder(fullPath: string, entries: readonly object[]) {
  return {
    isDirectory: true,
    fullPath,
    createReader() {
      let next = 0;
      return { readEntries: (resolve: (found: object[]) => void) => resolve(entries.slice(next, ++next)) };
    },
  };
}

const fileIn = (fullPath: string) => ({
  isDirectory: false,
  fullPath,
  file: (resolve: (file: File) => void) => resolve(fileNamed(fullPath.replace(/^.*\//, ''))),
});

const named = (...names: string[]) => chosenFiles(names.map(fileNamed));

describe('dropped files', () => {
  it('open one file without a word', async () => {
    const { opened, notice } = decideFiles(await droppedFiles([item('garden.ply')]));
    expect(opened).toMatchObject([{ name: 'garden.ply', source: { name: 'garden.ply' } }]);
    expect(notice).toBeNull();
  });

  const namesOf = (found: readonly FoundFile[]) => decideFiles(found).opened.map(({ name }) => name);
  const inFolder = (...paths: string[]): FoundFile[] =>
    paths.map((path) => ({ path, file: fileNamed(path.replace(/^.*\//, '')) }));

  it('open every scene of several, and say what is left out', () => {
    const { opened, notice } = decideFiles(named('notes.txt', 'a.PLY', 'b.ply'));
    expect(opened.map(({ name }) => name)).toEqual(['a.PLY', 'b.ply']);
    expect(notice).toBe('notes.txt is left out: its name does not end like a splat file’s.');
    expect(decideFiles(named('notes.txt', 'x.doc', 'a.ply')).notice).toBe(
      'notes.txt and x.doc are left out: their names do not end like a splat file’s.',
    );
    expect(decideFiles(named('a.ply', '1.txt', '2.txt', '3.txt', '4.txt', '5.txt')).notice).toMatch(
      /^1.txt, 2.txt, 3.txt and 2 other files are left out: /,
    );
    expect(decideFiles(named('notes.txt', 'x.doc'))).toMatchObject({
      opened: [{ name: 'notes.txt' }],
      notice: 'x.doc is left out: its name does not end like a splat file’s.',
    });
  });

  it('that belong together are one scene, also beside others', () => {
    const sog = ['scans/a/meta.json', 'scans/a/means_l.webp', 'scans/a/sh/labels.webp'];
    const [whole] = decideFiles(inFolder('scans/notes.txt', ...sog)).opened;
    expect(whole).toMatchObject({ name: 'a', source: { paths: ['scans/notes.txt', ...sog] } });
    const { opened, notice } = decideFiles(
      inFolder(...sog, 'scans/b/meta.json', 'scans/b/means_l.webp', 'c.ply'),
    );
    expect(opened.map(({ name }) => name)).toEqual(['a', 'b', 'c.ply']);
    expect(opened[0].source).toMatchObject({ paths: sog });
    expect(notice).toBeNull();
    expect(namesOf(named('meta.json', 'means_l.webp', 'c.ply'))).toEqual(['meta.json', 'c.ply']);
    // A streamed SOG leads to files that lead to others.
    expect(namesOf(inFolder('x/lod-meta.json', 'x/0_0/meta.json', 'x/0_0/means_l.webp'))).toEqual(['x']);
  });

  it('may have settings of SuperSplat’s beside them, or be those alone', () => {
    const decision = decideFiles(inFolder('x/scene.ply', 'x/y/settings.json', 'x/Settings.json'));
    expect(decision).toMatchObject({
      opened: [{ name: 'scene.ply' }],
      notice: null,
      settings: { name: 'Settings.json' },
    });
    expect(decideFiles(named('settings.json'))).toMatchObject({ opened: [], notice: null, settings: {} });
    expect(decideFiles(named('a.ply')).settings).toBeUndefined();
    const { opened } = decideFiles(inFolder('a/meta.json', 'a/settings.json', 'a/means_l.webp'));
    expect(opened).toMatchObject([{ name: 'a', source: { paths: ['a/meta.json', 'a/means_l.webp'] } }]);
  });

  it('of the same name are told apart by their folders', () => {
    expect(namesOf(inFolder('7000/point_cloud.ply', '30000/point_cloud.ply', 'a.ply'))).toEqual([
      '7000/point_cloud.ply',
      '30000/point_cloud.ply',
      'a.ply',
    ]);
  });

  it('are opened up to a number', () => {
    const { opened, notice } = decideFiles(named(...Array.from({ length: 40 }, (_, i) => `${i}.ply`)));
    expect(opened).toHaveLength(32);
    expect(notice).toBe(
      'At most 32 scenes are opened at once. 32.ply, 33.ply, 34.ply and 5 other files are left out.',
    );
  });

  it('are looked for in folders', async () => {
    const scans = folder('/scans', [
      fileIn('/scans/notes.txt'),
      folder('/scans/a', [fileIn('/scans/a/hall.ply')]),
    ]);
    const dropped = { kind: 'file', getAsFile: () => fileNamed('scans'), webkitGetAsEntry: () => scans };
    const found = await droppedFiles([dropped] as never);
    expect(found.map(({ path }) => path)).toEqual(['scans/notes.txt', 'scans/a/hall.ply']);
    expect(decideFiles(found).opened[0].name).toBe('hall.ply');
  });

  it('say what is missing where there is none', async () => {
    const found = await droppedFiles([{ kind: 'string', getAsFile: () => null }]);
    expect(decideFiles(found)).toMatchObject({
      opened: [],
      notice: expect.stringMatching(/Nothing that was dropped is a file. Drop PLY, SPZ, SOG/),
    });
  });
});
