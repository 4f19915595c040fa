import { extend, type ThreeElements, useFrame, useStore } from '@react-three/fiber';
import { callListener, InvalidArgumentError, type SceneFraming } from '@websplatter/core';
import { frameSplats } from '@websplatter/three';
import {
  createContext,
  type ReactNode,
  type Ref,
  useContext,
  useEffect,
  useImperativeHandle,
  useMemo,
  useRef,
} from 'react';
import { type Box3, Group, Vector3 } from 'three';
import { BoundsFitter, cloudsIn } from './bounds-fitter.ts';
import { canvasStates } from './canvas-states.ts';
import type { FittedCamera } from './fit-camera.ts';
import { isServer } from './is-server.ts';
import { useLatest } from './stable-values.ts';
import { rendererOf, useCanvasRenderer, useMeasuredRenderer } from './use-renderer.ts';

/** A box for physics engines: `<CuboidCollider args={halfSize} position={center} />`. */
export interface SplatBoundsBox {
  readonly center: readonly [number, number, number];
  readonly halfSize: readonly [number, number, number];
}

/** Bounds and framing of the clouds in a `<SplatBounds>`. */
export interface SplatBoundsApi {
  /**
   * Returns the clouds' bounds in world space without their outermost splats; empty before the
   * first load.
   */
  box(): Box3;
  /** Returns the bounds as centre and half sizes; null before the first load. */
  cuboid(): SplatBoundsBox | null;
  /** Returns the framing of the present clouds; null before it is found: see `frame`. */
  framing(): SceneFraming | null;
  /**
   * Places the Canvas's camera as a photographer would: upright, where most of the splats' detail is
   * sharp, in the picture and unhidden. Sets `camera.up`, near and far, and the target of the controls
   * (`makeDefault`). Takes about 0.2 s; then requests a frame.
   *
   * @returns the framing; null if no splat is visible.
   * @throws DestroyedError if the splats or the device end first; GpuLimitError if memory is lacking;
   *   an AbortError if clouds are loaded or another call begins first, or the component unmounts.
   */
  frame(): Promise<SceneFraming | null>;
  /**
   * Moves the Canvas's camera along its present direction so that the bounds fill the image. Sets near
   * and far, and the target of the controls (`makeDefault`). Once `framing` is found, fits the scene's
   * detail without surroundings and sky. Requests a frame.
   *
   * @param margin extent of the image divided by the extent of the bounds; 1: no margin. Default: the
   *   component's `margin`.
   * @returns whether a cloud has been loaded.
   * @throws InvalidArgumentError for a margin of 0 or less.
   */
  fit(margin?: number): boolean;
}

/** Props of `<SplatBounds>`. */
export interface SplatBoundsProps extends Omit<ThreeElements['group'], 'ref'> {
  children?: ReactNode;
  /**
   * When to fit the camera: `once`, the default: after the first load; `each`: after every load. The
   * first preview of a file is fitted, too; whoever moves the camera after that keeps it. A
   * camera in react-three-fiber's default pose is placed as by `frame`, for its `fov`, the canvas's
   * shape, and a `camera.up` other than y. A camera that the application
   * has placed or turned keeps its direction, as by `fit`. A camera that is moved before the framing
   * is found stays.
   */
  fit?: 'once' | 'each' | 'never';
  /** Extent of the fitted image divided by the extent of the bounds; 1: no margin. Default 1.2. */
  margin?: number;
  /**
   * Called when the bounds have changed because splats were loaded or replaced, and again when the
   * camera has been placed by `framing`.
   */
  onChange?: (api: SplatBoundsApi) => void;
  ref?: Ref<SplatBoundsApi>;
}

const DEFAULT_MARGIN = 1.2;

const BoundsElement = /* @__PURE__ */ extend(Group);
const BoundsContext = createContext<SplatBoundsApi | null>(null);

/**
 * Computes the bounds of the clouds in it, and places the camera to show them. Bounds are robust: the
 * outermost 2 % of the centres, on each side along each axis of a cloud, do not count.
 *
 * @throws InvalidArgumentError outside of a Canvas, and for a margin of 0 or less.
 * @example
 * <SplatCanvas flat>
 *   <SplatBounds margin={1.1} onChange={(bounds) => console.log(bounds.cuboid())}>
 *     <Splats src="/garden.ply" rotation-x={Math.PI} />
 *   </SplatBounds>
 * </SplatCanvas>
 */
export function SplatBounds(props: SplatBoundsProps): ReactNode {
  checkMargin(props.margin ?? DEFAULT_MARGIN);
  const isOutside = !useCanvasRenderer();
  const isOnServer = isOutside && isServer();
  useMeasuredRenderer(isOnServer ? [null] : [], '<SplatBounds>');
  return isOnServer ? null : <Bounds {...props} />;
}

