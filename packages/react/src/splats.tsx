import { type EventHandlers, extend, type ThreeElement } from '@react-three/fiber';
import {
  type AccuracyChoice,
  type AccuracyRequest,
  callListener,
  checkAccuracy,
  type Detail,
  GpuLimitError,
  ShaderError,
  type SourceOptions,
  SplatFileError,
  SplatSourceError,
} from '@websplatter/core';
import {
  onDeviceLost as listenForDeviceLoss,
  type SplatData,
  SplatsPrecisionError,
  SplatsStreamError,
  SplatsUnsupportedRendererError,
} from '@websplatter/three';
import {
  type ReactNode,
  type Ref,
  useEffect,
  useImperativeHandle,
  useLayoutEffect,
  useRef,
  useState,
} from 'react';
import type { Object3D } from 'three';
import { canvasStates } from './canvas-states.ts';
import { checkEffectProps, type EffectProps, isSameUses, takeEffectProps } from './effect-props.ts';
import { isServer } from './is-server.ts';
import type { SplatFileSource } from './splat-cache.ts';
import { SplatCloudObject } from './splat-cloud-object.ts';
import { useLatest, useSame, useSameOfEach } from './stable-values.ts';
import { useFramePace } from './use-frame-pace.ts';
import { useCanvasRenderer } from './use-renderer.ts';
import { useSource } from './use-source.ts';
import { useFoundEngine } from './use-splat-engine.ts';

/**
 * Props of every object of react-three-fiber. All of them are optional there, but Pick would require
 * each one if three's types are not installed. The guide `learn/which-api` lists the others, and why
 * they are refused.
 */
type ObjectProps = Partial<
  Pick<
    ThreeElement<typeof SplatCloudObject>,
    | keyof EventHandlers
    | 'animations'
    | 'castShadow'
    | 'children'
    | 'depthWrite'
    | 'dispose'
    | 'fade'
    | 'fog'
    | 'instances'
    | 'key'
    | 'layers'
    | 'matrix'
    | 'matrixAutoUpdate'
    | 'matrixWorldAutoUpdate'
    | 'name'
    | 'onUpdate'
    | 'opacity'
    | 'position'
    | 'quaternion'
    | 'receiveShadow'
    | 'relight'
    | 'renderOrder'
    | 'rotation'
    | 'scale'
    | 'shDegree'
    | 'time'
    | 'up'
    | 'userData'
    | 'visible'
  >
>;

