import { Canvas, type CanvasProps, useThree } from '@react-three/fiber';
import {
  type AccuracyRequest,
  DEFAULT_ACCURACY,
  DestroyedError,
  WebGpuUnavailableError,
} from '@websplatter/core';
import { onDeviceLost, splatEngineOf } from '@websplatter/three';
import { type ReactNode, useEffect, useState } from 'react';
import { type CanvasRendererParameters, createSplatRenderer } from './create-splat-renderer.ts';
import { useCanvasRenderer } from './use-renderer.ts';

export interface SplatCanvasProps extends Omit<CanvasProps, 'gl'> {
  /** How exactly splats are drawn, and how fast: settings, or a wish such as `{ minPsnrDb: 45 }`; default `balanced`. */
  accuracy?: AccuracyRequest;
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
export function SplatCanvas({
  accuracy = DEFAULT_ACCURACY,
  gl: parameters,
  children,
  ...props
}: SplatCanvasProps): ReactNode {
  const [losses, setLosses] = useState<readonly number[]>([]);
  const gl: CanvasProps['gl'] = async (defaults) => {
    const make = () => createSplatRenderer({ ...defaults, ...parameters, accuracy });
    const renderer = await (losses.length === 0 ? make() : retried(make));
    toldAccuracy.set(renderer, JSON.stringify(accuracy));
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
  return (
    <Canvas key={losses.length} {...props} gl={gl}>
      <EngineAccuracy accuracy={accuracy} />
      {children}
    </Canvas>
  );
}

/** By renderer, as JSON: asked for it again, the engine would ask clouds that have an accuracy of their own. */
const toldAccuracy = new WeakMap<object, string>();

/** Tells the engine of a Canvas what `accuracy` has become since its renderer was made. */
function EngineAccuracy({ accuracy }: { accuracy: AccuracyRequest }): ReactNode {
  const renderer = useCanvasRenderer()!;
  const invalidate = useThree((state) => state.invalidate);
  const key = JSON.stringify(accuracy);
  // biome-ignore lint/correctness/useExhaustiveDependencies: the key stands for the accuracy, which may be a new object at each render.
  useEffect(() => {
    if (toldAccuracy.get(renderer) === key) return;
    toldAccuracy.set(renderer, key);
    try {
      // What a cloud cannot have of it, the cloud tells.
      void splatEngineOf(renderer).setAccuracy(accuracy);
      invalidate();
    } catch (error) {
      // The device was lost: the Canvas is about to be replaced.
      if (!(error instanceof DestroyedError)) throw error;
    }
  }, [renderer, key, invalidate]);
  return null;
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
