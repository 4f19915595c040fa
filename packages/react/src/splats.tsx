import { extend, type ThreeElement, useThree } from '@react-three/fiber';
import type { AccuracyChoice, AccuracyRequest, SplatEngine } from '@websplatter/core';
import {
  onDeviceLost as listenForDeviceLoss,
  type SplatData,
  SplatsPrecisionError,
  SplatsUnsupportedRendererError,
  splatEngineOf,
} from '@websplatter/three';
import {
  type ReactNode,
  type Ref,
  useEffect,
  useImperativeHandle,
  useLayoutEffect,
  useReducer,
  useRef,
  useState,
} from 'react';
import { type EffectProps, isSameUses, isSameValue, revealAnimationOf, usesOfProps } from './effect-props.ts';
import { isServer } from './is-server.ts';
import type { CacheableSource } from './splat-cache.ts';
import { SplatsObject } from './splats-object.ts';
import { useLatest } from './use-latest.ts';
import { useCanvasRenderer } from './use-renderer.ts';
import { useSame } from './use-same.ts';
import { useSource } from './use-source.ts';

/** What `<Splats>` can show. */
export type SplatsSource = CacheableSource | SplatData;

export interface SplatsProps
  extends EffectProps,
    Omit<
      ThreeElement<typeof SplatsObject>,
      'accuracy' | 'args' | 'attach' | 'data' | 'dispose' | 'effects' | 'onError' | 'ref' | 'reveal'
    > {
  /** A new one replaces what is shown as soon as it has been read. */
  src: SplatsSource;
  /**
   * How exactly splats are drawn, and how fast: settings, or a wish such as `{ minPsnrDb: 45 }`; by default the Canvas's. All
   * clouds in view are one picture: see `SplatCloudObject.accuracy` of @websplatter/three for what it is drawn with. A
   * change loads nothing and suspends nothing.
   */
  accuracy?: AccuracyRequest | null;
  /** The object in the scene. */
  ref?: Ref<SplatsObject>;
  /** Splats have been read and are about to be drawn. */
  onLoad?: (splats: SplatData) => void;
  /** `loaded` and `total` are bytes; `lengthComputable` is false where the total is not known. */
  onProgress?: (event: ProgressEvent) => void;
  /** The first picture with these splats has been drawn. */
  onFirstFrame?: () => void;
  /** Settings have been chosen because of a wish: which, and why. */
  onAccuracyChosen?: (choice: AccuracyChoice) => void;
  /**
   * Takes errors of reading and of drawing, which else reach the nearest error boundary; what was shown stays. A
   * SplatsPrecisionError, after which splats are drawn less exactly than asked for, goes to the console else.
   */
  onError?: (error: unknown) => void;
  /** The GPU device is gone, and with it all that this Canvas draws. Called once. */
  onDeviceLost?: (info: GPUDeviceLostInfo) => void;
  /** Shown where the Canvas has a renderer that cannot draw splats; without it that is an error. */
  fallback?: ReactNode;
}

/** The Canvas of a lost device comes back within this, and finds what had been read. */
const RECOVERY_GRACE_MS = 15_000;

/**
 * Gaussian splats in a react-three-fiber scene. Suspends until the first `src` has been read; a `src` that changes
 * replaces what is shown when it has been read. All other props are set on the object as they change.
 *
 * @throws SplatsUnsupportedRendererError where the Canvas was not made with `gl={createSplatRenderer}` and there is no
 *   `fallback`; InvalidArgumentError for effects with options that mean nothing; SplatFileError, SplatSourceError,
 *   GpuLimitError where there is no `onError`.
 */
export function Splats({ fallback, ...props }: SplatsProps): ReactNode {
  const renderer = useCanvasRenderer();
  if (!renderer) {
    if (isServer()) return null;
    throw new SplatsUnsupportedRendererError(
      '<Splats> is outside of a Canvas: put it inside of <Canvas gl={createSplatRenderer}> or <SplatCanvas>.',
    );
  }
  let engine: SplatEngine;
  try {
    engine = splatEngineOf(renderer);
  } catch (error) {
    if (fallback === undefined) throw error;
    return fallback;
  }
  return <Cloud renderer={renderer} engine={engine} {...props} />;
}

