import { ACCURACY_PRESETS, type AccuracySettings } from '@websplatter/core';
import { Remote } from '@websplatter/core/write';
import { type Choice, Choices } from '@websplatter/kit/choices';
import { IconButton } from '@websplatter/kit/controls';
import { ERROR_CLASSES } from '@websplatter/kit/error-classes';
import { workerFailure } from '@websplatter/kit/worker-failure';
import { type KeyboardEvent, type PointerEvent, useEffect, useRef } from 'react';
import { useStore } from 'zustand';
import { compare } from '../engine/edit-picture.ts';
import { drawAtRest, drawLayer } from '../engine/show/draw-at-rest.ts';
import type { PanelProps, Viewer } from '../engine/viewer.ts';
import {
  type Comparison,
  type ComparisonSide,
  comparedWithReference,
  type Drawn,
  isSameAccuracy,
  PRESET_NAMES,
  sideDrawn,
} from '../state/accuracy.ts';
import type { LayerImage } from '../state/frames.ts';
import type { ViewerStore } from '../state/store.ts';
import { describeAccuracy, describeDrawn } from '../ui/accuracy-words.ts';
import { focusByPointer } from '../ui/pointer-focus.ts';
import type { ErrorMap } from './error-map.ts';
import type { ErrorMapTasks } from './error-map.worker.ts';

type Kind = Comparison['kind'] | 'none';

const KINDS: readonly Choice<Kind>[] = [
  ['none', 'Off'],
  ['split', 'Split picture'],
  ['error', 'Error map'],
];
const ABOUT: Readonly<Partial<Record<Kind, string>>> = {
  split: 'The same view twice. Drag the line between them, or move it by the arrow keys.',
  error:
    'How far each pixel is from reference, once the view rests. Reference itself has no error: choosing it shows the map of fast.',
};

/** Chooses the kind of comparison and its sides. */
export function ComparisonForm({ store, viewer }: PanelProps) {
  const comparison = useStore(store, (state) => state.comparison);
  const current: Kind = comparison?.kind ?? 'none';
  const choose = (kind: Kind) => {
    if (kind !== 'split') return compare({ store, viewer }, kind === 'none' ? null : { kind });
    const drawn = store.getState();
    const { accuracy } = comparedWithReference(drawn);
    // The default sides differ.
    const right = accuracy === drawn.accuracy ? ACCURACY_PRESETS.reference : accuracy;
    return compare({ store, viewer }, { kind, left: 'current', right });
  };
  return (
    <div className="comparison-form">
      <Choices label="What is shown" choices={KINDS} chosen={current} testId="compare-" onChoose={choose} />
      {ABOUT[current] && <p>{ABOUT[current]}</p>}
      {comparison?.kind === 'split' && (
        <>
          <SideSelect
            label="Left (A)"
            testId="side-left"
            side={comparison.left}
            store={store}
            onChange={(left) => compare({ store, viewer }, { ...comparison, left })}
          />
          <SideSelect
            label="Right (B)"
            testId="side-right"
            side={comparison.right}
            store={store}
            onChange={(right) => compare({ store, viewer }, { ...comparison, right })}
          />
        </>
      )}
    </div>
  );
}

function SideSelect({
  label,
  testId,
  side,
  store,
  onChange,
}: {
  label: string;
  testId: string;
  side: ComparisonSide;
  store: PanelProps['store'];
  onChange: (side: ComparisonSide) => void;
}) {
  const accuracy = useStore(store, (state) => state.accuracy);
  const shown = side === 'current' ? accuracy : side;
  const presets = PRESET_NAMES.map((name) => ACCURACY_PRESETS[name]);
  const others = [shown, accuracy].filter((each) => !presets.some((preset) => isSameAccuracy(preset, each)));
  const kept = uniqueByWords([...presets, ...others]);
  return (
    <label className="side">
      <span>{label}</span>
      <select
        data-testid={testId}
        value={side === 'current' ? 'current' : describeAccuracy(side)}
        onChange={({ target }) => onChange(kept.get(target.value) ?? 'current')}
      >
        <option value="current">Chosen above ({describeAccuracy(accuracy)})</option>
        {[...kept.keys()].map((words) => (
          <option key={words} value={words}>
            {words}
          </option>
        ))}
      </select>
    </label>
  );
}

function uniqueByWords(all: readonly AccuracySettings[]): ReadonlyMap<string, AccuracySettings> {
  return new Map(all.map((each) => [describeAccuracy(each), each]));
}

