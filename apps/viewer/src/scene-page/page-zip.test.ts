import { expect, test } from 'vitest';
import { zipPage } from './page-zip.ts';

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
