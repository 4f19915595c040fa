import { execFileSync, spawn } from 'node:child_process';
import { once } from 'node:events';
import { existsSync } from 'node:fs';
import { createServer } from 'node:net';
import { describe, expect, test } from 'vitest';
import { readJsonFile } from './json-file.ts';
import { TestFolder } from './testing/test-folder.ts';

test('a file is read, whatever its name', async () => {
  const folder = new TestFolder();
  expect(await readJsonFile(folder.write('meta.json', { a: 1 }), 'camera')).toEqual({ a: 1 });
  await expect(readJsonFile(folder.path, 'camera')).rejects.toThrow(
    `${folder.path}: the camera cannot be read: it is a folder, not a file`,
  );
});

describe.skipIf(process.platform === 'win32')('what is no file', () => {
  test('a pipe is read', async () => {
    const pipe = new TestFolder().file('pipe');
    execFileSync('mkfifo', [pipe]);
    spawn('sh', ['-c', 'printf "[1]" > "$0"', pipe]);
    expect(await readJsonFile(pipe, 'camera')).toEqual([1]);
  });

  /**
   * @fault Command line: a camera or a matrix is a socket, a folder or a device without end
   * @consequence one line that names it, exit status 2
   */
  test('a socket, and a device without end, are refused', async ({ skip }) => {
    const socket = new TestFolder().file('socket');
    const server = createServer().listen(socket);
    await once(server, 'listening');
    await expect(readJsonFile(socket, 'camera')).rejects.toThrow(`${socket}: it is a socket`);
    server.close();
    if (!existsSync('/dev/zero')) skip('no /dev/zero here');
    await expect(readJsonFile('/dev/zero', 'camera')).rejects.toThrow(
      '/dev/zero: it has more than 16777216 bytes',
    );
  });
});
