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
  /** How exactly and how fast to draw splats: settings, or a wish such as `{ minPsnrDb: 45 }`; default `balanced`. */
  accuracy?: AccuracyRequest;
  /** Further options of `createSplatRenderer`, read when the renderer is made. */
  gl?: Omit<CanvasRendererParameters, 'accuracy' | 'canvas'>;
}

/** After more losses than this within a minute, the Canvas gives up: something on the page brings the GPU down. */
const MAX_LOSSES_PER_MINUTE = 3;
/** A browser may have no adapter while its GPU process restarts. */
const RETRY_DELAYS_MS = [250, 1000, 3000];

/**
 * A `<Canvas>` of react-three-fiber that draws splats, and that replaces itself with a fresh one when its GPU device is
 * lost: its contents mount again, and their files are read again.
 *
 * @throws WebGpuUnavailableError to the nearest error boundary if there is no WebGPU, or if the device is lost repeatedly.
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
    engineAccuracies.set(renderer, JSON.stringify(accuracy));
    onDeviceLost(renderer, () => setLosses((times) => [...times, performance.now()]));
    return renderer;
  };

  const isHopeless =
    losses.length > MAX_LOSSES_PER_MINUTE && losses.at(-1)! - losses.at(-1 - MAX_LOSSES_PER_MINUTE)! < 60_000;
  if (isHopeless) {
    throw new WebGpuUnavailableError(
      `The GPU device was lost ${MAX_LOSSES_PER_MINUTE + 1} times within a minute: its memory may be too small for the ` +
        'scene, or the driver may be at fault. Reload the page to try again.',
    );
  }
  return (
    <Canvas key={losses.length} {...props} gl={gl}>
      <EngineAccuracy accuracy={accuracy} />
      {children}
    </Canvas>
  );
}

/**
 * Accuracy of each renderer's engine, as JSON. Setting the same one again would make the engine claim it for clouds that
 * have an accuracy of their own.
 */
const engineAccuracies = new WeakMap<object, string>();

/** Passes `accuracy` on to the engine of the Canvas when it changes. */
function EngineAccuracy({ accuracy }: { accuracy: AccuracyRequest }): ReactNode {
  const renderer = useCanvasRenderer()!;
  const invalidate = useThree((state) => state.invalidate);
  const key = JSON.stringify(accuracy);
  // biome-ignore lint/correctness/useExhaustiveDependencies: the key stands for the accuracy, which may be a new object at each render.
  useEffect(() => {
    if (engineAccuracies.get(renderer) === key) return;
    engineAccuracies.set(renderer, key);
    try {
      // Each cloud reports the precisions that it cannot get.
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
