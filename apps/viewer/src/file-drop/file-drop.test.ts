import { describe, expect, it } from 'vitest';
import { chosenFiles, decideFiles, droppedFiles } from './file-drop.ts';

const fileNamed = (name: string) => new File([], name);
const item = (name: string) => ({
  kind: 'file',
  getAsFile: () => fileNamed(name),
  webkitGetAsEntry: () => ({ isDirectory: false, fullPath: `/${name}` }),
});

/** A dropped folder, which gives what is in it one by one. */
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
    expect(opened).toMatchObject({ name: 'garden.ply', source: { name: 'garden.ply' } });
    expect(notice).toBeNull();
  });

  it('open the first scene of several and say so', () => {
    const { opened, notice } = decideFiles(named('notes.txt', 'a.PLY', 'b.ply'));
    expect(opened?.name).toBe('a.PLY');
    expect(notice).toBe('One scene at a time: a.PLY is opened, the other 2 files were left out.');
  });

  it('are looked for in folders', async () => {
    const scans = folder('/scans', [
      fileIn('/scans/notes.txt'),
      folder('/scans/a', [fileIn('/scans/a/hall.ply')]),
    ]);
    const dropped = { kind: 'file', getAsFile: () => fileNamed('scans'), webkitGetAsEntry: () => scans };
    const found = await droppedFiles([dropped] as never);
    expect(found.map(({ path }) => path)).toEqual(['scans/notes.txt', 'scans/a/hall.ply']);
    expect(decideFiles(found).opened?.name).toBe('hall.ply');
  });

  it('say what is missing where there is none', async () => {
    const found = await droppedFiles([{ kind: 'string', getAsFile: () => null }]);
    expect(decideFiles(found)).toMatchObject({
      opened: null,
      notice: expect.stringMatching(/no file in that; drop a scene: PLY, SPZ, SOG/),
    });
  });
});
