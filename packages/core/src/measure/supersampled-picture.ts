import type { SizePx } from '../data/accuracy/accuracy.ts';
import type { Camera } from '../data/camera/camera.ts';
import { SHADER_CONSTANTS } from '../data/layout/constants.ts';
import type { FrameRequest } from '../frame/plan/frame-request.ts';
import { averageSamples, SAMPLES_PER_SIDE } from '../stages/measure/measure.ts';
import type { ComparedView, MeasuredEngine } from './measured-engine.ts';
import { drawMeasured, withView } from './measured-frames.ts';

/** Crops of a picture along each side: one crop has as many samples as the picture has pixels. */
const CROPS_PER_SIDE = SAMPLES_PER_SIDE;
/** Frames that a supersampled picture takes. */
export const CROPS = CROPS_PER_SIDE ** 2;

/** A picture to compare views with. */
export interface SupersampledPicture extends ComparedView {
  destroy(): void;
}

/**
 * Draws `frame` with 4×4 samples per pixel, and averages them in the space in which splats are
 * blended. Draws a sixteenth at a time, so that it takes little more memory than a view of this
 * size and the picture, of 16 bytes per pixel.
 *
 * @param onCrop called before each of `CROPS` frames; ends the drawing if it throws.
 * @throws GpuLimitError, DestroyedError.
 */
export function drawSupersampled(
  engine: MeasuredEngine,
  frame: FrameRequest,
  onCrop: () => void,
): Promise<SupersampledPicture> {
  return withView(engine, async (view) => {
    const { context } = view.blended();
    const { device, pipelines } = context;
    await pipelines.prepare([averageSamples]);
    const memory = context.memory.part();
    try {
      const { widthPx, heightPx } = frame;
      // The last crops reach beyond the picture if its size is not a multiple of CROPS_PER_SIDE.
      const crop = {
        widthPx: Math.ceil(widthPx / CROPS_PER_SIDE),
        heightPx: Math.ceil(heightPx / CROPS_PER_SIDE),
      };
      const { STORAGE_BINDING, COPY_DST } = GPUTextureUsage;
      const textureOf = (label: string, size: SizePx, usage: GPUTextureUsageFlags) =>
        memory.createTarget(label, 'rgba32float', { width: size.widthPx, height: size.heightPx }, usage);
      const { result, checked } = memory.guard('A supersampled picture', 'Measure smaller images.', () => ({
        picture: textureOf('supersampled picture', frame, COPY_DST),
        averaged: textureOf('averaged samples', crop, STORAGE_BINDING),
      }));
      await checked;
      const { picture, averaged } = result;
      for (let i = 0; i < CROPS; i++) {
        onCrop();
        const x = (i % CROPS_PER_SIDE) * crop.widthPx;
        const y = Math.floor(i / CROPS_PER_SIDE) * crop.heightPx;
        // A few pixels have fewer crops.
        if (x >= widthPx || y >= heightPx) continue;
        await drawMeasured(engine, view, {
          ...frame,
          camera: croppedCamera(frame, crop, [x, y]),
          widthPx: SAMPLES_PER_SIDE * crop.widthPx,
          heightPx: SAMPLES_PER_SIDE * crop.heightPx,
          force: true,
        });
        const samples = view.blended().color!.createView();
        const encoder = device.createCommandEncoder({ label: 'average samples' });
        const pass = encoder.beginComputePass({ label: 'average samples' });
        pass.setPipeline(pipelines.compute(averageSamples)!);
        pass.setBindGroup(0, pipelines.bindGroup(averageSamples, { samples, image: averaged.createView() }));
        pass.dispatchWorkgroups(tilesOf(crop.widthPx), tilesOf(crop.heightPx));
        pass.end();
        encoder.copyTextureToTexture({ texture: averaged }, { texture: picture, origin: { x, y } }, [
          Math.min(crop.widthPx, widthPx - x),
          Math.min(crop.heightPx, heightPx - y),
        ]);
        device.queue.submit([encoder.finish()]);
      }
      memory.destroy(averaged);
      return {
        whenDrawn: async () => {},
        blended: () => ({ context, color: picture }),
        destroy: () => memory.destroyAll(),
      };
    } catch (error) {
      memory.destroyAll();
      throw error;
    }
  });
}

function tilesOf(px: number): number {
  return Math.ceil(px / SHADER_CONSTANTS.IMAGE_TILE_PX);
}

/** The camera whose image is the crop of the frame's image at x, y, in pixels of the frame. */
function croppedCamera(
  { camera, widthPx, heightPx }: FrameRequest,
  crop: SizePx,
  [x, y]: readonly [number, number],
): Camera {
  const { projectionMatrix, wholeProjectionMatrix = projectionMatrix } = camera;
  const matrix = Float64Array.from(projectionMatrix);
  for (let column = 0; column < 16; column += 4) {
    const w = matrix[column + 3];
    matrix[column] = (widthPx * matrix[column] + (widthPx - 2 * x - crop.widthPx) * w) / crop.widthPx;
    matrix[column + 1] =
      (heightPx * matrix[column + 1] - (heightPx - 2 * y - crop.heightPx) * w) / crop.heightPx;
  }
  return { ...camera, projectionMatrix: matrix, wholeProjectionMatrix };
}
