import { extend, type ThreeElements, useFrame, useStore, useThree } from '@react-three/fiber';
import { callListener, InvalidArgumentError } from '@websplatter/core';
import {
  createContext,
  type ReactNode,
  type Ref,
  useContext,
  useImperativeHandle,
  useMemo,
  useRef,
} from 'react';
import { Box3, Group, Vector3 } from 'three';
import { aimControls } from './aim-controls.ts';
import { type FittedCamera, fitCamera } from './fit-camera.ts';
import { isServer } from './is-server.ts';
import { SplatCloudObject } from './splat-cloud-object.ts';
import { useLatest } from './use-latest.ts';
import { useMeasuredRenderer } from './use-renderer.ts';

/** A box as physics engines take it: `<CuboidCollider args={halfSize} position={center} />`. */
export interface SplatBoundsBox {
  readonly center: readonly [number, number, number];
  readonly halfSize: readonly [number, number, number];
}

/** What `<SplatBounds>` knows of the clouds in it. */
export interface SplatBoundsApi {
  /**
   * Returns the clouds' bounds in world space without their outermost splats; empty before the
   * first load.
   */
  box(): Box3;
  /** Returns the same bounds as a middle and half sides; null before the first load. */
  cuboid(): SplatBoundsBox | null;
  /**
   * Moves the Canvas's camera, in its present direction, such that the bounds fill the image, sets
   * near and far for them, and has the controls (`makeDefault`) turn about their middle. Requests a
   * frame.
   *
   * @param margin by how much more the image shows: 1 is none; default that of the component.
   * @returns whether a cloud has been loaded.
   * @throws InvalidArgumentError for a margin of 0 or less.
   */
  fit(margin?: number): boolean;
}

/** Props of `<SplatBounds>`. */
export interface SplatBoundsProps extends Omit<ThreeElements['group'], 'ref'> {
  children?: ReactNode;
  /**
   * Whether the camera is fitted when the clouds have been loaded: `once`, or again for `each` that
   * is loaded later.
   */
  fit?: 'once' | 'each' | 'never';
  /** By how much more than the bounds the image shows when it is fitted: 1 is none; default 1.2. */
  margin?: number;
  /** Called when the bounds have changed because splats were loaded or replaced. */
  onChange?: (api: SplatBoundsApi) => void;
  ref?: Ref<SplatBoundsApi>;
}

const DEFAULT_MARGIN = 1.2;

const BoundsElement = /* @__PURE__ */ extend(Group);
const BoundsContext = createContext<SplatBoundsApi | null>(null);

/**
 * Knows the bounds of the clouds in it, and fits the camera to them. Bounds are robust: the
 * outermost 2 % of the centres, on each side along each axis of a cloud, do not count.
 *
 * @throws InvalidArgumentError outside of a Canvas, and for a margin of 0 or less.
 */
export function SplatBounds(props: SplatBoundsProps): ReactNode {
  checkMargin(props.margin ?? DEFAULT_MARGIN);
  const isOnServer = isServer();
  useMeasuredRenderer(isOnServer ? null : undefined, '<SplatBounds>');
  return isOnServer ? null : <Bounds {...props} />;
}

/**
 * Returns the bounds of the nearest `<SplatBounds>` around.
 *
 * @throws InvalidArgumentError outside of one.
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
  const invalidate = useThree((state) => state.invalidate);
  const group = useRef<Group>(null);
  const latest = useLatest(margin);
  const api = useMemo((): SplatBoundsApi => {
    const box = () => {
      const bounds = new Box3();
      for (const cloud of cloudsIn(group.current)) {
        cloud.updateWorldMatrix(true, false);
        if (cloud.data) bounds.union(cloud.data.robustBounds.clone().applyMatrix4(cloud.matrixWorld));
      }
      return bounds;
    };
    return {
      box,
      cuboid: () => {
        const bounds = box();
        if (bounds.isEmpty()) return null;
        const center = bounds.getCenter(new Vector3()).toArray();
        return { center, halfSize: bounds.getSize(new Vector3()).multiplyScalar(0.5).toArray() };
      },
      fit: (wanted = latest.current) => {
        checkMargin(wanted);
        const bounds = box();
        if (bounds.isEmpty()) return false;
        const { camera, controls } = store.getState();
        fitCamera(camera as FittedCamera, bounds, wanted);
        aimControls(controls, camera as FittedCamera, bounds.getCenter(new Vector3()));
        invalidate();
        return true;
      },
    };
  }, [store, invalidate, latest]);
  useImperativeHandle(ref, () => api, [api]);

  /** The splats of each cloud, as of the last change. */
  const before = useRef<ReadonlyMap<object, object | null>>(new Map());
  const hasFitted = useRef(false);
  // Clouds are mounted, loaded and replaced at any time: this looks before the frame that follows.
  useFrame(() => {
    const clouds = cloudsIn(group.current).filter(({ data }) => data && !data.isPreview);
    const known = before.current;
    if (clouds.length === known.size && clouds.every((cloud) => known.get(cloud) === cloud.data)) return;
    before.current = new Map(clouds.map((cloud) => [cloud, cloud.data]));
    if (clouds.length === 0) return;
    if (fit === 'each' || (fit === 'once' && !hasFitted.current)) hasFitted.current = api.fit();
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

function cloudsIn(group: Group | null): SplatCloudObject[] {
  const clouds: SplatCloudObject[] = [];
  group?.traverse((object) => {
    if (object instanceof SplatCloudObject) clouds.push(object);
  });
  return clouds;
}
