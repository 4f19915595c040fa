import type { DrawnFrame } from './drawn-frame.ts';

/**
 * For tests and other observers of the page: writes on the canvas how many frames were drawn (`data-frames`) and the
 * camera of the frame at rest (`data-camera`).
 */
export function writeTestHooks(canvas: HTMLCanvasElement, { frame }: DrawnFrame, frameCount: number): void {
  const { camera, clouds, background } = frame;
  canvas.dataset.frames = String(frameCount);
  canvas.dataset.camera = JSON.stringify({
    viewMatrix: Array.from(camera.viewMatrix),
    projectionMatrix: Array.from(camera.projectionMatrix),
    near: camera.near,
    far: camera.far,
    modelMatrices: clouds.map(({ modelMatrix }) => (modelMatrix ? Array.from(modelMatrix) : null)),
    background,
  });
}
