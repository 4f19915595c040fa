import { splatEngineOf } from '@websplatter/three';
import type { PerspectiveCamera, WebGPURenderer } from 'three/webgpu';

/**
 * A fake XR session for three's WebGPURenderer, without a headset. `XRGPUBinding` returns one texture
 * with a layer for each view; `drawFrame` starts a frame. Implements only the members that three 0.187
 * calls.
 */
export class FakeXrSession extends EventTarget {
  readonly enabledFeatures = ['webgpu'];
  readonly #views: readonly PerspectiveCamera[];
  readonly #sizePx: number;
  #frameCallback: ((timeMs: number, frame: unknown) => void) | null = null;
  #texture: GPUTexture | null = null;

  /** @param views cameras of the views, with their matrices up to date. */
  constructor(views: readonly PerspectiveCamera[], sizePx: number) {
    super();
    this.#views = views;
    this.#sizePx = sizePx;
  }

  /** Starts the session in `renderer`, which draws frames only by `drawFrame` from then on. */
  async begin(renderer: WebGPURenderer): Promise<void> {
    const { device } = splatEngineOf(renderer);
    const format = 'rgba8unorm';
    const { RENDER_ATTACHMENT, COPY_SRC } = GPUTextureUsage;
    const size = [this.#sizePx, this.#sizePx, this.#views.length];
    this.#texture = device.createTexture({ size, format, usage: RENDER_ATTACHMENT | COPY_SRC });
    const [sizePx, colorTexture] = [this.#sizePx, this.#texture];
    const binding = {
      getPreferredColorFormat: () => format,
      createProjectionLayer: () => ({ textureWidth: sizePx, textureHeight: sizePx }),
      getViewSubImage: (_: unknown, { index }: { index: number }) => ({
        colorTexture,
        viewport: { x: 0, y: 0, width: sizePx, height: sizePx },
        getViewDescriptor: () => ({ dimension: '2d', baseArrayLayer: index, arrayLayerCount: 1 }),
      }),
    };
    const xr = renderer.xr as unknown as Record<string, unknown> & typeof renderer.xr;
    // three looks for the browser's binding when a renderer is made.
    xr._supportsWebGPUBinding = true;
    (globalThis as Record<string, unknown>).XRGPUBinding = class {
      constructor() {
        Object.assign(this, binding);
      }
    };
    xr.enabled = true;
    await xr.setSession(this as never);
  }

  /** Draws the frame that three has requested. */
  drawFrame(): void {
    const callback = this.#frameCallback!;
    this.#frameCallback = null;
    const views = this.#views.map(({ matrixWorld, projectionMatrix }, index) => ({
      index,
      transform: { matrix: matrixWorld.elements },
      projectionMatrix: projectionMatrix.elements,
    }));
    callback(performance.now(), { session: this, getViewerPose: () => ({ views }) });
  }

  /** The image of a view, RGBA with 0…255, top row first. */
  async pixels(view: number, device: GPUDevice): Promise<number[]> {
    const bytesPerRow = Math.ceil((4 * this.#sizePx) / 256) * 256;
    const usage = GPUBufferUsage.COPY_DST | GPUBufferUsage.MAP_READ;
    const buffer = device.createBuffer({ size: bytesPerRow * this.#sizePx, usage });
    const encoder = device.createCommandEncoder();
    const from = { texture: this.#texture!, origin: [0, 0, view] };
    encoder.copyTextureToBuffer(from, { buffer, bytesPerRow }, [this.#sizePx, this.#sizePx]);
    device.queue.submit([encoder.finish()]);
    await buffer.mapAsync(GPUMapMode.READ);
    const bytes = new Uint8Array(buffer.getMappedRange());
    const rows = Array.from({ length: this.#sizePx }, (_, y) =>
      bytes.subarray(y * bytesPerRow, y * bytesPerRow + 4 * this.#sizePx),
    );
    const pixels = rows.flatMap((row) => [...row]);
    buffer.destroy();
    return pixels;
  }

  end(): void {
    this.dispatchEvent(new Event('end'));
    this.#texture?.destroy();
    delete (globalThis as Record<string, unknown>).XRGPUBinding;
  }

  // The interface that three calls.

  requestAnimationFrame(callback: (timeMs: number, frame: unknown) => void): number {
    this.#frameCallback = callback;
    return 1;
  }
  cancelAnimationFrame(): void {
    this.#frameCallback = null;
  }
  updateRenderState(): void {}
  requestReferenceSpace(): Promise<object> {
    return Promise.resolve({});
  }
}
