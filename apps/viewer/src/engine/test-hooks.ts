import type { DrawnFrame } from './drawn-frame.ts';
import { titleOfAll } from './scene-source.ts';

/**
 * For tests and other observers of the page: writes on the canvas that an image is at rest
 * (`data-resting`), the title of the scene that it shows (`data-scene`), its camera
 * (`data-camera`), and how many frames have been drawn (`data-frames`).
 */
export function writeRest(canvas: HTMLCanvasElement, { scene, frame }: DrawnFrame, frameCount: number): void {
  const { camera, clouds, background } = frame;
  canvas.dataset.resting = '';
  canvas.dataset.scene = titleOfAll(scene.parts.map(({ source }) => source));
  canvas.dataset.frames = String(frameCount);
  canvas.dataset.camera = JSON.stringify({
    viewMatrix: Array.from(camera.viewMatrix),
    projectionMatrix: Array.from(camera.projectionMatrix),
    near: camera.near,
    far: camera.far,
    modelMatrices: clouds.map(({ modelMatrix }) => (modelMatrix ? Array.from(modelMatrix) : null)),
    opacities: clouds.map(({ opacity = 1 }) => opacity),
    background,
  });
}

/** Another image is requested. The caller sees this at once, and waits for the next rest. */
export function clearRest(canvas: HTMLCanvasElement): void {
  delete canvas.dataset.resting;
}
