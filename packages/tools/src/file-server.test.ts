import { mkdir, mkdtemp, rm, symlink, writeFile } from 'node:fs/promises';
import { get } from 'node:http';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { afterAll, beforeAll, describe, expect, test } from 'vitest';
import { type FileServer, serveFiles } from './file-server.ts';

let room: string;
let server: FileServer;

beforeAll(async () => {
  room = await mkdtemp(join(tmpdir(), 'websplatter-served-'));
  await mkdir(join(room, 'pages/inner'), { recursive: true });
  await writeFile(join(room, 'pages/index.html'), 'a page');
  await writeFile(join(room, 'secret.txt'), 'a secret');
  await writeFile(join(room, 'a+b #1 50%.ply'), 'a scene');
  await symlink(join(room, 'secret.txt'), join(room, 'pages/link.txt'));
  server = await serveFiles(join(room, 'pages'), {
    base: '/some/where/',
    files: { 'scenes/0.ply': join(room, 'a+b #1 50%.ply'), 'gone.ply': join(room, 'gone.ply') },
    headers: { 'cache-control': 'no-store' },
    answer: (path, _request, response) => path === 'own' && Boolean(response.end('an answer')),
  });
});
afterAll(async () => {
  await server?.close();
  await rm(room, { recursive: true, force: true });
});

/** Asks for a path as it is: `fetch` would resolve its dots. */
function ask(path: string, headers = {}) {
  return new Promise<{ status: number; text: string; headers: object }>((resolve, reject) => {
    get({ host: '127.0.0.1', port: new URL(server.url).port, path, headers }, async (response) => {
      const text = (await response.setEncoding('utf8').toArray()).join('');
      resolve({ status: response.statusCode!, text, headers: response.headers });
    }).on('error', reject);
  });
}

const page = { status: 200, text: 'a page' };

describe('the server of files', () => {
  /**
   * @fault Pages and packages: a request to the file server of tests or benches is malformed, or leaves
   *   its folder
   * @consequence status 400 to 404; the server goes on
   */
  test.each([
    '/some/where/../secret.txt',
    '/some/where/..%2fsecret.txt',
    '/some/where/..%2Fpages%2F..%2Fsecret.txt',
    '/some/where/%2e%2e/secret.txt',
    '/some/where/inner/%2e%2e/%2e%2e/secret.txt',
    '/some/where/..%5csecret.txt',
    '/some/where/%2fetc%2fpasswd',
    '/some/where/%',
    '/some/where/%c0%ae',
    '/some/where/%00',
    '/some/where/index.html%00.txt',
    '/some/where/gone.ply',
    '/some/where/inner',
    '/some/where/inner/',
    '/some/where/',
    '/some/where',
    '/index.html',
    '/',
    '//',
    '/%',
  ])('refuses %s, and goes on', async (path) => {
    const { status, text } = await ask(path);
    expect(status).toBeGreaterThanOrEqual(400);
    expect(status).toBeLessThanOrEqual(404);
    expect(text).not.toContain('a secret');
    expect(await ask('/some/where/index.html')).toMatchObject(page);
  });

  /**
   * @fault Pages and packages: a range ends before it begins, at the file server of tests or benches
   * @consequence status 416; the server goes on
   */
  test('refuses a range that ends before it begins, and goes on', async () => {
    const headers = { range: 'bytes=3-1' };
    expect(await ask('/some/where/index.html', headers)).toMatchObject({ status: 416 });
    expect(await ask('/some/where/index.html')).toMatchObject(page);
  });

  test('sends files with their types and its headers, whatever the query', async () => {
    const headers = { 'content-type': 'text/html; charset=utf-8', 'cache-control': 'no-store' };
    expect(await ask('/some/where/index.html?a=%')).toMatchObject({ ...page, headers });
  });

  test('sends files from elsewhere under the addresses that it was given', async () => {
    expect(await ask('/some/where/scenes/0.ply')).toMatchObject({ status: 200, text: 'a scene' });
  });

  test('leaves a path to who answers it', async () => {
    const headers = { 'cache-control': 'no-store' };
    expect(await ask('/some/where/own?x')).toMatchObject({ status: 200, text: 'an answer', headers });
  });

  test('follows a link out of its folder', async () => {
    expect(await ask('/some/where/link.txt')).toMatchObject({ status: 200, text: 'a secret' });
  });
});