/** The right side of a split image over the viewer's canvas, and the divider between both sides. */
export function SplitImage({
  store,
  viewer,
  split,
}: PanelProps & { split: Extract<Comparison, { kind: 'split' }> }) {
  const root = useRef<HTMLDivElement>(null);
  const area = useRef<HTMLDivElement>(null);
  const canvas = useRef<HTMLCanvasElement>(null);
  const line = useRef<HTMLDivElement>(null);
  const left = useStore(store, (state) => describeDrawn(sideDrawn(split.left, state)));
  const right = useStore(store, (state) => describeDrawn(sideDrawn(split.right, state)));

  useEffect(() => (canvas.current ? viewer.attachRight(canvas.current) : undefined), [viewer]);
  // The divider follows drags without a React render.
  useEffect(() => {
    const write = () => {
      const { splitPart } = store.getState();
      root.current?.style.setProperty('--split', String(splitPart));
      line.current?.setAttribute('aria-valuenow', String(Math.round(100 * splitPart)));
      line.current?.setAttribute('aria-valuetext', splitText(splitPart, left, right));
    };
    write();
    return store.subscribe((state) => state.splitPart, write);
  }, [store, left, right]);

  const onPointerMove = (event: PointerEvent) => {
    if (!event.currentTarget.hasPointerCapture(event.pointerId)) return;
    const box = area.current?.getBoundingClientRect();
    if (box) store.setState({ splitPart: Math.min(1, Math.max(0, (event.clientX - box.left) / box.width)) });
  };
  const onKeyDown = (event: KeyboardEvent) => {
    const splitPart = movedSplit(store.getState().splitPart, event.key, event.shiftKey);
    if (splitPart === null) return;
    event.preventDefault();
    // Arrow keys that bubble would turn the scene.
    event.stopPropagation();
    store.setState({ splitPart });
  };
  return (
    <div ref={root} className="split" data-testid="split">
      <canvas ref={canvas} className="over-picture split-right" data-testid="split-right" />
      <div ref={area} className="split-area">
        <div
          ref={line}
          className="split-line"
          role="slider"
          tabIndex={0}
          aria-label="Line between the pictures"
          aria-orientation="horizontal"
          aria-valuemin={0}
          aria-valuemax={100}
          aria-valuenow={50}
          data-testid="split-line"
          onPointerDown={(event) => {
            event.currentTarget.setPointerCapture(event.pointerId);
            event.preventDefault();
            focusByPointer(event.currentTarget);
          }}
          onPointerMove={onPointerMove}
          onKeyDown={onKeyDown}
        >
          <span className="split-label left" data-testid="split-label-left">
            <span>
              <b>A</b> {left}
            </span>
          </span>
          <i className="split-handle" aria-hidden="true" />
          <span className="split-label right" data-testid="split-label-right">
            <span>
              <b>B</b> {right}
            </span>
          </span>
        </div>
      </div>
    </div>
  );
}

/** Movement of the divider per key press, as a fraction of the width. */
const STEP = 0.01;
const LARGE_STEP = 0.1;

/** The divider's position after a key press at `part`, 0…1 of the width; null for other keys. */
export function movedSplit(part: number, key: string, isShift: boolean): number | null {
  const step = isShift ? LARGE_STEP : STEP;
  const goals: Readonly<Record<string, number>> = {
    ArrowLeft: part - step,
    ArrowDown: part - step,
    ArrowRight: part + step,
    ArrowUp: part + step,
    PageDown: part - LARGE_STEP,
    PageUp: part + LARGE_STEP,
    Home: 0,
    End: 1,
  };
  if (!Object.hasOwn(goals, key)) return null;
  // Rounded, so that steps back and forth cancel out.
  return Math.min(1, Math.max(0, Math.round(1000 * goals[key]) / 1000));
}

/** The divider's position as text for screen readers. */
export function splitText(part: number, left: string, right: string): string {
  const percent = Math.round(100 * part);
  return `${percent} % ${left}, ${100 - percent} % ${right}`;
}

/** The error map over the viewer's canvas. */
export function ErrorMapImage({ store, viewer }: PanelProps) {
  const canvas = useRef<HTMLCanvasElement>(null);
  useEffect(
    () => (canvas.current ? showErrorMap(canvas.current, viewer, store) : undefined),
    [store, viewer],
  );
  return <canvas ref={canvas} className="over-picture" data-testid="error-map" />;
}

