import { describe, expect, it, vi } from 'vitest';
import { KitFiles, linked, reachable } from './kit-files.ts';

const MANIFEST = {
  entries: { three: 'three.js', react: 'react.js' },
  imports: {
    'three.js': ['core-1.js'],
    'core-1.js': ['three.js', 'later-2.js'],
    'later-2.js': [],
    'react.js': [],
  },
  scenes: [],
};

describe('files of the kit', () => {
  it('are found through all that they import, in circles too', () => {
    expect(reachable(['three.js'], MANIFEST.imports)).toEqual(['three.js', 'core-1.js', 'later-2.js']);
  });

  it('import one another by specifiers of an import map', () => {
    const text = 'import a from"./core-1.js";import(`./later-2.js`);"./else.js"';
    expect(linked(text, ['core-1.js', 'later-2.js'])).toBe(
      'import a from"kit:core-1.js";import(`kit:later-2.js`);"./else.js"',
    );
  });

  it('are read once, and again after a failure', async () => {
    const answers = [
      new Response(JSON.stringify(MANIFEST)),
      new Response('', { status: 503 }),
      new Response('export {};'),
    ];
    const fetched = vi.spyOn(globalThis, 'fetch').mockImplementation(async () => answers.shift()!);
    try {
      const kit = new KitFiles(new URL('https://site.test/docs/kit/'));
      await expect(kit.modules(['react'])).rejects.toThrow(
        'react.js of this site cannot be read: the server answers 503.',
      );
      expect(await kit.modules(['react'])).toEqual({ 'react.js': 'export {};' });
      expect(await kit.modules(['react'])).toEqual({ 'react.js': 'export {};' });
      expect(await kit.addressOf('react')).toBe('https://site.test/docs/kit/react.js');
      expect(fetched).toHaveBeenCalledTimes(3);
    } finally {
      fetched.mockRestore();
    }
  });
});