// Given to `extend` here and not by name, so that nobody's `<splatCloudObject>` is overruled.
const CloudElement = /* @__PURE__ */ extend(SplatsObject);

function Cloud({
  renderer,
  engine,
  src,
  accuracy = null,
  ref,
  onLoad,
  onProgress,
  onFirstFrame,
  onAccuracyChosen,
  onError,
  onDeviceLost,
  tint,
  brightness,
  antialias,
  clip,
  reveal,
  highlight,
  effects,
  ...objectProps
}: Omit<SplatsProps, 'fallback'> & { renderer: object; engine: SplatEngine }): ReactNode {
  const object = useRef<SplatsObject>(null);
  useImperativeHandle(ref, () => object.current!, []);
  const invalidate = useThree((state) => state.invalidate);
  const latest = useLatest({ onLoad, onFirstFrame, onAccuracyChosen, onError, onDeviceLost });
  const isLost = useRef(false);
  const graceMs = () => (isLost.current ? RECOVERY_GRACE_MS : undefined);

  const effectProps = { tint, brightness, antialias, clip, reveal, highlight, effects };
  const uses = useSame(usesOfProps(effectProps), isSameUses);
  const animation = useSame(revealAnimationOf(effectProps), isSameValue);

  const { splats, load } = useSource(src, accuracy ?? engine.accuracy, { onProgress, graceMs });
  useEffect(() => {
    if (load?.status === 'failed') latest.current.onError?.(load.error);
  }, [load, latest]);

  const reported = useRef<SplatData>(null);
  useEffect(() => {
    if (splats === null || splats === reported.current) return;
    reported.current = splats;
    latest.current.onLoad?.(splats);
  }, [splats, latest]);

  const [drawError, setDrawError] = useState<{ readonly error: unknown } | null>(null);
  useLayoutEffect(() => {
    const cloud = object.current!;
    const tellFirstFrame = () => latest.current.onFirstFrame?.();
    cloud.addEventListener('firstframe', tellFirstFrame);
    const tellChoice = ({ choice }: { choice: AccuracyChoice }) => latest.current.onAccuracyChosen?.(choice);
    cloud.addEventListener('accuracychosen', tellChoice);
    const requestFrame = () => invalidate();
    cloud.addEventListener('needsframe', requestFrame);
    cloud.onError = (error) => {
      if (latest.current.onError) latest.current.onError(error);
      // What is drawn goes on.
      else if (error instanceof SplatsPrecisionError) console.warn(error);
      else setDrawError({ error });
    };
    return () => {
      cloud.removeEventListener('firstframe', tellFirstFrame);
      cloud.removeEventListener('accuracychosen', tellChoice);
      cloud.removeEventListener('needsframe', requestFrame);
      cloud.onError = null;
    };
  }, [latest, invalidate]);

  useEffect(
    () =>
      listenForDeviceLoss(renderer, (info) => {
        isLost.current = true;
        latest.current.onDeviceLost?.(info);
      }),
    [renderer, latest],
  );

  // React tells a component nothing of its end that it suspended before it was ever mounted, and its load could not be
  // aborted. So it mounts without splats first, and suspends before that is painted.
  const [, suspendNow] = useReducer(() => true, false);
  useLayoutEffect(suspendNow, []);
  if (drawError) throw drawError.error;
  if (load?.status === 'failed' && !onError) throw load.error;
  // Thrown for the reason given in useSplats.
  if (load?.status === 'pending' && splats === null) throw load.settled;

  // react-three-fiber passes over props that are undefined, and sets back those that are not there any more.
  for (const [name, value] of Object.entries(objectProps))
    if (value === undefined) delete objectProps[name as keyof typeof objectProps];
  return (
    <CloudElement
      {...objectProps}
      accuracy={accuracy}
      effects={uses}
      reveal={animation}
      ref={object}
      data={splats}
    />
  );
}
