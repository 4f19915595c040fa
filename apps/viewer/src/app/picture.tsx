import { Suspense, useEffect, useRef, useState } from 'react';
import { useStore } from 'zustand';
import { coveredBeside } from '../camera/covered.ts';
import type { PanelProps, Viewer } from '../engine/viewer.ts';
import { hasAnnotating } from '../state/annotating.ts';
import { isGpuLost } from '../state/session.ts';
import type { ViewerStore } from '../state/store.ts';
import { isMapMode } from '../state/view-mode.ts';
import { lazyComponent } from '../ui/lazy.tsx';

/** Fetched once for all small parts. */
export const smallParts = () => import('./small-parts.ts');
const AnnotationMarkers = lazyComponent(async () => (await smallParts()).AnnotationMarkers);
const SplitImage = lazyComponent(async () => (await smallParts()).SplitImage);
const ModeMap = lazyComponent(async () => (await smallParts()).ModeMap);
const ErrorMapImage = lazyComponent(async () => (await smallParts()).ErrorMapImage);
const FramedWheel = lazyComponent(async () => (await smallParts()).FramedWheel);
const LookedPicture = lazyComponent(async () => (await smallParts()).LookedPicture);

/**
 * The picture, and the image that is compared with it.
 *
 * @param poster URL of an image to show before the first picture; null for none.
 */
export function Picture({ store, viewer, poster }: PanelProps & { poster: string | null }) {
  const comparison = useStore(store, (state) => state.comparison);
  const isLooked = useStore(store, (state) => state.looked !== null && state.judged !== null);
  const isAnnotated = useStore(store, hasAnnotating);
  const hasPicture = useStore(store, ({ imageId }) => imageId > 0);
  const hasMap = useStore(store, (state) => isMapMode(state.viewMode));
  return (
    <>
      <Viewport store={store} viewer={viewer} />
      <FreeArea viewer={viewer} />
      {poster && <Poster store={store} address={poster} />}
      {/* Below the right side of a split image: the map is that of the left one. */}
      <Suspense>{hasMap && <ModeMap store={store} viewer={viewer} />}</Suspense>
      <Suspense>
        {comparison?.kind === 'split' && <SplitImage store={store} viewer={viewer} split={comparison} />}
        {comparison?.kind === 'error' && <ErrorMapImage store={store} viewer={viewer} />}
        {isLooked && <LookedPicture store={store} />}
      </Suspense>
      <Suspense>{hasPicture && window !== top && <FramedWheel store={store} />}</Suspense>
      <Suspense>{isAnnotated && <AnnotationMarkers store={store} viewer={viewer} />}</Suspense>
    </>
  );
}

/** An image in place of the scene, until the whole scene is on the screen. */
function Poster({ store, address }: { store: ViewerStore; address: string }) {
  const isSceneShown = useStore(store, ({ imageId }) => imageId > 0);
  const [isMissing, setIsMissing] = useState(false);
  if (isSceneShown || isMissing) return null;
  // The canvas has the text alternative for both.
  return (
    <img
      className="over-picture poster"
      src={address}
      alt=""
      data-testid="poster"
      onError={() => setIsMissing(true)}
    />
  );
}

/** The part of the picture beside panels, sized by style sheets; the camera uses its size. */
function FreeArea({ viewer }: { viewer: Viewer }) {
  const area = useRef<HTMLDivElement>(null);
  useEffect(() => {
    const element = area.current;
    let size = { width: 0, height: 0 };
    const observer = new ResizeObserver(() => {
      if (!element) return;
      const { clientWidth: width, clientHeight: height } = document.documentElement;
      const isResized = width !== size.width || height !== size.height;
      size = { width, height };
      viewer.camera.setCovered(coveredBeside(element.getBoundingClientRect(), size), isResized);
    });
    if (element) observer.observe(element);
    return () => observer.disconnect();
  }, [viewer]);
  return <div ref={area} className="free-area" />;
}

/** The canvas. The viewer draws to it while it is mounted. */
function Viewport({ store, viewer }: { store: ViewerStore; viewer: Viewer }) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const title = useStore(store, (state) => state.scene?.title);
  const isLost = useStore(store, isGpuLost);
  useEffect(() => (canvas.current ? viewer.attach(canvas.current) : undefined), [viewer]);
  // The page about the lost GPU covered the canvas and had the focus.
  useEffect(() => (isLost ? () => canvas.current?.focus() : undefined), [isLost]);
  return (
    // biome-ignore lint/a11y/noInteractiveElementToNoninteractiveRole: it gives the page the keys.
    <canvas
      ref={canvas}
      className="viewport"
      data-testid="viewport"
      tabIndex={0}
      role="application"
      aria-label={`3D view${title ? ` of ${title}` : ''}. Arrow keys turn it, plus and minus zoom, question mark lists all keys.`}
    />
  );
}
