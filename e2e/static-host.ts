import { createReadStream } from 'node:fs';
import { stat } from 'node:fs/promises';
import { createServer } from 'node:http';
import type { AddressInfo } from 'node:net';
import { extname, join } from 'node:path';
import { CONTENT_SECURITY_POLICY, type ServedFiles } from './server.ts';

export interface StaticHost {
  /** Address of the folder, with a slash at its end. */
  readonly url: string;
  readonly close: () => Promise<void>;
}

const CONTENT_TYPES: Readonly<Record<string, string>> = {
  '.html': 'text/html',
  '.js': 'text/javascript',
  '.css': 'text/css',
  '.svg': 'image/svg+xml',
};

/**
 * Serves the files of `folder` below `path` (`/some/where/`), as a plain web server does: what is not a file is not found,
 * folders and addresses at the root included. `files` lie beside them. `headers` are sent with all.
 */
export async function startStaticHost(
  folder: string,
  path: string,
  files: ServedFiles = {},
  headers: Readonly<Record<string, string>> = { 'content-security-policy': CONTENT_SECURITY_POLICY },
): Promise<StaticHost> {
  const server = createServer(async (request, response) => {
    const { pathname } = new URL(request.url ?? '/', 'http://localhost');
    const name = decodeURIComponent(pathname).slice(path.length);
    const all = { 'content-type': CONTENT_TYPES[extname(name)] ?? 'application/octet-stream', ...headers };
    if (pathname.startsWith(path) && Object.hasOwn(files, name)) {
      response.writeHead(200, all).end(files[name]);
      return;
    }
    const file = join(folder, name);
    const isFile = pathname.startsWith(path) && (await stat(file).catch(() => null))?.isFile();
    if (isFile) createReadStream(file).pipe(response.writeHead(200, all));
    // Browsers ask for it where a page has no icon of its own.
    else response.writeHead(pathname === '/favicon.ico' ? 204 : 404).end();
  });
  await new Promise<void>((resolve) => server.listen(0, '127.0.0.1', resolve));
  return {
    url: `http://127.0.0.1:${(server.address() as AddressInfo).port}${path}`,
    close: () =>
      new Promise((resolve) => {
        server.closeAllConnections();
        server.close(() => resolve());
      }),
  };
}
