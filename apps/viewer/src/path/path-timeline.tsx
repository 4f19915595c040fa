import { Icon } from '@websplatter/kit/icon';
import { type KeyboardEvent, type PointerEvent, useEffect, useRef, useState } from 'react';
import { useStore } from 'zustand';
import type { PanelProps } from '../engine/viewer.ts';
import type { SavedViews } from '../navigate/saved-views.ts';
import { drawThumbnail, Thumbnail } from '../navigate/thumbnails.tsx';
import { type CameraPath, viewOnPath } from '../navigate/view-path.ts';
import { type KeptView, viewName } from '../state/saved-view.ts';
import { clamp } from '../state/vec3.ts';

/** Views a shorter way apart would cover each other. */
const KEY_WIDTH_PX = 88;
/** Long paths with one short step would be hundreds of windows wide. */
const MOST_TRACK_PX = 10_000;
/** A pointer that goes less far has clicked. */
const LEAST_DRAG_PX = 5;

interface Drag {
  readonly index: number;
  readonly atMs: number;
}

export interface PathViewsProps {
  readonly views: SavedViews;
  /** Null while there are fewer than two views. */
  readonly path: CameraPath | null;
  /** Index of the saved view that is edited; null without one. */
  readonly selected: number | null;
  readonly onSelect: (index: number | null) => void;
}

/** Small images of a path's views at their times, and a slider over them for the time. */
export function PathTimeline({
  store,
  viewer,
  views,
  path,
  selected,
  onSelect,
}: PanelProps & PathViewsProps) {
  const savedViews = useStore(store, (state) => state.savedViews);
  const turntable = useStore(store, (state) => state.path.turntable);
  const track = useRef<HTMLDivElement>(null);
  const [drag, setDrag] = useState<Drag | null>(null);
  const quarters = useQuarters({ store, viewer }, turntable && path);
  const durationMs = path?.durationMs ?? 1;
  const keys = turntable
    ? quarters.map((jpeg, i) => ({ jpeg, name: `${90 * i}°`, atMs: path?.keys[i].atMs ?? 0 }))
    : savedViews.map((view, i) => ({
        jpeg: view.thumbnail,
        name: viewName(view, i),
        atMs: path?.keys[i].atMs ?? 0,
      }));
  const shortestMs = path
    ? path.keys.reduce((least, { toNextMs }) => Math.min(least, toNextMs), Number.POSITIVE_INFINITY)
    : 1;
  const pxPerS = Math.min(KEY_WIDTH_PX / (shortestMs / 1000), MOST_TRACK_PX / (durationMs / 1000));

  const show = (index: number) => {
    if (!turntable) onSelect(index);
    if (path) views.scrub(path.keys[index].atMs);
    else viewer.camera.goTo(savedViews[index]);
  };
  const dragOf = useKeyDrag(track, durationMs, setDrag, (index, atMs) => {
    views.moveTo(index, atMs);
    onSelect(null);
  });
  const onKeyDown = (event: KeyboardEvent<HTMLElement>, index: number) => {
    const by = ({ ArrowLeft: -1, ArrowRight: 1 } as const)[event.key];
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (by && event.shiftKey && !turntable) {
      if (index + by < 0 || index + by >= keys.length) return;
      views.shift(index, by);
      if (selected !== null) onSelect(index + by);
    } else if ((event.key === 'Delete' || event.key === 'Backspace') && !turntable) {
      views.remove(savedViews[index]);
      onSelect(null);
    } else if (!by) return;
    event.preventDefault();
    event.stopPropagation();
    if (by) buttonsOf(track.current)[index + by]?.focus();
  };
  if (keys.length === 0)
    return (
      <p className="path-empty" data-testid="path-empty">
        A path leads through two views or more: move the picture, add the view, and again. Or make a
        turntable, once around what this view looks at.
      </p>
    );
  return (
    <div className="path-scroll">
      <div
        ref={track}
        className="path-track"
        style={{ width: path ? `max(100%, ${(durationMs / 1000) * pxPerS + KEY_WIDTH_PX}px)` : undefined }}
      >
        <Playhead store={store} views={views} path={path} />
        <ol className="path-keys" data-testid="path-keys" data-single={!path}>
          {keys.map(({ jpeg, name, atMs }, i) => {
            const timeMs = drag?.index === i ? drag.atMs : atMs;
            return (
              // biome-ignore lint/suspicious/noArrayIndexKey: names may repeat.
              <li key={i} style={path ? { left: placeOf(timeMs / durationMs) } : undefined}>
                <button
                  type="button"
                  className="path-key"
                  aria-label={path ? `${name}, at ${(atMs / 1000).toFixed(1)} seconds` : name}
                  aria-pressed={turntable ? undefined : selected === i}
                  data-dragged={drag?.index === i}
                  title={turntable ? undefined : 'Drag it to another time; Shift and an arrow moves it, too'}
                  data-testid={`path-key-${i + 1}`}
                  onClick={() => show(i)}
                  onKeyDown={(event) => onKeyDown(event, i)}
                  {...(turntable || !path ? {} : dragOf(i, atMs))}
                >
                  <Thumbnail jpeg={jpeg} />
                  <span>{name}</span>
                </button>
              </li>
            );
          })}
          {path?.isLooped && (
            <li className="path-return" style={{ left: placeOf(1) }}>
              <Icon name="loop" />
            </li>
          )}
        </ol>
      </div>
    </div>
  );
}

