import { extend, type ThreeElements, useFrame, useStore, useThree } from '@react-three/fiber';
import { callListener, InvalidArgumentError } from '@websplatter/core';
import { type CSSProperties, type ReactNode, useEffect, useLayoutEffect, useRef } from 'react';
import { createRoot, type Root } from 'react-dom/client';
import { type Camera, Group, type OrthographicCamera } from 'three';
import { isServer } from './is-server.ts';
import { LabelBoard } from './label-board.ts';
import { LabelElement } from './label-element.ts';
import { useLatest } from './stable-values.ts';
import { rendererOf, useMeasuredRenderer } from './use-renderer.ts';

/** Props of `<SplatAnnotation>`. */
export interface SplatAnnotationProps {
  /** Point in the parent's space; the content is centred on it. */
  position?: ThreeElements['group']['position'];
  /** HTML of the label. React contexts of the app are not available in it. */
  children?: ReactNode;
  /** Whether the label hides behind splats or opaque meshes in front of its point; default true. */
  occlude?: boolean;
  /** Joint opacity, 0…1 without 0, from which splats in front hide the label; default 0.5. */
  hideAt?: number;
  /**
   * Objects in front of the point by less than this do not hide the label, world units along the
   * line of sight; default: a fiftieth of its distance. Splats of the surface that a label stands
   * on lie on both sides of its point.
   */
  tolerance?: number;
  /** Called with true when splats or meshes hide the label, with false when it is visible again. */
  onOcclude?: (isHidden: boolean) => void;
  /**
   * Distance from the camera, world units, at which the content has its own size; its scale follows
   * perspective. Default: the same size at any distance. With an orthographic camera, the scale is
   * the camera's zoom.
   */
  fullSizeDistance?: number;
  /** Class of the element around the content. */
  className?: string;
  /** Style of the element around the content. */
  style?: CSSProperties;
}

// Passed to `extend` as a class, not by name, so that it overrides no element of the application.
const PointElement = /* @__PURE__ */ extend(Group);

/** Boards by the store of a Canvas, or of a portal in it. */
const boards = new WeakMap<object, LabelBoard>();

const DEFAULT_HIDE_AT = 0.5;

/**
 * A label at a point of the scene: HTML over the canvas that fades when splats or opaque meshes
 * cover its point. The GPU tests the joint opacity of all splats in front of the point, and the depth
 * of meshes. All labels of a Canvas share one query, at most ten times a second after a frame; no
 * frame waits for it. Labels that are hidden or outside of the image cannot be focused; a label with
 * the focus stays.
 *
 * @throws InvalidArgumentError outside of a Canvas, and for numbers out of range.
 * @example
 * <SplatCanvas flat>
 *   <Splats src="/garden.ply" rotation-x={Math.PI} />
 *   <SplatAnnotation position={[0, 1.2, 0]}>
 *     <button type="button">The vase</button>
 *   </SplatAnnotation>
 * </SplatCanvas>
 */
export function SplatAnnotation(props: SplatAnnotationProps): ReactNode {
  const { hideAt = DEFAULT_HIDE_AT, tolerance, fullSizeDistance } = props;
  if (!(hideAt > 0 && hideAt <= 1)) {
    throw new InvalidArgumentError('hideAt', `hideAt is ${hideAt}; it must be an opacity above 0, up to 1.`);
  }
  checkLength('tolerance', tolerance, tolerance === 0);
  checkLength('fullSizeDistance', fullSizeDistance, false);
  const isOnServer = isServer();
  useMeasuredRenderer(isOnServer ? [null] : [], '<SplatAnnotation>');
  return isOnServer ? null : <Label {...props} hideAt={hideAt} />;
}

function checkLength(name: string, value: number | undefined, isFine: boolean): void {
  if (value === undefined || isFine || (value > 0 && value < Number.POSITIVE_INFINITY)) return;
  throw new InvalidArgumentError(name, `${name} is ${value}; it must be a length above 0, in world units.`);
}

function Label({
  position,
  children,
  occlude = true,
  hideAt,
  tolerance,
  onOcclude,
  fullSizeDistance,
  className = '',
  style,
}: SplatAnnotationProps & { hideAt: number }): ReactNode {
  const store = useStore();
  const invalidate = useThree((state) => state.invalidate);
  const group = useRef<Group>(null);
  const latest = useLatest({ occlude, hideAt, tolerance, onOcclude, fullSizeDistance });
  const root = useRef<Root>(null);

  useLayoutEffect(() => {
    const { gl } = store.getState();
    const element = new LabelElement(gl.domElement);
    const made = createRoot(element.content);
    root.current = made;
    const cover = (isCovered: boolean) => {
      if (element.cover(isCovered)) callListener(latest.current.onOcclude, isCovered);
    };
    const leave = boardOf(store).add({
      object: group.current!,
      get canBeCovered() {
        return latest.current.occlude;
      },
      get hideAt() {
        return latest.current.hideAt;
      },
      get tolerance() {
        return latest.current.tolerance;
      },
      place: (x, y, depthView, rank) => {
        const { camera } = store.getState();
        element.place(x, y, scaleAt(camera, depthView, latest.current.fullSizeDistance), rank);
      },
      leaveSight: () => element.leaveSight(),
      cover,
    });
    return () => {
      leave();
      element.remove();
      // Deferred: React is rendering the surrounding tree.
      queueMicrotask(() => made.unmount());
    };
  }, [store, latest]);

  useLayoutEffect(() => {
    root.current!.render(
      <div className={className} style={style}>
        {children}
      </div>,
    );
  });
  // biome-ignore lint/correctness/useExhaustiveDependencies: a frame shows each change of these.
  useEffect(() => invalidate(), [invalidate, occlude, hideAt, tolerance, fullSizeDistance]);
  useFrame(() => boardOf(store).noteFrame());
  return <PointElement ref={group} position={position} />;
}

function boardOf(store: ReturnType<typeof useStore>): LabelBoard {
  let board = boards.get(store);
  if (!board) {
    board = new LabelBoard(() => {
      const state = store.getState();
      const { scene, camera, size } = state;
      return { renderer: rendererOf(state), scene, camera, size };
    });
    boards.set(store, board);
  }
  return board;
}

function scaleAt(camera: Camera, depthView: number, fullSizeDistance: number | undefined): number {
  if (fullSizeDistance === undefined) return 1;
  const { isOrthographicCamera, zoom } = camera as OrthographicCamera;
  return isOrthographicCamera ? zoom : fullSizeDistance / depthView;
}
