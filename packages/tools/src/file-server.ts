import { createServer, type IncomingMessage, type ServerResponse } from 'node:http';
import type { AddressInfo } from 'node:net';
import { basename, dirname } from 'node:path';
import send from 'send';

export interface FileServer {
  /** URL of the folder, with a trailing slash. */
  readonly url: string;
  close(): Promise<void>;
}

export interface FileServerOptions {
  /** URL path of the folder, with a slash at both ends; default `/`. */
  readonly base?: string;
  /** Additional files by URL path below `base`; they take precedence over the folder's files. */
  readonly files?: Readonly<Record<string, string>>;
  /** Headers sent with every file. */
  readonly headers?: Readonly<Record<string, string>>;
  /** Handles a request for a path below `base`; returns false to let the server handle it. */
  readonly answer?: (path: string, request: IncomingMessage, response: ServerResponse) => boolean;
}

/**
 * Also the chunk size of `send`: Node's default of 64 KiB takes twice the CPU time for large
 * scenes.
 */
const OPTIONS = { index: false, dotfiles: 'allow', highWaterMark: 1 << 20 } as const;

/**
 * Serves the files of `folder` on a free local port. Folders return 404, even with an `index.html`.
 * Symbolic links are followed anywhere: the folder belongs to this user, who could read their
 * targets anyway.
 */
export async function serveFiles(
  folder: string,
  { base = '/', files = {}, headers = {}, answer }: FileServerOptions = {},
): Promise<FileServer> {
  const server = createServer((request, response) => {
    const [address] = request.url!.split('?');
    // Browsers request it for pages without an icon.
    if (address === '/favicon.ico') return response.writeHead(204).end();
    if (!address.startsWith(base)) return response.writeHead(404).end();
    const path = address.slice(base.length);
    const file = Object.hasOwn(files, path) ? files[path] : null;
    const root = file ? dirname(file) : folder;
    response.setHeaders(new Map(Object.entries(headers)));
    if (answer?.(path, request, response)) return;
    send(request, file ? encodeURIComponent(basename(file)) : path, { ...OPTIONS, root })
      .on('directory', () => response.writeHead(404).end())
      .pipe(response);
  });
  await new Promise<void>((resolve) => server.listen(0, '127.0.0.1', resolve));
  return {
    url: `http://127.0.0.1:${(server.address() as AddressInfo).port}${base}`,
    close: () =>
      new Promise((resolve) => {
        server.closeAllConnections();
        server.close(() => resolve());
      }),
  };
}