/** Props of `<Splats>`. */
export interface SplatsProps extends EffectProps, ObjectProps {
  /**
   * The splats to show. URLs are compared by address, everything else by identity. A new source
   * replaces the splats on the screen as soon as it has been read. The first source has previews
   * while it is read. Without a source, or with `''`, nothing is fetched or drawn.
   */
  src?: SplatFileSource | SplatData | null;
  /**
   * How exactly and how fast to draw: settings, or a target such as `{ minPsnrDb: 45 }`; default:
   * the Canvas's. All clouds in view share one frame and its accuracy: see
   * `SplatCloudObject.accuracy` of @websplatter/three for the precedence. A change does not suspend.
   * A finer precision than the file was packed for reads it again in the background.
   */
  accuracy?: AccuracyRequest | null;
  /**
   * Level of detail. `full`: every splat. `{ maxErrorPx: 0.5 }`: merged splats wherever they move
   * light by less than about that. `{ maxSplats: 1e6 }`, `{ maxShare: 0.5 }`: budgets of the splats
   * in sight. `auto`, `{ maxFrameMs }`, `{ minPsnrDb }`: found by measuring. Default: the Canvas's,
   * which is `full`. Clouds in view share one frame, which has the finest detail that any of them
   * requests.
   */
  detail?: Detail | null;
  /**
   * Format of `src`, required if it follows neither from its first bytes nor from its name (`{ format:
   * 'splat' }`); name, limits and requests. The first request for a file decides.
   */
  sourceOptions?: SourceOptions;
  /**
   * Most bytes of GPU memory for a streamed scene. Default: an equal share of the renderer's
   * `streamBudgetBytes`, which is 512 MiB for all scenes. Scenes that need less take less. The first
   * request for a file decides.
   */
  budgetBytes?: number;
  /** The object in the scene. */
  ref?: Ref<SplatCloudObject>;
  /** Called when all splats have been read and are about to be drawn. */
  onLoad?: (splats: SplatData) => void;
  /**
   * Reports progress in bytes. `lengthComputable` is false, and `total` 0, if the total is unknown, as
   * for compressed responses: show an indeterminate bar.
   */
  onProgress?: (event: ProgressEvent) => void;
  /** Called when the first frame with these splats has been submitted to the GPU. */
  onFirstFrame?: () => void;
  /**
   * Called when a frame of a streamed scene is complete: it shows all parts that the view needs, as
   * far as the budget allows. Called again after each frame that lacked parts, such as after a move
   * of the camera. For scenes that do not stream, called with `onFirstFrame`.
   */
  onComplete?: () => void;
  /** Called when settings were chosen for a target; `choice.why` says which and why. */
  onAccuracyChosen?: (choice: AccuracyChoice) => void;
  /**
   * Called with errors of reading and drawing; the splats on the screen stay. Without it, errors of
   * reading and of lacking GPU memory reach the nearest error boundary. Other errors are logged once,
   * because drawing continues: invalid options (the cloud is drawn as before), a ShaderError or a
   * DestroyedError of an effect (the cloud is drawn without that effect), a SplatsPrecisionError
   * (splats are drawn less exactly than requested) and a SplatsStreamError (parts of a streamed scene
   * are missing; call its `retry`).
   */
  onError?: (error: unknown) => void;
  /** Called once when the GPU device is lost, and with it everything that this Canvas draws. */
  onDeviceLost?: (info: GPUDeviceLostInfo) => void;
  /** Shown if the Canvas's renderer cannot draw splats; such a renderer is an error without it. */
  fallback?: ReactNode;
  /**
   * Tests the cloud against a ray, in place of its own test: `raycast={() => null}` lets pointers pass
   * to objects behind it. See `SplatCloudObject.raycast`.
   */
  raycast?: SplatCloudObject['raycast'];
  /** Makes no difference: splats are culled one by one, and none in view is left out. */
  frustumCulled?: boolean;
}

/**
 * Shows Gaussian splats in a react-three-fiber scene. Suspends until a part of the first `src` can
 * be shown; when `src` changes, the old splats stay until the new ones have been read. All other
 * props are set on the object as they change, and request one frame. Equal values change nothing,
 * even in new objects. Set properties of `ref.current` for changes in every frame.
 *
 * Splats count their users, so that `dispose={null}` changes nothing.
 *
 * @throws SplatsUnsupportedRendererError if the Canvas's renderer does not draw with WebGPU and there
 *   is no `fallback`; InvalidArgumentError for an invalid `accuracy`, `opacity` or effect;
 *   SplatFileError, SplatSourceError, GpuLimitError if there is no `onError`.
 * @example
 * <SplatCanvas flat>
 *   <Splats src="/garden.ply" rotation-x={Math.PI} />
 * </SplatCanvas>
 */
export function Splats({ fallback, ...props }: SplatsProps): ReactNode {
  const renderer = useCanvasRenderer();
  const { engine, failure } = useFoundEngine(renderer);
  useFramePace(engine);
  if (!renderer) {
    if (isServer()) return null;
    throw new SplatsUnsupportedRendererError('<Splats> is outside of a Canvas: put it into a <SplatCanvas>.');
  }
  if (failure) {
    if (fallback === undefined || !(failure.error instanceof SplatsUnsupportedRendererError))
      throw failure.error;
    return fallback;
  }
  return <Cloud renderer={renderer} {...props} />;
}

/** Errors that leave nothing to draw. After other errors, drawing continues. */
const LACKS = [SplatFileError, SplatSourceError, GpuLimitError];

// Passed to `extend` as a class, not by name, so that it overrides no app's `<splatCloudObject>`.
const CloudElement = /* @__PURE__ */ extend(SplatCloudObject);

/**
 * Releases the splats of an object that has left the scene. Below a `dispose={null}`,
 * react-three-fiber disposes of nothing, to protect shared resources; splats count their users
 * themselves.
 */
function freeIfUnmounted({ target }: { target: Object3D }): void {
  // Deferred: an object that changes its parent is removed first.
  queueMicrotask(() => target.parent || target.dispose?.());
}

