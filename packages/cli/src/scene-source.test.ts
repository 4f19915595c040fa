import { truncateSync } from 'node:fs';
import { readSplats } from '@websplatter/core';
import { describe, expect, test } from 'vitest';
import { findScene } from './scene-source.ts';
import { TestFolder } from './testing/test-folder.ts';

async function sourceOf(path: string): Promise<Blob> {
  return (await findScene(path)).source as Blob;
}

describe('a file', () => {
  test('can be read any number of times', async () => {
    const source = await sourceOf(new TestFolder().scene());
    for (let i = 0; i < 2; i++) expect((await readSplats(source)).count).toBe(3);
  });

  /**
   * @fault Files: a file on disk has 4 GiB or more
   * @consequence read, with its true size
   */
  test('of more than 4 GiB has its whole size', async () => {
    const path = new TestFolder().scene();
    // Takes no space on a disk.
    const bytes = 2 ** 32 + 1000;
    truncateSync(path, bytes);
    const source = await sourceOf(path);
    expect(source.size).toBe(bytes);
    expect((await readSplats(source)).count).toBe(3);
  });
});
