import './plain-controls.css';
import { IconButton } from '@websplatter/kit/controls';
import type { IconName } from '@websplatter/kit/icon';
import { useEffect, useId, useMemo, useState } from 'react';
import { useStore } from 'zustand';
import { openAnnotation, openOnlyAnnotation } from '../annotate/annotations.ts';
import type { PanelProps } from '../engine/viewer.ts';
import { SavedViews } from '../navigate/saved-views.ts';
import { pathOf } from '../navigate/view-path.ts';
import { TimeBar, useSceneTiming } from '../scene/time-bar.tsx';
import { annotationTitle } from '../state/annotating.ts';
import { viewName } from '../state/saved-view.ts';
import { toggleFullscreen, useFullscreen } from '../ui/fullscreen.ts';
import { ZOOM_KEY } from '../ui/zoom-key.ts';

/**
 * What the reader of a page or frame needs: the story, the way back, the whole screen, and whose
 * picture it is. It fades while the reader does nothing, unless a key has focused it.
 */
export function PlainControls({ store, viewer }: PanelProps) {
  const title = useStore(store, (state) => state.scene?.title);
  const isMoving = useSceneTiming({ store, viewer }) !== null;
  const isFullscreen = useFullscreen();
  const isIdle = useIdle();
  // Nothing else would tell a reader of the words that a number in the picture holds. In a low window
  // they would cover the picture.
  useEffect(() => {
    if (matchMedia('(min-height: 481px)').matches) openOnlyAnnotation(store);
  }, [store]);
  return (
    <section
      className="plain-controls"
      aria-label="Scene"
      data-idle={isIdle || undefined}
      data-testid="plain-controls"
    >
      <div className="panel plain-credit">
        <p>
          <b>{title}</b> <span>· WebSplatter</span>
        </p>
        <GestureHint />
      </div>
      {isMoving && (
        <div className="panel plain-time">
          <TimeBar store={store} viewer={viewer} />
        </div>
      )}
      <div className="panel plain-buttons">
        <PlayButton store={store} viewer={viewer} />
        <ViewsButton store={store} viewer={viewer} />
        <AnnotationsButton store={store} viewer={viewer} />
        <IconButton
          icon="reset"
          label="First view"
          title="First view (R)"
          aria-keyshortcuts="R"
          testId="plain-reset"
          onClick={() => {
            viewer.camera.endPath();
            viewer.camera.reset();
          }}
        />
        {document.fullscreenEnabled && (
          <IconButton
            icon="fullscreen"
            label={isFullscreen ? 'Leave full screen' : 'Full screen'}
            title={isFullscreen ? 'Leave full screen (Esc)' : 'Full screen'}
            testId="plain-fullscreen"
            onClick={() => void toggleFullscreen()}
          />
        )}
      </div>
    </section>
  );
}

function PlayButton({ store, viewer }: PanelProps) {
  const hasPath = useStore(store, (state) => pathOf(state) !== null);
  // The path of a settings file plays by itself.
  const isPlaying = useStore(store, (state) => state.isPathPlaying);
  const views = useMemo(
    () => new SavedViews({ store, camera: viewer.camera, draw: async () => null }),
    [store, viewer],
  );
  if (!hasPath && !isPlaying) return null;
  const label = isPlaying ? 'Pause' : 'Play';
  return (
    <IconButton
      icon={isPlaying ? 'pause' : 'play'}
      label={label}
      title={label}
      testId="plain-play"
      onClick={() => views.togglePlaying()}
    />
  );
}

function ViewsButton({ store, viewer }: PanelProps) {
  const views = useStore(store, (state) => state.savedViews);
  return (
    <ListButton
      icon="views"
      label="Views"
      items={views.map(viewName)}
      testId="plain-views"
      onChoose={(i) => viewer.camera.goTo(views[i])}
    />
  );
}

function AnnotationsButton({ store, viewer }: PanelProps) {
  const list = useStore(store, (state) => state.annotating.list);
  return (
    <ListButton
      icon="annotate"
      label="Annotations"
      items={list.map((annotation, i) => `${i + 1}: ${annotationTitle(annotation, i)}`)}
      testId="plain-annotations"
      onChoose={(i) => openAnnotation({ store, viewer }, i)}
    />
  );
}

/** A button that opens a list above it; a choice, Escape and presses elsewhere close the list. */
function ListButton({
  icon,
  label,
  items,
  testId,
  onChoose,
}: {
  icon: IconName;
  label: string;
  /** Without any, there is no button. */
  items: readonly string[];
  testId: string;
  onChoose: (index: number) => void;
}) {
  const id = useId();
  if (items.length === 0) return null;
  return (
    <>
      <IconButton icon={icon} label={label} title={label} popoverTarget={id} testId={testId} />
      <ol
        id={id}
        popover="auto"
        className="panel plain-list"
        aria-label={label}
        data-testid={`${testId}-list`}
      >
        {items.map((item, i) => (
          // biome-ignore lint/suspicious/noArrayIndexKey: names may repeat.
          <li key={i}>
            <button type="button" popoverTarget={id} popoverTargetAction="hide" onClick={() => onChoose(i)}>
              {item}
            </button>
          </li>
        ))}
      </ol>
    </>
  );
}

/** Says how the picture is moved, until it is. */
function GestureHint() {
  const [isShown, setShown] = useState(true);
  useEffect(() => {
    if (!isShown) return;
    const end = ({ target }: Event) => {
      if ((target as Element).matches('.viewport')) setShown(false);
    };
    const events = ['pointerdown', 'wheel', 'keydown'] as const;
    for (const type of events) addEventListener(type, end);
    return () => {
      for (const type of events) removeEventListener(type, end);
    };
  }, [isShown]);
  if (!isShown) return null;
  return <p data-testid="plain-hint">{gestures()}</p>;
}

function gestures(): string {
  const isFramed = window !== top;
  // One finger along the page scrolls the page around a frame.
  if (matchMedia('(pointer: coarse)').matches)
    return isFramed ? 'Drag sideways to turn, pinch to zoom' : 'Drag to turn, pinch to zoom';
  return `Drag to turn, ${isFramed ? `${ZOOM_KEY} + scroll` : 'scroll'} to zoom`;
}

/** Long enough to find a button, ms. */
const IDLE_MS = 4000;
const ACTIVITIES = ['pointermove', 'pointerdown', 'wheel', 'keydown', 'focusin'] as const;

/** Whether the reader has done nothing for a while. */
function useIdle(): boolean {
  const [isIdle, setIdle] = useState(false);
  useEffect(() => {
    let timer: ReturnType<typeof setTimeout> | undefined;
    const wake = () => {
      setIdle(false);
      clearTimeout(timer);
      timer = setTimeout(() => setIdle(true), IDLE_MS);
    };
    wake();
    for (const type of ACTIVITIES) addEventListener(type, wake, { passive: true });
    return () => {
      clearTimeout(timer);
      for (const type of ACTIVITIES) removeEventListener(type, wake);
    };
  }, []);
  return isIdle;
}
