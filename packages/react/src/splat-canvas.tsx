import { Canvas, type CanvasProps, type RootState, useThree } from '@react-three/fiber';
import {
  type AccuracyRequest,
  callListener,
  DEFAULT_ACCURACY,
  DestroyedError,
  type Detail,
  foreseeEngine,
  RecoveryPace,
  setWorkerUrl,
  WebGpuUnavailableError,
} from '@websplatter/core';
import { findSplatEngine, onDeviceLost, setSplatDetail } from '@websplatter/three';
import { type ReactNode, useEffect, useRef, useState } from 'react';
import { type CanvasView, canvasStates, FirstPicture } from './canvas-states.ts';
import { type CanvasRendererParameters, createSplatRenderer } from './create-splat-renderer.ts';
import { PosterFrame } from './poster-frame.tsx';
import { mountSplatDevice, setSplatDevice } from './splat-device.ts';
import { useLatest, useSame } from './stable-values.ts';
import { useCanvasRenderer } from './use-renderer.ts';

/** Props of `<SplatCanvas>`. */
export interface SplatCanvasProps extends Omit<CanvasProps, 'gl'> {
  /** Accuracy of splats: settings, or a target like `{ minPsnrDb: 45 }`; default `balanced`. */
  accuracy?: AccuracyRequest;
  /** How much of the clouds to show: `full`, the default, `{ maxErrorPx: 0.5 }` or `{ maxSplats: 1e6 }`. */
  detail?: Detail;
  /** Further options of `createSplatRenderer`, read when the renderer is made. */
  gl?: Omit<CanvasRendererParameters, 'accuracy' | 'canvas' | 'detail'>;
  /**
   * URL of a hosted `@websplatter/core/load-worker`, for bundlers that do not bundle workers. Applies
   * to the whole page, as `setWorkerUrl` does. Read when the renderer is made.
   */
  workerUrl?: string | URL;
  /**
   * Covers the canvas until it shows splats: the URL of an image, or an element that fills its
   * parent. Included in server-rendered HTML. Without WebGPU it stays, below the `fallback` of a
   * `<SplatsErrorBoundary>`. Ignored if it is first set after the first render.
   */
  poster?: ReactNode;
  /** Alternative text of the image at the URL `poster`; default empty, as for decoration. */
  posterAlt?: string;
}

/** @param reason the browser's message for the last loss; may be empty. */
const lostRepeatedly = (reason: string) =>
  `The GPU device was lost again and again: the scene may be too large, or the browser ends it for a reason of its own${reason && ` (${reason})`}. Reload the page.`;

/** Props of the Canvases below a poster. */
interface CanvasesProps extends Omit<SplatCanvasProps, 'poster' | 'posterAlt'> {
  /** Called once the splats are on the screen. */
  onShown?: () => void;
}

/** One Canvas in the succession of Canvases, each of which replaces the one before. */
interface Life {
  readonly generation: number;
  /** Time before it requests a device, ms. */
  readonly waitMs: number;
  /** Camera of the Canvas before; undefined for the first. */
  readonly camera?: RootState['camera'];
}

/**
 * A `<Canvas>` of react-three-fiber that draws splats, and replaces itself with a new one when its
 * GPU device is lost. The camera stays, contents mount again, and files are read again. If the device
 * is lost again less than a minute after a `<Splats>` was drawn completely, it waits for 1, 4 and
 * then 16 seconds.
 *
 * @throws CodeUnavailableError to the nearest error boundary if the engine's code cannot be
 *   fetched; WebGpuUnavailableError if there is no WebGPU, or if the device is lost once more. To
 *   try again, mount another one.
 * @example
 * <SplatCanvas flat style={{ height: '100vh' }}>
 *   <Splats src="/garden.ply" />
 * </SplatCanvas>
 */
export function SplatCanvas({
  poster,
  posterAlt = '',
  className,
  style,
  ...props
}: SplatCanvasProps): ReactNode {
  // Fixed at the first render: another parent would make React replace the Canvas.
  const [hasPoster] = useState(Boolean(poster));
  if (!hasPoster) return <Canvases {...props} className={className} style={style} />;
  // The Canvas sets its own `pointerEvents`, and so does not inherit them.
  const pointerEvents = style?.pointerEvents && { pointerEvents: style.pointerEvents };
  return (
    <PosterFrame poster={poster} alt={posterAlt} className={className} style={style}>
      {(onShown) => <Canvases {...props} style={pointerEvents} onShown={onShown} />}
    </PosterFrame>
  );
}