/**
 * Returns the bounds of the nearest `<SplatBounds>` around.
 *
 * @throws InvalidArgumentError outside of one.
 * @example
 * function Garden() {
 *   const bounds = useSplatBounds();
 *   return <Splats src="/garden.ply" onDoubleClick={() => bounds.fit()} />;
 * }
 */
export function useSplatBounds(): SplatBoundsApi {
  const api = useContext(BoundsContext);
  if (api) return api;
  throw new InvalidArgumentError('useSplatBounds', 'useSplatBounds needs a <SplatBounds> around it.');
}

function Bounds({
  children,
  fit = 'once',
  margin = DEFAULT_MARGIN,
  onChange,
  ref,
  ...groupProps
}: SplatBoundsProps) {
  const store = useStore();
  const group = useRef<Group>(null);
  const latest = useLatest({ margin, onChange });
  const fitter = useMemo(
    () =>
      new BoundsFitter({
        group: () => group.current,
        camera: () => store.getState().camera as FittedCamera,
        controls: () => store.getState().controls,
        frame: (clouds, camera, options) =>
          frameSplats(rendererOf(store.getState()), clouds, camera, options),
        invalidate: () => store.getState().invalidate(),
      }),
    [store],
  );
  useEffect(() => () => fitter.end(), [fitter]);
  const api = useMemo(
    (): SplatBoundsApi => ({
      box: () => fitter.box(),
      cuboid: () => {
        const bounds = fitter.box();
        if (bounds.isEmpty()) return null;
        const center = bounds.getCenter(new Vector3()).toArray();
        return { center, halfSize: bounds.getSize(new Vector3()).multiplyScalar(0.5).toArray() };
      },
      framing: () => fitter.framing,
      fit: (wanted = latest.current.margin) => {
        checkMargin(wanted);
        return fitter.fit(wanted);
      },
      frame: () => fitter.frame(),
    }),
    [fitter, latest],
  );
  useImperativeHandle(ref, () => api, [api]);

  /** Data of each cloud at the last change. */
  const before = useRef<ReadonlyMap<object, object | null>>(new Map());
  const hasFitted = useRef(false);
  const hasPreview = useRef(false);
  // Clouds are mounted, loaded and replaced at any time: compare before each frame.
  useFrame(() => {
    const loaded = cloudsIn(group.current).filter(({ data }) => data);
    const clouds = loaded.filter(({ data }) => !data?.isPreview);
    const known = before.current;
    const canvas = canvasStates.get(rendererOf(store.getState()));
    // The camera has come through a recovery as the visitor left it.
    if (canvas?.isViewKept) {
      hasFitted.current = hasPreview.current = true;
      if (canvas.view.left) fitter.bringBack(canvas.view.left);
    }
    if (canvas && (hasFitted.current ? !fitter.isFraming : fitter.hasMoved)) canvas.view.isFitted = true;
    // The first splats of a file are placed like whole files, which are placed again.
    if (clouds.length === 0 && loaded.length > 0 && fit !== 'never' && !hasPreview.current) {
      hasPreview.current = true;
      fitter.fitLoaded(margin);
    }
    if (clouds.length === known.size && clouds.every((cloud) => known.get(cloud) === cloud.data)) return;
    before.current = new Map(clouds.map((cloud) => [cloud, cloud.data]));
    // Another cloud may be loaded before the camera has its first place.
    const isFirst = !hasFitted.current || fitter.isFraming;
    fitter.forget();
    if (clouds.length === 0) return;
    // Whoever moves the camera while a file arrives keeps it.
    if (hasPreview.current && !hasFitted.current && fitter.hasMoved) hasFitted.current = true;
    else if ((fit === 'each' && !canvas?.isViewKept) || (fit === 'once' && isFirst)) {
      const { isFitted, framed } = fitter.fitLoaded(margin);
      hasFitted.current = isFitted;
      framed.then((isFramed) => isFramed && callListener(latest.current.onChange, api));
    }
    // Others that are mounted later fit. Each load would be one of those that come back.
    if (canvas && fit !== 'each') canvas.isViewKept = false;
    callListener(onChange, api);
  });

  return (
    <BoundsContext value={api}>
      <BoundsElement ref={group} {...groupProps}>
        {children}
      </BoundsElement>
    </BoundsContext>
  );
}

function checkMargin(margin: number): void {
  if (margin > 0 && margin < Number.POSITIVE_INFINITY) return;
  throw new InvalidArgumentError('margin', `margin is ${margin}; it must be above 0: 1 is none.`);
}
