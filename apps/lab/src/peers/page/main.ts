// A page with one peer. Everything is wrapped before the adapter and the peer's own code run.
import { nextTask, type Peer } from '../adapter.ts';
import { turnedCamera } from '../turned-camera.ts';
import { ByteLedger } from './byte-ledger.ts';
import { canvasPicture } from './canvas-picture.ts';
import { completionOf, type Drawer, type Wait } from './completion.ts';
import { DrawnPeer } from './drawn-peer.ts';
import { FrameTimes } from './frame-times.ts';
import { GpuTime } from './gpu-time.ts';
import type { BenchPage, LoadRequest, Measured, MeasureRequest } from './protocol.ts';
import { atRest, watchFirst } from './stream.ts';
import { watchPasses } from './watch-passes.ts';
import { watchWebGl } from './watch-webgl.ts';
import { watchWebGpu } from './watch-webgpu.ts';

const MAX_PROBLEMS = 12;

const problems: string[] = [];
const complain = (problem: string) => {
  if (problems.length < MAX_PROBLEMS) problems.push(problem.slice(0, 400));
};
addEventListener('error', ({ message }) => complain(message));
addEventListener('unhandledrejection', ({ reason }) => complain(String(reason?.stack ?? reason)));

const ledger = new ByteLedger();
const webgpu = watchWebGpu(ledger, complain);
watchWebGl(ledger);
const passes = watchPasses();
const { default: loadPeer, formats = ['ply'] } = await import('virtual:peer-adapter');

let drawn: DrawnPeer | undefined;

const page: BenchPage = {
  formats: () => formats,
  async load(request) {
    const canvas = canvasOf(request);
    const file = request.url === null ? droppedFile() : null;
    const url = file ? URL.createObjectURL(file) : request.url!;
    let firstSplats: Promise<number> | undefined;
    const longestTask = watchLongTasks();
    const startedMs = performance.now();
    const sinceStartMs = () => performance.now() - startedMs;
    const peer = await loadPeer({
      canvas,
      url,
      fileName: request.fileName,
      file,
      camera: request.camera,
      options: new URLSearchParams(location.search),
      shown: () => {
        // Waits in the way that takes nothing from the thread, which has a scene to load.
        firstSplats ??= Promise.resolve(completionOf(drawerOf(canvas), 'done')()).then(sinceStartMs);
      },
    });
    peer.setCamera(request.camera);
    await peer.order?.();
    drawn = await drawnPeer(peer, canvas, request.wait);
    const loadMs = sinceStartMs();
    const longestTaskMs = longestTask();
    const firstSplatsMs = (await firstSplats) ?? loadMs;
    return { loadMs, firstSplatsMs, longestTaskMs, api: drawn.drawer.api, note: peer.note };
  },
  async stream(request) {
    const longestTask = watchLongTasks();
    const { peer, startedMs } = await openStream(request);
    const completeMs = (await atRest(loaded())) - startedMs;
    const { api } = loaded().drawer;
    return {
      ...{ startedAtMs: performance.timeOrigin + startedMs, completeMs },
      ...{ longestTaskMs: longestTask(), api, note: peer.note },
    };
  },
  async streamWatched(request) {
    const { startedMs } = await openStream(request);
    return {
      startedAtMs: performance.timeOrigin + startedMs,
      ...(await watchFirst(loaded(), webgpu, startedMs)),
    };
  },
  async measure(request) {
    return measure(loaded(), webgpu.gpuTime, request);
  },
  async pictures(cameras) {
    const pictures = [];
    for (const camera of cameras) {
      await loaded().correctFrame(camera);
      if (loaded().peer.isComplete) await atRest(loaded());
      pictures.push(await canvasPicture(loaded(), webgpu, camera.name));
    }
    return pictures;
  },
  state: () => ({
    gpuBytes: ledger.bytes,
    gpuPeakBytes: ledger.peakBytes,
    adapter: drawn?.drawer.api === 'webgl2' ? rendererOf(drawn.drawer.gl) : webgpu.adapter(),
    figures: drawn?.peer.figures?.() ?? {},
    problems,
  }),
};
Object.assign(window, { bench: page });

/** Opens a scene that streams and draws a first frame; `startedMs` is by the page's clock. */
async function openStream(
  request: LoadRequest,
): Promise<{ readonly peer: Peer; readonly startedMs: number }> {
  const canvas = canvasOf(request);
  const startedMs = performance.now();
  const peer = await loadPeer({
    canvas,
    url: request.url!,
    fileName: request.fileName,
    file: null,
    camera: request.camera,
    options: new URLSearchParams(location.search),
    shown: () => {},
  });
  peer.setCamera(request.camera);
  drawn = await drawnPeer(peer, canvas, request.wait);
  return { peer, startedMs };
}

