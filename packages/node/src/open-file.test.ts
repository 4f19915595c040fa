import { execFileSync, spawn } from 'node:child_process';
import { appendFileSync, existsSync, renameSync, statSync, utimesSync, writeFileSync } from 'node:fs';
import { mkdir, mkdtemp, rm, writeFile } from 'node:fs/promises';
import { createServer } from 'node:net';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import type { SceneFiles } from '@websplatter/core';
import { afterAll, afterEach, beforeAll, describe, expect, test, vi } from 'vitest';
import { openFile } from './open-file.ts';

let folder: string;
beforeAll(async () => {
  folder = await mkdtemp(join(tmpdir(), 'websplatter-open-file-'));
  await mkdir(join(folder, 'scene/parts'), { recursive: true });
  await mkdir(join(folder, 'empty'));
  await writeFile(join(folder, 'a.ply'), 'twelve bytes');
  await writeFile(join(folder, 'scene/scene.gltf'), '{}');
  await writeFile(join(folder, 'scene/parts/a.bin'), 'part');
});
afterAll(() => rm(folder, { recursive: true, force: true }));

const textOf = (blob: Blob) => new Response(blob.stream()).text();

test('a file can be read again and again, and has a name and a size', async () => {
  const file = (await openFile(join(folder, 'a.ply'))) as File;
  expect(file).toMatchObject({ name: 'a.ply', size: 12 });
  for (let i = 0; i < 2; i++) expect(await textOf(file)).toBe('twelve bytes');
});

test.each(['scene/scene.gltf', 'scene'])('%s comes with the files that it leads to', async (path) => {
  const { files, paths } = (await openFile(join(folder, path))) as SceneFiles;
  expect(paths).toEqual(['scene.gltf', 'parts/a.bin']);
  expect(await Promise.all(files.map(textOf))).toEqual(['{}', 'part']);
});

test.each([
  ['empty', 'EISDIR'],
  ['none.ply', 'ENOENT'],
])('%s is %s', async (path, code) => {
  await expect(openFile(join(folder, path))).rejects.toMatchObject({ code });
});

describe('a file that changes after it was opened', () => {
  const path = () => join(folder, 'changing.ply');
  const timesOf = () => {
    const { atime, mtime } = statSync(path());
    return [atime, mtime] as const;
  };
  test.each([
    ['grows', () => appendFileSync(path(), 'more')],
    ['is written anew', () => writeFileSync(path(), 'other bytes!')],
    [
      'is replaced by one of its size and time',
      () => {
        const times = timesOf();
        writeFileSync(`${path()}.new`, 'other bytes!');
        utimesSync(`${path()}.new`, ...times);
        renameSync(`${path()}.new`, path());
      },
    ],
    ['is removed', () => rm(path())],
  ])('and %s is refused, whole and in parts', async (_, change) => {
    await writeFile(path(), 'twelve bytes');
    utimesSync(path(), new Date(1e12), new Date(1e12));
    const file = (await openFile(path())) as File;
    expect(await textOf(file)).toBe('twelve bytes');
    await change();
    const refused = {
      name: 'SplatSourceError',
      message: `${path()}: it changed while it was read; try again once nothing writes it`,
    };
    await expect(textOf(file)).rejects.toMatchObject(refused);
    await expect(file.slice(0, 4).arrayBuffer()).rejects.toMatchObject(refused);
  });

  test('while it is read is refused at its end', async () => {
    await writeFile(path(), new Uint8Array(3 << 20));
    utimesSync(path(), new Date(1e12), new Date(1e12));
    const reader = ((await openFile(path())) as File).stream().getReader();
    expect((await reader.read()).done).toBe(false);
    writeFileSync(path(), new Uint8Array(3 << 20).fill(1), { flag: 'r+' });
    const readAll = async () => {
      while (!(await reader.read()).done);
    };
    await expect(readAll()).rejects.toThrow('it changed while it was read');
  });

  /**
   * @fault Command line: a file changes, is replaced or is removed while it is read, including a part or a
   *   piece
   * @consequence `SplatSourceError` that names it; one line, exit status 2, no file
   */
  test('as a part of a scene, or as a piece, is refused', async () => {
    for (const name of ['pieces.bricks.000', 'pieces.bricks.001']) await writeFile(join(folder, name), name);
    const pieces = (await openFile(join(folder, 'pieces.bricks.000'))) as File;
    const { files } = (await openFile(join(folder, 'scene'))) as SceneFiles;
    await writeFile(join(folder, 'pieces.bricks.001'), 'another piece');
    await expect(textOf(pieces)).rejects.toThrow('it changed while it was read');
    await writeFile(join(folder, 'scene/parts/a.bin'), 'a longer part');
    await expect(textOf(files[1])).rejects.toThrow('it changed while it was read');
    await writeFile(join(folder, 'scene/parts/a.bin'), 'part');
  });
});

describe.skipIf(process.platform === 'win32')('what is no file', () => {
  afterEach(() => {
    vi.useRealTimers();
  });
  const pipeIn = (name: string) => {
    const path = join(folder, name);
    execFileSync('mkfifo', [path]);
    return path;
  };
  const streamOf = async (path: string) => new Response((await openFile(path)) as ReadableStream).text();

  test('a pipe is read to its end, whenever its writer comes and however slowly it writes', async () => {
    const path = pipeIn('pipe');
    const text = streamOf(path);
    const writer = spawn('sh', ['-c', 'exec > "$0"; sleep 0.1; printf slow; sleep 0.1; printf ly', path]);
    expect(await text).toBe('slowly');
    expect(writer.pid).toBeGreaterThan(0);
  });

  test('a pipe that is longer than a system holds is read whole', async () => {
    const path = pipeIn('long');
    spawn('sh', ['-c', 'head -c 3000000 /dev/zero > "$0"', path]);
    expect((await streamOf(path)).length).toBe(3_000_000);
  });

  /**
   * @fault Command line: a scene is a pipe that nothing writes to
   * @consequence after 10 s one line, exit status 2; a slow writer is waited for
   */
  test('a pipe without a writer fails after a while', async () => {
    const path = pipeIn('unwritten');
    vi.useFakeTimers({ toFake: ['setTimeout'] });
    vi.setTimerTickMode('nextTimerAsync');
    await expect(streamOf(path)).rejects.toThrow(
      `${path}: it is a pipe, and nothing has written to it for 10 s`,
    );
  });

  /**
   * @fault Command line: a scene, or an output, is a socket; a scene is a terminal
   * @consequence one line before the work, exit status 2
   */
  test('a socket is refused', async () => {
    const path = join(folder, 'socket');
    const server = createServer().listen(path);
    await new Promise((resolve) => server.once('listening', resolve));
    await expect(openFile(path)).rejects.toThrow(`${path}: it is a socket; give a file or a pipe`);
    server.close();
  });

  test('a terminal is refused', async ({ skip }) => {
    if (!existsSync('/dev/ptmx')) skip('no /dev/ptmx here');
    await expect(openFile('/dev/ptmx')).rejects.toThrow('/dev/ptmx: it is a terminal; give a file');
  });
});
