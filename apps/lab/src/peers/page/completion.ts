import { nextTask } from '../adapter.ts';

/**
 * How the end of WebGPU's work is awaited: `done`, by onSubmittedWorkDone; `poke`, the same with
 * empty submissions in between, so that the GPU process looks at its fences sooner; `map`, by
 * mapping four bytes that are copied behind the frame. Which is quickest depends on browser and
 * driver.
 */
export const WAITS = ['done', 'poke', 'map'] as const;
export type Wait = (typeof WAITS)[number];

const POKE_EVERY_MS = 0.2;

/** The API that draws to a canvas. */
export type Drawer =
  | { readonly api: 'webgpu'; readonly device: GPUDevice }
  | { readonly api: 'webgl2'; readonly gl: WebGL2RenderingContext };

/** Makes the function that resolves when all that has been submitted is done. */
export function completionOf(drawer: Drawer, wait: Wait): () => Promise<unknown> | undefined {
  if (drawer.api === 'webgl2') return () => finishWebGl(drawer.gl);
  const { device } = drawer;
  if (wait === 'map') return mapping(device);
  return wait === 'poke' ? () => poked(device) : () => device.queue.onSubmittedWorkDone();
}

/** Reads one pixel of the canvas: Chromium's `finish` does not wait. */
function finishWebGl(gl: WebGL2RenderingContext): undefined {
  const framebuffer = gl.getParameter(gl.READ_FRAMEBUFFER_BINDING);
  const packBuffer = gl.getParameter(gl.PIXEL_PACK_BUFFER_BINDING);
  gl.bindFramebuffer(gl.READ_FRAMEBUFFER, null);
  gl.bindBuffer(gl.PIXEL_PACK_BUFFER, null);
  gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
  gl.bindFramebuffer(gl.READ_FRAMEBUFFER, framebuffer);
  gl.bindBuffer(gl.PIXEL_PACK_BUFFER, packBuffer);
  if (gl.isContextLost()) throw new Error('The WebGL context is lost.');
}

async function poked(device: GPUDevice): Promise<void> {
  let isDone = false;
  const done = device.queue.onSubmittedWorkDone().then(() => {
    isDone = true;
  });
  let pokedMs = performance.now();
  while (!isDone) {
    if (performance.now() - pokedMs > POKE_EVERY_MS) {
      device.queue.submit([]);
      pokedMs = performance.now();
    }
    await nextTask();
  }
  await done;
}

function mapping(device: GPUDevice): () => Promise<void> {
  const source = device.createBuffer({ size: 4, usage: GPUBufferUsage.COPY_SRC });
  const mapped = device.createBuffer({ size: 4, usage: GPUBufferUsage.COPY_DST | GPUBufferUsage.MAP_READ });
  return async () => {
    const encoder = device.createCommandEncoder();
    encoder.copyBufferToBuffer(source, 0, mapped, 0, 4);
    device.queue.submit([encoder.finish()]);
    await mapped.mapAsync(GPUMapMode.READ);
    mapped.unmap();
  };
}