function Cloud({
  renderer,
  src,
  accuracy = null,
  detail = null,
  sourceOptions,
  budgetBytes,
  ref,
  onLoad,
  onProgress,
  onFirstFrame,
  onComplete,
  onAccuracyChosen,
  onError,
  onDeviceLost,
  ...objectProps
}: Omit<SplatsProps, 'fallback'> & { renderer: object }): ReactNode {
  if (accuracy) checkAccuracy(accuracy);
  const object = useRef<SplatCloudObject>(null);
  useImperativeHandle(ref, () => object.current!, []);
  const { time = null } = objectProps;
  const latest = useLatest({
    time,
    onLoad,
    onFirstFrame,
    onComplete,
    onAccuracyChosen,
    onError,
    onDeviceLost,
  });

  const effectProps = takeEffectProps(objectProps);
  const { opacity, fade, relight } = objectProps;
  checkEffectProps({ ...effectProps, opacity, fade, relight });
  const effects = useSame(effectProps.effects, isSameUses);
  const settings = useSameOfEach({ ...effectProps, effects, detail });

  const { splats, load } = useSource(
    src || null,
    renderer,
    { accuracy, sourceOptions, budgetBytes },
    onProgress,
  );
  useEffect(() => {
    if (load?.status === 'failed') callListener(latest.current.onError, load.error);
  }, [load, latest]);

  // react-three-fiber casts rays for onClick, onContextMenu, onDoubleClick, onPointer… and onWheel.
  const hasHandlers = !objectProps.raycast && /\bon[CDPW]/.test(Object.keys(objectProps).join());
  const reported = useRef<SplatData>(null);
  useEffect(() => {
    if (!splats || splats.isPreview) return;
    // The first ray tries again, and reports the error.
    if (hasHandlers) splats.prepareRays(latest.current.time).catch(() => {});
    if (splats === reported.current) return;
    reported.current = splats;
    callListener(latest.current.onLoad, splats);
  }, [splats, latest, hasHandlers]);

  const [drawError, setDrawError] = useState<{ readonly error: unknown } | null>(null);
  useLayoutEffect(() => {
    const cloud = object.current!;
    const listeners = {
      firstframe: () => {
        canvasStates.get(renderer)?.pace.recovered();
        callListener(latest.current.onFirstFrame);
      },
      complete: () => {
        canvasStates.get(renderer)?.picture.drawn();
        callListener(latest.current.onComplete);
      },
      accuracychosen: ({ choice }: { choice: AccuracyChoice }) =>
        callListener(latest.current.onAccuracyChosen, choice),
    };
    const all = Object.entries(listeners) as [keyof typeof listeners, () => void][];
    for (const [type, listener] of all) cloud.addEventListener(type, listener);
    // Not removed when this effect ends: React ends it also when it only hides the cloud.
    cloud.addEventListener('removed', freeIfUnmounted);
    cloud.onError = (error) => {
      if (latest.current.onError) callListener(latest.current.onError, error);
      else if (LACKS.some((Lack) => error instanceof Lack)) setDrawError({ error });
      else if (error instanceof SplatsPrecisionError || error instanceof SplatsStreamError)
        console.warn(error);
      // The layer writes errors of shaders to the console.
      else if (!(error instanceof ShaderError)) console.error(error);
    };
    return () => {
      for (const [type, listener] of all) cloud.removeEventListener(type, listener);
      cloud.onError = null;
    };
  }, [renderer, latest]);

  const isReading = Boolean(src) && load?.status !== 'failed' && (!splats || splats.isPreview);
  useEffect(
    () => (isReading ? canvasStates.get(renderer)?.picture.read() : undefined),
    [renderer, isReading],
  );

  useEffect(
    () => listenForDeviceLoss(renderer, (info) => callListener(latest.current.onDeviceLost, info)),
    [renderer, latest],
  );

  // React does not notify a component that suspended before its first mount when it is discarded,
  // so its load could not be aborted. It therefore mounts without splats first, and suspends before
  // that is painted.
  const [, suspend] = useState(false);
  useLayoutEffect(() => suspend(true), []);
  if (drawError) throw drawError.error;
  if (load?.status === 'failed' && !onError) throw load.error;
  // Thrown for the reason given in useSplats.
  if (load?.status === 'pending' && !splats) throw load.settled;

  // react-three-fiber ignores props that are undefined, and resets props that are missing.
  const set = Object.fromEntries(
    Object.entries({ ...objectProps, ...settings }).filter(([, value]) => value !== undefined),
  );
  return <CloudElement {...set} accuracy={accuracy} ref={object} data={splats} />;
}