const REFERENCE: Drawn = { accuracy: ACCURACY_PRESETS.reference, detail: 'full' };

/**
 * Shows on `canvas` how far the still picture is from `reference` in full detail, and updates that map
 * with each rest. A worker compares the images. Returns a function that stops this.
 */
function showErrorMap(canvas: HTMLCanvasElement, viewer: Viewer, store: ViewerStore): () => void {
  const remote = new Remote<ErrorMapTasks>(
    () => new Worker(new URL('./error-map.worker.ts', import.meta.url), { type: 'module' }),
    { failure: workerFailure },
  );
  const stop = drawAtRest<ErrorMap>(canvas, viewer, store, {
    asked: ({ restedFrames }) => String(restedFrames),
    async make() {
      const { accuracy } = comparedWithReference(store.getState());
      const reference = await viewer.readImage(REFERENCE);
      const actual = await viewer.readImage({ accuracy });
      if (!reference || !actual) return null;
      return remote.call('map', { actual, reference });
    },
    onShow(map) {
      const errorFigures = map?.figures ?? null;
      if (errorFigures !== store.getState().errorFigures) store.setState({ errorFigures });
    },
  });
  return () => {
    stop();
    remote.end();
    store.setState({ errorFigures: null });
  };
}

/** Explains the error map's colours, with the fraction of the image in each class. */
export function ErrorMapLegend({ store, viewer }: PanelProps) {
  const figures = useStore(store, (state) => state.errorFigures);
  const drawn = useStore(store, (state) => describeDrawn(comparedWithReference(state)));
  return (
    <section className="panel error-legend" aria-label="Error map" data-testid="error-legend">
      <div className="spread">
        <p>
          <b>{drawn}</b> against reference, in steps of 1/255
        </p>
        <IconButton
          icon="close"
          label="End the comparison"
          onClick={() => compare({ store, viewer }, null)}
        />
      </div>
      <ol>
        {ERROR_CLASSES.map(({ label, color }, index) => (
          <li key={label}>
            <i style={{ background: `rgb(${color.join(' ')})` }} aria-hidden="true" />
            <span>{label}</span>
            <small data-testid={`error-part-${label}`}>
              {figures ? formatPart(figures.parts[index]) : ''}
            </small>
          </li>
        ))}
      </ol>
      <p role="status" data-testid="error-max">
        {figures ? `Largest error: ${formatSteps(figures.maxSteps)} of 255` : 'Comparing…'}
      </p>
    </section>
  );
}

/** A fraction of pixels in percent. */
export function formatPart(part: number): string {
  if (part === 0) return '0 %';
  return part < 0.001 ? '< 0.1 %' : `${(100 * part).toFixed(1)} %`;
}

function formatSteps(steps: number): string {
  return steps > 0 && steps < 0.01 ? 'less than 0.01' : String(Number(steps.toFixed(2)));
}

/** The picture of the preset whose row has the pointer or focus, over the viewer's canvas. */
export function LookedPicture({ store }: { readonly store: ViewerStore }) {
  const name = useStore(store, ({ looked, isIdle }) => (isIdle ? looked : null));
  const picture = useStore(store, ({ judged }) => (name === null ? undefined : judged?.[name]));
  if (!picture) return null;
  const { whole, actual: crop, xPx, yPx } = picture;
  const across = (px: number) => `${(100 * px) / whole.widthPx}%`;
  const down = (px: number) => `${(100 * px) / whole.heightPx}%`;
  return (
    <>
      <Pixels image={whole} className="over-picture" testId="looked-picture" />
      {name !== 'reference' && (
        <div className="over-picture" aria-hidden="true">
          <i
            className="worst-place"
            style={{
              left: across(xPx),
              top: down(yPx),
              width: across(crop.widthPx),
              height: down(crop.heightPx),
            }}
            data-testid="worst-place"
          />
        </div>
      )}
    </>
  );
}

/** A canvas with an image. */
export function Pixels({
  image,
  className,
  testId,
}: {
  readonly image: LayerImage;
  readonly className?: string;
  readonly testId?: string;
}) {
  const canvas = useRef<HTMLCanvasElement>(null);
  useEffect(() => {
    if (canvas.current) drawLayer(canvas.current, image);
  }, [image]);
  return <canvas ref={canvas} className={className} data-testid={testId} />;
}