function canvasOf({ widthPx, heightPx }: LoadRequest): HTMLCanvasElement {
  const canvas = document.createElement('canvas');
  canvas.width = widthPx;
  canvas.height = heightPx;
  canvas.style.width = `${widthPx}px`;
  canvas.style.height = `${heightPx}px`;
  document.body.append(canvas);
  return canvas;
}

function droppedFile(): File {
  const file = document.querySelector('input')?.files?.[0];
  if (!file) throw new Error('The page has not been given a file.');
  return file;
}

/** Draws a first frame to its end. */
async function drawnPeer(peer: Peer, canvas: HTMLCanvasElement, wait: Wait): Promise<DrawnPeer> {
  // Some set up the canvas with their first frame, which then shows the API that they draw by.
  await peer.draw();
  const drawer = drawerOf(canvas);
  const first = new DrawnPeer(peer, canvas, drawer, completionOf(drawer, wait));
  await first.completion();
  webgpu.gpuTime = drawer.api === 'webgpu' ? GpuTime.of(drawer.device) : null;
  return first;
}

function drawerOf(canvas: HTMLCanvasElement): Drawer {
  const device = webgpu.deviceOf(canvas);
  if (device) return { api: 'webgpu', device };
  const gl = canvas.getContext('webgl2');
  if (gl) return { api: 'webgl2', gl };
  throw new Error('The adapter draws neither by WebGPU nor by WebGL 2 to the canvas that it was given.');
}

function rendererOf(gl: WebGL2RenderingContext): string {
  const names = gl.getExtension('WEBGL_debug_renderer_info');
  return gl.getParameter(names?.UNMASKED_RENDERER_WEBGL ?? gl.RENDERER);
}

function loaded(): DrawnPeer {
  if (!drawn) throw new Error('The page has not loaded a scene.');
  return drawn;
}

const TURN = 2 * Math.PI;
/** The golden angle: successive jumps are far apart, and no place comes twice. */
const JUMP = TURN * (1 - 1 / ((1 + Math.sqrt(5)) / 2));

async function measure(
  drawn: DrawnPeer,
  gpuTime: GpuTime | null,
  request: MeasureRequest,
): Promise<Measured> {
  const { camera, frames, warmUpFrames, jumps } = request;
  const { peer } = drawn;
  const step = TURN / frames;
  for (let frame = -warmUpFrames; frame < 0; frame++) {
    peer.setCamera(turnedCamera(camera, frame * step));
    await drawn.frame();
    await nextTask();
  }

  await drawn.correctFrame(camera);
  const ordersBefore = peer.orders?.();
  const turnMs: number[] = [];
  // From the first step on: a peer may leave out a frame in which nothing has changed.
  for (let frame = 1; frame <= frames; frame++) {
    const startedMs = performance.now();
    peer.setCamera(turnedCamera(camera, frame * step));
    await drawn.frame();
    turnMs.push(performance.now() - startedMs);
    // Orders of workers and the compositor get their turn.
    await nextTask();
  }
  const orders = ordersBefore === undefined ? null : peer.orders!() - ordersBefore;

  await drawn.correctFrame(camera);
  const correctMs: number[] = [];
  for (let jump = 1; jump <= jumps; jump++) {
    // A worker that still sorts for the view before would be charged to this one.
    await peer.order?.();
    await nextTask();
    const startedMs = performance.now();
    await drawn.correctFrame(turnedCamera(camera, jump * JUMP));
    correctMs.push(performance.now() - startedMs);
  }

  const gpuMs: number[] = [];
  for (let frame = 1; gpuTime && frame <= frames; frame++) {
    peer.setCamera(turnedCamera(camera, frame * step));
    gpuMs.push(await gpuTime.timeMs(() => drawn.frame()));
    await nextTask();
  }

  const { drawer } = drawn;
  const isTimed = request.isByPass && gpuTime && drawer.api === 'webgpu';
  const times = isTimed ? await FrameTimes.of(drawer.device, passes) : null;
  const byPass =
    (await times?.measure(frames, (frame) => {
      peer.setCamera(turnedCamera(camera, frame * step));
      return peer.draw();
    })) ?? null;
  return { turnMs, orders, correctMs, gpuMs, byPass };
}

/** Watches for tasks that block the page; the returned function ends it and returns the longest, ms; 0 if none is above 50 ms. */
function watchLongTasks(): () => number {
  let longestMs = 0;
  const note = (entries: PerformanceEntryList) => {
    for (const { duration } of entries) longestMs = Math.max(longestMs, duration);
  };
  const observer = new PerformanceObserver((list) => note(list.getEntries()));
  observer.observe({ type: 'longtask' });
  return () => {
    note(observer.takeRecords());
    observer.disconnect();
    return longestMs;
  };
}
