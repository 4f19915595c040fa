import type { IncomingMessage, ServerResponse } from 'node:http';
import { encodePly } from '@websplatter/core';
import { type Plugin, preview } from 'vite';
import { inject } from 'vitest';
import { configFileOf } from './built-apps.ts';
import { slowScene } from './test-scene.ts';
import { withResolvers } from './with-resolvers.ts';

/** Sent with every page. A breach of it is logged as an error, and so fails the test. */
export const CONTENT_SECURITY_POLICY =
  "default-src 'self'; script-src 'self'; worker-src 'self'; style-src 'self'";

/**
 * Files to serve besides an app's own, by path from the root, e.g. `scene.ply`. They are read at each request;
 * null: the app's own.
 */
export type ServedFiles = Readonly<Record<string, Uint8Array | null>>;

/** Answer to a request for a file or a part of it. `refuse`: a status after which browsers do not retry. */
export type PartAnswer = 'send' | 'hold' | 'refuse';

export interface AppServer {
  /** URL of the app, with a trailing slash. */
  readonly url: string;
  /** Resolves when a browser has aborted a request for `endless.ply`. */
  readonly whenEndlessFileIsDropped: () => Promise<void>;
  /** Sends the rest of `slow.ply` to pages that have requested it. */
  readonly sendRestOfSlowFile: () => void;
  /** Closes the connections of pages that have requested `slow.ply`, without the rest. */
  readonly cutSlowFile: () => void;
  /**
   * Sets the answer to later requests for parts of `.bricks` and `.frames` files that begin at byte `from` or after
   * (default 1: all parts but the first). `send` also answers held requests.
   */
  readonly answerParts: (how: PartAnswer, from?: number) => void;
  /**
   * Sets the answer to later requests for whole files whose paths match, e.g. `/^plaza\//`; all others
   * are sent, also those held so far. Of held `.frames`, three fifths are sent at once.
   */
  readonly answerFiles: (how: PartAnswer, paths: RegExp) => void;
  /** Number of held requests, for files and parts, whose browser still waits. */
  readonly heldParts: () => number;
  /** Closes the connections of held requests, without an answer. */
  readonly cutHeldParts: () => void;
  /** Number of requests for the file at `path` so far. */
  readonly requests: (path: string) => number;
  readonly close: () => Promise<void>;
}

/**
 * Serves an app as it is shipped on a free port. Its file `endless.ply` begins like a splat file
 * and never continues; its file `slow.ply` pauses after three fifths of `slowScene`.
 *
 * @param appFolder folder of the app's `vite.config.ts`, relative to the repository's root, e.g.
 * `apps/viewer`
 */
export async function startAppServer(appFolder: string, files: ServedFiles = {}): Promise<AppServer> {
  const outDir = await builtApp(appFolder);
  const requests = new Map<string, number>();
  let dropped = withResolvers();
  let sendRest = () => {};
  let cut = () => {};
  /** By the first byte of a part, and by the path of a file. */
  const [parts, wholeFiles] = [new Gate<number>(), new Gate<string>()];
  const testFiles: Plugin = {
    name: 'test-files',
    configurePreviewServer({ middlewares }) {
      middlewares.use((request, _response, next) => {
        const path = new URL(request.url ?? '/', 'http://localhost').pathname.slice(1);
        requests.set(path, (requests.get(path) ?? 0) + 1);
        next();
      });
      // Browsers ask for it where a page has no icon of its own.
      middlewares.use('/favicon.ico', (_request, response: ServerResponse) => {
        response.writeHead(204).end();
      });
      for (const path of Object.keys(files)) {
        middlewares.use(`/${path}`, (request: IncomingMessage, response: ServerResponse, next) => {
          const bytes = files[path];
          if (!bytes) {
            // Another test may serve another file.
            response.setHeader('cache-control', 'no-store');
            return next();
          }
          const range =
            /\.(bricks|frames)$/.test(path) && /^bytes=(\d+)-(\d+)$/.exec(request.headers.range ?? '');
          if (range) {
            const [, start, last] = range.map(Number);
            parts.answer(start, response, () => sendPart(response, bytes, start, last + 1));
          } else if (path.endsWith('.frames')) {
            const begun = Math.floor(0.6 * bytes.length);
            beginFile(response, bytes);
            response.write(bytes.subarray(0, begun));
            wholeFiles.answer(path, response, () => response.end(bytes.subarray(begun)));
          } else wholeFiles.answer(path, response, () => sendFile(response, bytes));
        });
      }
      middlewares.use('/slow.ply', (_request, response: ServerResponse) => {
        const bytes = encodePly(slowScene());
        response.writeHead(200, {
          'content-type': 'application/octet-stream',
          'content-length': bytes.length,
        });
        const pause = Math.floor(0.6 * bytes.length);
        response.write(bytes.subarray(0, pause));
        sendRest = () => response.end(bytes.subarray(pause));
        cut = () => response.destroy();
      });
      middlewares.use('/endless.ply', (_request, response: ServerResponse) => {
        dropped = withResolvers();
        response.on('close', dropped.resolve);
        response.writeHead(200, {
          'content-type': 'application/octet-stream',
          'content-length': 100_000_000,
        });
        response.write(endlessHeader(400_000));
        response.write(new Uint8Array(1_000_000));
      });
    },
  };
  const server = await preview({
    configFile: configFileOf(appFolder),
    logLevel: 'error',
    build: { outDir },
    plugins: [testFiles],
    // Port 0: the system picks a free one.
    preview: { host: '127.0.0.1', port: 0, headers: { 'content-security-policy': CONTENT_SECURITY_POLICY } },
  });
  const url = server.resolvedUrls?.local[0];
  if (!url) throw new Error('The preview server has no address.');
  return {
    url,
    whenEndlessFileIsDropped: () => dropped.promise,
    sendRestOfSlowFile: () => sendRest(),
    cutSlowFile: () => cut(),
    answerParts: (how, from = 1) => parts.decide(how, (start) => start >= from),
    answerFiles: (how, paths) => wholeFiles.decide(how, (path) => paths.test(path)),
    heldParts: () => parts.heldCount + wholeFiles.heldCount,
    cutHeldParts: () => {
      parts.cut();
      wholeFiles.cut();
    },
    requests: (path) => requests.get(path) ?? 0,
    close: () => server.close(),
  };
}

