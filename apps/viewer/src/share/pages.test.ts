import { expect, test } from 'vitest';
import type { HeldPart } from './page-text.ts';
import { zipPage } from './pages.ts';

const TEMPLATE = '<html lang="en"><head><title>x</title></head><body></body></html>';

test('files lie beside the page, in a folder for each part, and several of one part in an archive', async () => {
  const file = (path: string) => ({ path, bytes: new Blob([`in ${path}`]) });
  const parts = [
    { title: 'a', builtin: null, files: [file('50% a.ply')] },
    { title: 'room', builtin: null, files: [file('meta.json'), file('means.webp')] },
  ];
  const zip = await zipPage(
    TEMPLATE,
    { title: 'a and room', view: 'camera=0', background: null, parts },
    new Blob(['png']),
    { signal: new AbortController().signal, onPart: () => {} },
  );
  const text = await zip.text();
  for (const path of ['index.html', 'poster.png', 'scene/1/50% a.ply', 'scene/2/room.zip', 'means.webp'])
    expect(text).toContain(path);
  expect(text).toContain('<meta name="websplatter-poster" content="poster.png">');
  expect(text).toContain('<a data-path="50% a.ply" href="scene/1/50%25%20a.ply"></a>');
  expect(text).toContain('<a data-path="room.zip" href="scene/2/room.zip"></a>');
});

/** Names of the entries of a zip, from its directory. */
async function entriesOf(zip: Blob): Promise<string[]> {
  const bytes = Buffer.from(await zip.arrayBuffer());
  const names: string[] = [];
  const end = bytes.length - 22;
  for (let at = bytes.readUInt32LE(end + 16); at < end; ) {
    const nameEnd = at + 46 + bytes.readUInt16LE(at + 28);
    names.push(bytes.toString('utf8', at + 46, nameEnd));
    at = nameEnd;
  }
  return names;
}

const zipOf = (parts: readonly HeldPart[]) =>
  zipPage(TEMPLATE, { title: 'a', view: '', background: null, parts }, new Blob(['png']), {
    signal: new AbortController().signal,
    onPart: () => {},
  });

test('names from outside stay in the folders of their parts', async () => {
  const file = (path: string) => ({ path, bytes: new Blob(['x']) });
  const names = ['../../evil.ply', '..\\evil.ply', 'a\0\n\u202e.ply', 'CON.ply', '.htaccess', '..'];
  const zip = await zipOf([
    ...names.map((name) => ({ title: name, builtin: null, files: [file(name)] })),
    { title: '../up', builtin: null, files: [file('meta.json'), file('images/means.webp')] },
  ]);
  expect(await entriesOf(zip)).toEqual([
    'index.html',
    'poster.png',
    'scene/1/__.._evil.ply',
    'scene/2/__evil.ply',
    'scene/3/a___.ply',
    'scene/4/_CON.ply',
    'scene/5/_htaccess',
    'scene/6/_',
    'scene/7/__up.zip',
  ]);
  expect(await zip.text()).toContain('href="scene/3/a___.ply"');
});

/**
 * @fault Saved files: the name of a scene or a file leads out of its folder, is a device of Windows, has
 *   control or bidirectional characters, or is of any length
 */
test('a file of a scene in several that lies outside of its folder is refused', async () => {
  const files = ['meta.json', '../means.webp'].map((path) => ({ path, bytes: new Blob(['x']) }));
  await expect(zipOf([{ title: 'room', builtin: null, files }])).rejects.toThrow('outside');
});
