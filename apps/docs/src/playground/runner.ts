// The script of an example's page: an iframe with an opaque origin, isolated from the site. All
// modules and files arrive in one message and are imported from memory.
import { kitSpecifier, MOUNT_ENTRY } from './kit-manifest.ts';
import type { RunMessage, RunReport } from './run-messages.ts';

const report = (message: RunReport) => parent.postMessage(message, '*');

addEventListener('error', ({ error, message }) => reportProblem(error ?? message));
addEventListener('unhandledrejection', ({ reason }) => reportProblem(reason));
addEventListener('message', ({ source, data }: MessageEvent<RunMessage>) => {
  if (source === parent && data.kind === 'run') run(data).catch(reportProblem);
});
report({ kind: 'ready' });

async function run({ kit, entries, modules, entry, loadWorker, scenes }: RunMessage): Promise<void> {
  const sceneUrls = Object.fromEntries(
    Object.entries(scenes).map(([name, bytes]) => [new URL(name, document.baseURI).href, blobUrl(bytes)]),
  );
  readFromMemory(sceneUrls);
  const workerUrl = blobUrl(
    `(${readFromMemory})(${JSON.stringify(sceneUrls)});\n${loadWorker}`,
    'text/javascript',
  );
  allowWorkersFromMemory();
  reportFirstPicture();

  const imports: Record<string, string> = {};
  for (const [file, text] of Object.entries(kit))
    imports[kitSpecifier(file)] = blobUrl(text, 'text/javascript');
  for (const [specifier, file] of Object.entries(entries)) imports[specifier] = imports[kitSpecifier(file)];
  for (const [specifier, text] of Object.entries(modules))
    imports[specifier] = blobUrl(text, 'text/javascript');
  const map = document.createElement('script');
  map.type = 'importmap';
  map.textContent = JSON.stringify({ imports });
  document.head.append(map);

  const { mount, hostWorker } = await import(/* @vite-ignore */ MOUNT_ENTRY);
  hostWorker(workerUrl);
  const { default: component } = await import(/* @vite-ignore */ entry);
  if (typeof component === 'function') mount(component, reportDrawn);
  report({ kind: 'running' });
}

function blobUrl(content: string | ArrayBuffer, type = 'application/octet-stream'): string {
  return URL.createObjectURL(new Blob([content], { type }));
}

/**
 * Redirects `fetch` for the keys of `urls` to their values, which are blob URLs. Also runs in the
 * worker, as text: it must not use anything from its surroundings.
 */
function readFromMemory(urls: Readonly<Record<string, string>>): void {
  const { fetch } = globalThis;
  globalThis.fetch = async (input, options) => {
    // Nothing is relative to the page's own URL, about:srcdoc, nor to the worker's.
    const address = input instanceof Request ? input.url : new URL(input, globalThis.document?.baseURI).href;
    return fetch(Object.hasOwn(urls, address) ? urls[address] : input, options);
  };
}

/**
 * Chromium starts no module workers from memory in a page with an opaque origin. The kit's workers
 * are classic scripts without imports.
 */
function allowWorkersFromMemory(): void {
  const { Worker } = globalThis;
  globalThis.Worker = class extends Worker {
    constructor(url: string | URL, options?: WorkerOptions) {
      super(url, String(url).startsWith('blob:') ? { ...options, type: 'classic' } : options);
    }
  };
}

function reportDrawn(): void {
  report({ kind: 'drawn' });
}

/** Reports, once, that a canvas shows more than one colour. */
function reportFirstPicture(): void {
  // Without WebGPU, examples show a message themselves.
  if (!('GPUCanvasContext' in globalThis)) return;
  const { prototype } = GPUCanvasContext;
  const { getCurrentTexture } = prototype;
  prototype.getCurrentTexture = function (this: GPUCanvasContext) {
    // Runs after the drawing code, and before the browser takes the texture.
    queueMicrotask(() => {
      if (prototype.getCurrentTexture === getCurrentTexture || !hasColors(this.canvas)) return;
      prototype.getCurrentTexture = getCurrentTexture;
      reportDrawn();
    });
    return getCurrentTexture.call(this);
  };
}

function hasColors(canvas: CanvasImageSource): boolean {
  const sidePx = 16;
  const context = new OffscreenCanvas(sidePx, sidePx).getContext('2d')!;
  context.drawImage(canvas, 0, 0, sidePx, sidePx);
  const { data } = context.getImageData(0, 0, sidePx, sidePx);
  return new Uint32Array(data.buffer).some((pixel, _, [first]) => pixel !== first);
}

function reportProblem(error: unknown): void {
  const message = error instanceof Error ? `${error.name}: ${error.message}` : String(error);
  // The first stack frame in the example's files, recognised by the compiler's specifiers.
  const [, path = null, line] =
    (error instanceof Error && /app:\/([^\s:()]+):(\d+)/.exec(error.stack ?? '')) || [];
  report({ kind: 'problem', message, path, line: line ? Number(line) : null });
}
