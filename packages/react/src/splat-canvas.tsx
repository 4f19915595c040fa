import { Canvas, type CanvasProps, type RootState, useThree } from '@react-three/fiber';
import {
  type AccuracyRequest,
  DEFAULT_ACCURACY,
  DestroyedError,
  RecoveryPace,
  WebGpuUnavailableError,
} from '@websplatter/core';
import { onDeviceLost, splatEngineOf } from '@websplatter/three';
import { type ReactNode, type RefObject, useEffect, useRef, useState } from 'react';
import { type CanvasRendererParameters, createSplatRenderer } from './create-splat-renderer.ts';
import { useCanvasRenderer } from './use-renderer.ts';

export interface SplatCanvasProps extends Omit<CanvasProps, 'gl'> {
  /** How exactly and how fast to draw splats: settings, or a wish such as `{ minPsnrDb: 45 }`; default `balanced`. */
  accuracy?: AccuracyRequest;
  /** Further options of `createSplatRenderer`, read when the renderer is made. */
  gl?: Omit<CanvasRendererParameters, 'accuracy' | 'canvas'>;
}

const LOST_REPEATEDLY =
  'The GPU device was lost again and again: its memory may be too small for the scene, or the driver at fault. ' +
  'Reload the page, or mount the Canvas again.';

/** One of the Canvases that follow one another. */
interface Life {
  readonly generation: number;
  /** The camera of the one before. */
  readonly camera?: RootState['camera'];
}

/**
 * A `<Canvas>` of react-three-fiber that draws splats, and that replaces itself with a fresh one when its GPU device is
 * lost: its camera stays, its contents mount again, and their files are read again. If the device is lost again within a minute, that waits for
 * 1, 4 and then 16 seconds.
 *
 * @throws WebGpuUnavailableError to the nearest error boundary if there is no WebGPU, or if the device is lost once more. To
 *   try again, mount another one.
 */
export function SplatCanvas({
  accuracy = DEFAULT_ACCURACY,
  gl: parameters,
  children,
  ...props
}: SplatCanvasProps): ReactNode {
  const [pace] = useState(() => new RecoveryPace());
  const [{ generation, camera }, setLife] = useState<Life>({ generation: 0 });
  const shownBy = useRef<Life['camera']>(undefined);
  const [failure, setFailure] = useState<{ readonly error: unknown } | null>(null);
  const timer = useRef<ReturnType<typeof setTimeout>>(undefined);
  useEffect(() => () => clearTimeout(timer.current), []);
  const replace = (error: unknown) => {
    const waitMs = pace.next();
    if (waitMs === null) setFailure({ error });
    else
      timer.current = setTimeout(
        () => setLife({ generation: generation + 1, camera: shownBy.current }),
        waitMs,
      );
  };
  const gl: CanvasProps['gl'] = async (defaults) => {
    try {
      const renderer = await createSplatRenderer({ ...defaults, ...parameters, accuracy });
      engineAccuracies.set(renderer, JSON.stringify(accuracy));
      onDeviceLost(renderer, () => replace(new WebGpuUnavailableError(LOST_REPEATEDLY)));
      return renderer;
    } catch (error) {
      if (generation === 0) throw error;
      // A browser may have no adapter while its GPU process restarts.
      replace(error);
      return new Promise(() => {});
    }
  };

  if (failure) throw failure.error;
  return (
    <Canvas key={generation} {...props} {...(camera && { camera })} gl={gl}>
      <EngineAccuracy accuracy={accuracy} />
      <CameraWatch camera={shownBy} />
      {children}
    </Canvas>
  );
}

/** Tells which camera the Canvas draws with. */
function CameraWatch({ camera }: { camera: RefObject<Life['camera']> }): ReactNode {
  const current = useThree((state) => state.camera);
  useEffect(() => {
    camera.current = current;
  }, [camera, current]);
  return null;
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