/** Sends, holds or refuses the answers to requests. */
class Gate<Request> {
  /** Requests that are held, by functions that answer them. */
  readonly #held = new Map<() => void, { request: Request; response: ServerResponse }>();
  #how: PartAnswer = 'send';
  #applies: (request: Request) => boolean = () => false;

  /** @param applies whether a request is answered in this way; all others are sent. */
  decide(how: PartAnswer, applies: (request: Request) => boolean): void {
    this.#how = how;
    this.#applies = applies;
    for (const [send, { request }] of [...this.#held]) if (this.#isSent(request)) send();
  }

  answer(request: Request, response: ServerResponse, send: () => void): void {
    if (this.#isSent(request)) send();
    else if (this.#how === 'refuse') response.writeHead(403).end();
    else {
      const release = () => {
        this.#held.delete(release);
        send();
      };
      this.#held.set(release, { request, response });
      response.on('close', () => this.#held.delete(release));
    }
  }

  cut(): void {
    for (const { response } of this.#held.values()) response.destroy();
  }

  get heldCount(): number {
    return this.#held.size;
  }

  #isSent(request: Request): boolean {
    return this.#how === 'send' || !this.#applies(request);
  }
}

function beginFile(response: ServerResponse, bytes: Uint8Array): void {
  response.writeHead(200, {
    'content-type': 'application/octet-stream',
    'content-length': bytes.length,
  });
}

function sendFile(response: ServerResponse, bytes: Uint8Array): void {
  beginFile(response, bytes);
  response.end(bytes);
}

function sendPart(response: ServerResponse, bytes: Uint8Array, start: number, end: number): void {
  const part = bytes.subarray(start, end);
  response.writeHead(206, {
    'content-type': 'application/octet-stream',
    'content-length': part.length,
    'content-range': `bytes ${start}-${start + part.length - 1}/${bytes.length}`,
  });
  response.end(part);
}

/** Folder of an app built as it is shipped, once for all test files. */
export async function builtApp(appFolder: string): Promise<string> {
  const response = await fetch(`${inject('builtAppsUrl')}/${encodeURIComponent(appFolder)}`);
  const answer = await response.text();
  if (!response.ok) throw new Error(`${appFolder} does not build: ${answer}`);
  return answer;
}

function endlessHeader(splats: number): string {
  const names = ['x', 'y', 'z', 'f_dc_0', 'f_dc_1', 'f_dc_2', 'opacity'];
  for (let i = 0; i < 3; i++) names.push(`scale_${i}`);
  for (let i = 0; i < 4; i++) names.push(`rot_${i}`);
  const properties = names.map((name) => `property float ${name}\n`).join('');
  return `ply\nformat binary_little_endian 1.0\nelement vertex ${splats}\n${properties}end_header\n`;
}
