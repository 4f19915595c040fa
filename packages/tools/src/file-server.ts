import { createServer, type IncomingMessage, type ServerResponse } from 'node:http';
import type { AddressInfo } from 'node:net';
import { basename, dirname } from 'node:path';
import send from 'send';

export interface FileServer {
  /** Address of the folder, with a slash at its end. */
  readonly url: string;
  close(): Promise<void>;
}

export interface FileServerOptions {
  /** Path of the folder's address, with a slash at both ends; default `/`. */
  readonly base?: string;
  /** Paths of files elsewhere, by their addresses below `base`; they hide those of the folder. */
  readonly files?: Readonly<Record<string, string>>;
  /** Sent with every file. */
  readonly headers?: Readonly<Record<string, string>>;
  /** Answers requests for paths below `base` by itself; false for those that are left to the server. */
  readonly answer?: (path: string, request: IncomingMessage, response: ServerResponse) => boolean;
}

/** `send` opens files with them, too: pieces of 64 KiB, Node's default, take twice the processor time for large scenes. */
const OPTIONS = { index: false, dotfiles: 'allow', highWaterMark: 1 << 20 } as const;

/**
 * Serves the files of `folder` on a free port of this machine. A folder is not found, whether or not it has an
 * `index.html`. Links are followed wherever they lead: the folder is a build or an installation of this user's, who could
 * read their targets anyway.
 */
export async function serveFiles(
  folder: string,
  { base = '/', files = {}, headers = {}, answer }: FileServerOptions = {},
): Promise<FileServer> {
  const server = createServer((request, response) => {
    const [address] = request.url!.split('?');
    // Browsers ask for it where a page has no icon of its own.
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
