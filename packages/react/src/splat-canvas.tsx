import { Canvas, type CanvasProps } from '@react-three/fiber';
import { type Accuracy, WebGpuUnavailableError } from '@websplatter/core';
import { onDeviceLost } from '@websplatter/three';
import { type ReactNode, useState } from 'react';
import { type CanvasRendererParameters, createSplatRenderer } from './create-splat-renderer.ts';

export interface SplatCanvasProps extends Omit<CanvasProps, 'gl'> {
  /** Default `balanced`. A change makes a new Canvas. */
  accuracy?: Accuracy;
  /** More of what `createSplatRenderer` takes, read when the renderer is made. */
  gl?: Omit<CanvasRendererParameters, 'accuracy' | 'canvas'>;
}

/** More losses than this within a minute are not waited out: something on the page brings the GPU down. */
const MAX_LOSSES_PER_MINUTE = 3;
/** A browser may have no adapter to give while its GPU process starts again. */
const RETRY_DELAYS_MS = [250, 1000, 3000];

/**
 * A `<Canvas>` of react-three-fiber that draws splats, and that replaces itself with a fresh one when its GPU device is
 * lost: what is inside mounts anew, and files that had been read are uploaded again without being fetched.
 *
 * @throws WebGpuUnavailableError to the nearest error boundary where there is no WebGPU, or it is lost again and again.
 */
export function SplatCanvas({ accuracy, gl: parameters, ...props }: SplatCanvasProps): ReactNode {
  const [losses, setLosses] = useState<readonly number[]>([]);
  const gl: CanvasProps['gl'] = async (defaults) => {
    const make = () => createSplatRenderer({ ...defaults, ...parameters, accuracy });
    const renderer = await (losses.length === 0 ? make() : retried(make));
    onDeviceLost(renderer, () => setLosses((times) => [...times, performance.now()]));
    return renderer;
  };

  const isHopeless =
    losses.length > MAX_LOSSES_PER_MINUTE && losses.at(-1)! - losses.at(-1 - MAX_LOSSES_PER_MINUTE)! < 60_000;
  if (isHopeless) {
    throw new WebGpuUnavailableError(
      `The GPU device was lost ${MAX_LOSSES_PER_MINUTE + 1} times within a minute: the scene may need more memory than ` +
        'the GPU has, or the driver may be at fault. Reload the page to try again.',
    );
  }
  return <Canvas key={`${losses.length} ${JSON.stringify(accuracy)}`} {...props} gl={gl} />;
}

async function retried<T>(make: () => Promise<T>): Promise<T> {
  for (const delayMs of RETRY_DELAYS_MS) {
    try {
      return await make();
    } catch {
      await new Promise((resolve) => setTimeout(resolve, delayMs));
    }
  }
  return make();
}