/** The middle of a view's image, at a part of the path's duration. */
function placeOf(part: number): string {
  return `calc(${KEY_WIDTH_PX / 2}px + (100% - ${KEY_WIDTH_PX}px) * ${part})`;
}

function buttonsOf(track: HTMLElement | null): readonly HTMLElement[] {
  return [...(track?.querySelectorAll<HTMLElement>('.path-key') ?? [])];
}

/** A slider over the path's duration, and a line at its time through the views below. */
function Playhead({
  store,
  views,
  path,
}: Pick<PanelProps, 'store'> & Pick<PathViewsProps, 'views' | 'path'>) {
  const durationMs = path?.durationMs ?? 0;
  const playheadMs = useStore(store, (state) => clamp(state.playheadMs, 0, durationMs));
  const line = useRef<HTMLDivElement>(null);
  const isPlaying = useStore(store, (state) => state.isPathPlaying);
  useEffect(() => {
    if (isPlaying && playheadMs >= 0) line.current?.scrollIntoView({ block: 'nearest', inline: 'nearest' });
  }, [isPlaying, playheadMs]);
  if (!path) return null;
  return (
    <>
      <input
        type="range"
        className="path-playhead"
        aria-label="Time on the path"
        aria-valuetext={`${(playheadMs / 1000).toFixed(1)} of ${(durationMs / 1000).toFixed(1)} seconds`}
        min={0}
        max={durationMs}
        step={20}
        value={playheadMs}
        data-testid="path-playhead"
        onChange={({ target }) => views.scrub(target.valueAsNumber)}
      />
      <div ref={line} className="path-line" style={{ left: placeOf(playheadMs / durationMs) }} />
    </>
  );
}

/** Handlers that drag a view along the track; fingers scroll the track instead. */
function useKeyDrag(
  track: { readonly current: HTMLElement | null },
  durationMs: number,
  onDrag: (drag: Drag | null) => void,
  onDrop: (index: number, atMs: number) => void,
) {
  const held = useRef<{ fromPx: number; msPerPx: number; atMs: number | null } | null>(null);
  const end = () => {
    held.current = null;
    onDrag(null);
  };
  return (index: number, fromMs: number) => ({
    onPointerDown: ({
      pointerType,
      button,
      clientX,
      currentTarget,
      pointerId,
    }: PointerEvent<HTMLElement>) => {
      if (pointerType === 'touch' || button !== 0 || !track.current) return;
      currentTarget.setPointerCapture(pointerId);
      const widthPx = track.current.clientWidth - KEY_WIDTH_PX;
      held.current = { fromPx: clientX, msPerPx: durationMs / widthPx, atMs: null };
    },
    onPointerMove: ({ clientX }: PointerEvent) => {
      const grip = held.current;
      if (!grip) return;
      const byPx = clientX - grip.fromPx;
      if (grip.atMs === null && Math.abs(byPx) < LEAST_DRAG_PX) return;
      grip.atMs = Math.max(0, fromMs + byPx * grip.msPerPx);
      onDrag({ index, atMs: grip.atMs });
    },
    onClickCapture: (event: { stopPropagation(): void }) => {
      // The click that ends a drag.
      if (held.current?.atMs != null) event.stopPropagation();
      held.current = null;
    },
    onPointerUp: () => {
      const atMs = held.current?.atMs;
      onDrag(null);
      if (atMs != null) onDrop(index, atMs);
    },
    onPointerCancel: end,
    onLostPointerCapture: () => onDrag(null),
  });
}

/** Small images of a turntable's views: it has none of its own, and nothing keeps them. */
function useQuarters({ store, viewer }: PanelProps, path: CameraPath | null): readonly (string | null)[] {
  const hasPicture = useStore(store, (state) => state.imageId > 0);
  const [drawn, setDrawn] = useState<{ path: CameraPath; jpegs: readonly (string | null)[] } | null>(null);
  useEffect(() => {
    if (!path || !hasPicture) return;
    let isStale = false;
    const draw = async () => {
      const jpegs: (string | null)[] = [];
      for (const { atMs } of path.keys) {
        const view: KeptView = viewOnPath(path, atMs);
        // A key whose picture cannot be drawn has none; drawing the scene reports the reason.
        jpegs.push(await drawThumbnail({ store, viewer }, view).catch(() => null));
        if (isStale) return;
        setDrawn({ path, jpegs: [...jpegs] });
      }
    };
    void draw();
    return () => {
      isStale = true;
    };
  }, [store, viewer, path, hasPicture]);
  return path?.keys.map((_, i) => (drawn?.path === path ? (drawn.jpegs[i] ?? null) : null)) ?? [];
}
