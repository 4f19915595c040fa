import { IconButton } from '@websplatter/kit/controls';
import { formatCount, formatSplats } from '@websplatter/kit/format';
import { Icon } from '@websplatter/kit/icon';
import { keepText, keptText } from '@websplatter/kit/storage';
import { useEffect, useId, useState } from 'react';
import { useStore } from 'zustand';
import { galleryAddress } from '../engine/link/lab-address.ts';
import { droppedReasons, droppedTotal } from '../engine/open/dropped-words.ts';
import type { PanelProps } from '../engine/viewer.ts';
import { leftSplats } from '../state/left-splats.ts';
import type { SceneAbout, SceneSummary } from '../state/scene.ts';
import type { ViewerStore } from '../state/store.ts';
import { TimeBar } from './time-bar.tsx';

export function SceneCaption({
  store,
  viewer,
  onStep,
  onSamples,
}: PanelProps & {
  onStep: (by: 1 | -1) => void;
  /** Shows scenes to try. */
  onSamples: () => void;
}) {
  const scene = useStore(store, (state) => state.scene);
  if (!scene) return null;
  const { title, about, notes, cameras } = scene;
  return (
    <section ref={tellHeight} className="panel caption" aria-label="Scene" data-testid="scene">
      {about && <About about={about} name={title} />}
      <h1 data-testid="scene-title">{title}</h1>
      {about && (
        <p>
          Goes wrong elsewhere: <span data-testid="scene-about">{about.text}</span>
        </p>
      )}
      <Figures store={store} scene={scene} />
      {notes.map((note) => (
        <p key={note} className="caption-figures">
          {note}
        </p>
      ))}
      <TimeBar store={store} viewer={viewer} />
      {cameras.length > 0 && <CameraStepper store={store} cameras={cameras} onStep={onStep} />}
      <Hint onSamples={onSamples} />
    </section>
  );
}

/** Has style sheets know the caption's height, which phones keep free of the picture's subject. */
function tellHeight(caption: HTMLElement): () => void {
  const observer = new ResizeObserver(() =>
    document.documentElement.style.setProperty('--caption-height', `${caption.offsetHeight}px`),
  );
  observer.observe(caption);
  return () => observer.disconnect();
}

/** Storage key; set once the hint has been used. */
const HINT_KEY = 'websplatter-hint';

/** Tells first-time visitors what the viewer is for and its gestures, until one of them is used. */
function Hint({ onSamples }: { onSamples: () => void }) {
  const [isShown, setShown] = useState(() => keptText(HINT_KEY) === null);
  useEffect(() => {
    if (!isShown) return;
    const end = ({ type, target }: Event) => {
      // Pressing a button must not remove the hint: the layout would move the button away from the
      // pointer. A gesture ends first: phones move the picture into the caption's place.
      if (type === 'pointerup' && !(target as Element).matches('.viewport')) return;
      keepText(HINT_KEY, 'seen');
      setShown(false);
    };
    const events = ['pointerup', 'wheel', 'keydown', 'drop'];
    for (const type of events) addEventListener(type, end);
    return () => {
      for (const type of events) removeEventListener(type, end);
    };
  }, [isShown]);
  if (!isShown) return null;
  const isTouch = matchMedia('(pointer: coarse)').matches;
  return (
    <div className="caption-hint" data-testid="hint">
      <p>
        <b>Exact pictures of Gaussian splats, and what they cost.</b> Drop a scene, or{' '}
        <button type="button" className="disclosure" data-testid="try-samples" onClick={onSamples}>
          try a sample
        </button>
        .
      </p>
      <p>{isTouch ? 'Drag to orbit, pinch to zoom' : 'Drag to orbit, scroll to zoom'}</p>
    </div>
  );
}

/** @param name the hard case's name. */
function About({ about, name }: { about: SceneAbout; name: string }) {
  const [page, gallery] = [galleryAddress(name), galleryAddress()];
  return (
    <p className="caption-topic">
      <span data-testid="scene-topic">{about.topic}</span>
      {page && <a href={page}>Expected and actual</a>}
      {gallery && <a href={gallery}>All hard cases</a>}
    </p>
  );
}

/** The number of splats, and on demand the reasons why rows were dropped. */
function Figures({ store, scene }: { store: ViewerStore; scene: SceneSummary }) {
  const isDroppedVisible = useStore(store, (state) => state.isDroppedVisible);
  const left = useStore(store, leftSplats);
  const isCropped = useStore(store, (state) => state.inspecting.crop !== null);
  const listId = useId();
  const { parts, clouds, splats, dropped } = scene;
  const leftOut = droppedTotal(dropped);
  return (
    <>
      <p className="caption-figures">
        {parts.length > 1 && `${formatCount(parts.length)} files · `}
        {left !== null && left < splats && `${formatCount(left)} of `}
        {clouds > 0 ? `${formatSplats(splats)} · ${formatHarmonics(scene)}` : 'No splats'}
        {isCropped && ' · cropped'}
        {leftOut > 0 && (
          <>
            {' · '}
            <button
              type="button"
              className="disclosure"
              aria-expanded={isDroppedVisible}
              aria-controls={listId}
              data-testid="dropped"
              onClick={() => store.setState({ isDroppedVisible: !isDroppedVisible })}
            >
              {formatCount(leftOut)} left out
              <Icon name="more" />
            </button>
          </>
        )}
      </p>
      {leftOut > 0 && (
        <dl id={listId} className="reasons" hidden={!isDroppedVisible} data-testid="dropped-reasons">
          {droppedReasons(dropped).map(({ reason, words, count }) => (
            <div key={reason}>
              <dt>{words}</dt>
              <dd>{formatCount(count)}</dd>
            </div>
          ))}
        </dl>
      )}
    </>
  );
}

/** `view-dependent colour (SH 3)`, with `, seen up to SH 1` if higher bands have no visible effect. */
function formatHarmonics({ declaredShDegree, shDegree }: SceneSummary): string {
  if (declaredShDegree === 0) return 'no view-dependent colour';
  const seen = shDegree < declaredShDegree ? `, seen up to SH ${shDegree}` : '';
  return `view-dependent colour (SH ${declaredShDegree}${seen})`;
}

/** Steps through the scene's own cameras. A single camera can be returned to. */
function CameraStepper({
  store,
  cameras,
  onStep,
}: {
  store: ViewerStore;
  cameras: readonly string[];
  onStep: (by: 1 | -1) => void;
}) {
  const cameraIndex = useStore(store, (state) => state.cameraIndex);
  const isOwnCamera = useStore(store, (state) => state.isOwnCamera);
  const isSingle = cameras.length === 1;
  const stepButton = (icon: 'previous' | 'next', label: string, key: string, by: 1 | -1) =>
    !isSingle && (
      <IconButton
        icon={icon}
        label={label}
        aria-keyshortcuts={key}
        title={`${label} (${key})`}
        testId={`${icon}-camera`}
        onClick={() => onStep(by)}
      />
    );
  return (
    <fieldset className="stepper" aria-label="Camera">
      {stepButton('previous', 'Previous camera', '[', -1)}
      <p role="status" data-testid="camera">
        <b>{cameras[cameraIndex]}</b>
        {!isSingle && ` ${cameraIndex + 1} of ${cameras.length}`}
        {!isOwnCamera && ' · moved'}
      </p>
      {stepButton('next', 'Next camera', ']', 1)}
    </fieldset>
  );
}
