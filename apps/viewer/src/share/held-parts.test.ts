import { afterEach, expect, test, vi } from 'vitest';
import type { SceneSource } from '../engine/open/scene-source.ts';
import { MOST_BYTES, readParts } from './held-parts.ts';

afterEach(() => vi.unstubAllGlobals());

const url = (path: string): SceneSource => ({ kind: 'url', url: new URL(path, 'https://example.org/') });

/** Serves these files alone, by their paths. */
function serve(
  files: Readonly<Record<string, string>>,
  headers: Readonly<Record<string, string>> = {},
): void {
  vi.stubGlobal('fetch', async ({ pathname }: URL) => {
    const text = files[pathname.slice(1)];
    return text === undefined ? new Response(null, { status: 404 }) : new Response(text, { headers });
  });
}

const read = (...sources: readonly SceneSource[]) =>
  readParts(sources, { kind: 'html', signal: new AbortController().signal, onPart: () => {} });

/** Text of each file, by its path, of each part. */
async function texts(...sources: readonly SceneSource[]) {
  const parts = await read(...sources);
  return Promise.all(
    parts.map(async ({ title, files }) => ({
      title,
      files: await Promise.all(files.map(async ({ path, bytes }) => [path, await bytes.text()])),
    })),
  );
}

test('files are held as they came, by their titles and names', async () => {
  serve({ 'a.spz': 'spz' });
  const files = [new File(['1'], 'meta.json'), new Blob(['2'])];
  expect(
    await texts(
      url('a.spz?key'),
      { kind: 'file', name: 'B', source: new File(['ply'], 'b.ply') },
      { kind: 'file', name: 'C', source: { files, paths: ['c/meta.json', 'c/means.webp'] } },
    ),
  ).toEqual([
    { title: 'a.spz', files: [['a.spz', 'spz']] },
    { title: 'B', files: [['b.ply', 'ply']] },
    {
      title: 'C',
      files: [
        ['c/meta.json', '1'],
        ['c/means.webp', '2'],
      ],
    },
  ]);
});

/** Metadata of a SOG with these images, and more. */
function metaOf(means: readonly string[], more: object = {}): string {
  const codebook = Array(256).fill(0);
  return JSON.stringify({
    version: 2,
    count: 1,
    means: { mins: [0, 0, 0], maxs: [1, 1, 1], files: means },
    scales: { codebook, files: ['scales.webp'] },
    quats: { files: ['quats.webp'] },
    sh0: { codebook, files: ['sh0.webp'] },
    ...more,
  });
}

const IMAGES = ['scales.webp', 'quats.webp', 'sh0.webp'];

test('a SOG on a server is held with its images', async () => {
  const meta = metaOf(['m_l.webp', 'm_u.webp']);
  const names = ['m_l.webp', 'm_u.webp', 'quats.webp', 'scales.webp', 'sh0.webp'];
  serve({ 'room/meta.json': meta, ...Object.fromEntries(names.map((name) => [`room/${name}`, name])) });
  expect(await texts(url('room/meta.json'))).toEqual([
    { title: 'room', files: [['meta.json', meta], ...names.map((name) => [name, name])] },
  ]);
});

/**
 * @fault Saved files: the metadata of a SOG lists more files, of other folders or servers
 * @consequence only the images that the engine reads are fetched
 */
test('of a SOG on a server only what the engine reads is fetched', async () => {
  const fetched: string[] = [];
  const serveMeta = (meta: string) => {
    fetched.length = 0;
    vi.stubGlobal('fetch', async (address: URL) => {
      fetched.push(String(address));
      return new Response(String(address).endsWith('.json') ? meta : 'image');
    });
  };
  const others = ['https://evil.example/x', '../secret', '/private', 'other.webp'];
  serveMeta(metaOf(['l.webp', 'u.webp'], { files: others, extra: { deep: { files: others } } }));
  const [{ files }] = await read(url('room/meta.json'));
  const expected = ['meta.json', 'l.webp', 'u.webp', ...IMAGES].sort();
  expect(files.map(({ path }) => path).sort()).toEqual(expected);
  expect(fetched.toSorted()).toEqual(expected.map((name) => `https://example.org/room/${name}`).sort());
  for (const outside of [
    ...others.slice(0, 3),
    '..\\secret',
    '%2e%2e/secret',
    'http:evil.example',
    '.\t./x',
  ]) {
    serveMeta(metaOf([outside, 'u.webp']));
    await expect(read(url('room/meta.json'))).rejects.toMatchObject({
      name: 'Error',
      advice: expect.any(String),
    });
    expect(fetched).toEqual(['https://example.org/room/meta.json']);
  }
});

test('scenes that no page can hold are refused, with what to do', async () => {
  serve({ 'a.ply': 'ply', 'room/lod-meta.json': '{}' }, { 'content-length': String(1.5 * MOST_BYTES.html) });
  await expect(read(url('a.ply'))).rejects.toMatchObject({
    message: 'a.ply has 300 MB: an .html file holds at most 200 MB.',
    advice: expect.stringContaining('.spz'),
  });
  const large = Object.defineProperty(new File([], 'c.ply'), 'size', { value: 2 * MOST_BYTES.html });
  await expect(read({ kind: 'file', name: 'c.ply', source: large })).rejects.toMatchObject({
    message: 'The scene has 400 MB: an .html file holds at most 200 MB.',
  });
  await expect(read(url('room/lod-meta.json'))).rejects.toMatchObject({
    message: 'lod-meta.json may refer to other files on its server.',
    advice: expect.stringContaining('from this device'),
  });
  await expect(read(url('b.ply'))).rejects.toMatchObject({
    message: 'b.ply cannot be read again: the server answers 404.',
    advice: expect.stringContaining('connection'),
  });
});