function Canvases({
  accuracy = DEFAULT_ACCURACY,
  detail = 'full',
  gl: parameters,
  workerUrl,
  onShown,
  children,
  ...props
}: CanvasesProps): ReactNode {
  const latest = useLatest(onShown);
  const [pace] = useState(() => {
    // Prefetch the engine while Canvas measures itself, before it requests a renderer.
    foreseeEngine();
    return new RecoveryPace();
  });
  const [{ generation, waitMs, camera }, setLife] = useState<Life>({ generation: 0, waitMs: 0 });
  const [view] = useState((): CanvasView => ({ isFitted: false, left: null }));
  const created = useRef<RootState>(null);
  useEffect(() => mountSplatDevice(pace), [pace]);
  const replace = (error: unknown) => {
    const nextMs = pace.next();
    setSplatDevice(pace, nextMs === null ? 'gone' : 'lost');
    const { camera: lost, controls = null } = created.current?.get() ?? {};
    // Controls of the next Canvas may move the camera before they are aimed.
    if (lost) view.left = { position: lost.position.clone(), controls };
    setLife(() => {
      if (nextMs === null) throw error;
      return { generation: generation + 1, waitMs: nextMs, camera: lost ?? camera };
    });
  };
  const gl: CanvasProps['gl'] = async (defaults) => {
    try {
      if (generation > 0) {
        // Wait here, not in an effect: a hidden `<Activity>` and Fast Refresh end effects.
        await timePassed(0);
        for (let seconds = waitMs / 1000; seconds > 0; seconds--) {
          setSplatDevice(pace, 'retrying', seconds);
          await timePassed(1000);
        }
        // The page is gone, and with it any reader of a message.
        if (!(defaults.canvas as HTMLCanvasElement).isConnected) throw new Error();
      }
      setSplatDevice(pace, generation > 0 ? 'lost' : 'pending');
      if (workerUrl) setWorkerUrl(workerUrl);
      const renderer = await createSplatRenderer({ ...defaults, ...parameters, accuracy, detail });
      const picture = new FirstPicture(() => {
        state.isViewKept = false;
        callListener(latest.current);
      });
      const accuracyKey = JSON.stringify(accuracy);
      const state = { pace, picture, accuracyKey, view, isViewKept: view.isFitted };
      canvasStates.set(renderer, state);
      setSplatDevice(pace, 'ready');
      onDeviceLost(renderer, ({ reason, message }) => {
        console.warn(
          `The GPU device of a <SplatCanvas> was lost (${reason}${message && `: ${message}`}). The <SplatCanvas> asks for another; useSplatDevice() reports its state.`,
        );
        picture.end();
        replace(new WebGpuUnavailableError(lostRepeatedly(message)));
      });
      return renderer;
    } catch (error) {
      // A browser may have no adapter while its GPU process restarts: retry instead of throwing.
      if (generation > 0) replace(error);
      else setSplatDevice(pace, 'gone');
      throw error;
    }
  };

  return (
    <Canvas
      key={generation}
      {...props}
      camera={camera ?? props.camera}
      gl={gl}
      onCreated={(state) => {
        created.current = state;
        props.onCreated?.(state);
      }}
    >
      <EngineAccuracy accuracy={accuracy} />
      <CanvasDetail detail={detail} />
      {children}
    </Canvas>
  );
}

const timePassed = (ms: number) => new Promise((resolve) => setTimeout(resolve, ms));

/** Passes `accuracy` on to the engine of the Canvas when it changes. */
function EngineAccuracy({ accuracy }: { accuracy: AccuracyRequest }): ReactNode {
  const renderer = useCanvasRenderer()!;
  const invalidate = useThree((state) => state.invalidate);
  const key = JSON.stringify(accuracy);
  // biome-ignore lint/correctness/useExhaustiveDependencies: the key stands for the accuracy.
  useEffect(() => {
    const state = canvasStates.get(renderer)!;
    if (state.accuracyKey === key) return;
    state.accuracyKey = key;
    try {
      // Each cloud reports the precisions that it cannot get.
      void findSplatEngine(renderer)?.setAccuracy(accuracy);
      invalidate();
    } catch (error) {
      // The device was lost: the Canvas is about to be replaced.
      if (!(error instanceof DestroyedError)) throw error;
    }
  }, [renderer, key, invalidate]);
  return null;
}

/** Passes `detail` on to the renderer of the Canvas when it changes. */
function CanvasDetail({ detail }: { detail: Detail }): ReactNode {
  const renderer = useCanvasRenderer()!;
  const invalidate = useThree((state) => state.invalidate);
  const same = useSame(detail);
  useEffect(() => {
    setSplatDetail(renderer, same);
    invalidate();
  }, [renderer, same, invalidate]);
  return null;
}
