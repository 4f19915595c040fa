import { describe, expect, it } from 'vitest';
import { decideDrop, decideFiles } from './file-drop.ts';

const fileNamed = (name: string) => new File([], name);
const item = (name: string, isDirectory = false) => ({
  kind: 'file',
  getAsFile: () => fileNamed(name),
  webkitGetAsEntry: () => ({ isDirectory }),
});

describe('dropped files', () => {
  it('opens one file without a word', () => {
    const { file, notice } = decideDrop([item('garden.ply')]);
    expect(file?.name).toBe('garden.ply');
    expect(notice).toBeNull();
  });

  it('opens the first PLY of several and says so', () => {
    const { file, notice } = decideFiles([fileNamed('notes.txt'), fileNamed('a.PLY'), fileNamed('b.ply')]);
    expect(file?.name).toBe('a.PLY');
    expect(notice).toBe('One scene at a time: a.PLY is opened, the other 2 files were left out.');
  });

  it('explains folders and what is no file', () => {
    expect(decideDrop([item('scans', true)])).toMatchObject({
      file: null,
      notice: expect.stringContaining('folder'),
    });
    expect(decideDrop([])).toMatchObject({ file: null, notice: expect.stringContaining('no file') });
  });
});
