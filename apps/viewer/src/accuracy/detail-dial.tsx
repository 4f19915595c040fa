import { type AccuracySettings, type Detail, isFixedDetail } from '@websplatter/core';
import { useEffect, useId, useState } from 'react';
import { useStore } from 'zustand';
import type { PanelProps } from '../engine/panel-props.ts';
import type { Viewer } from '../engine/viewer.ts';
import { detailOfFrames } from '../state/accuracy.ts';
import type { ViewerState } from '../state/store.ts';
import { type Choice, Choices } from '../ui/choices.tsx';
import { describeDetail } from '../ui/detail-words.ts';
import { formatMany, formatPsnr } from '../ui/format.ts';
import { positionOf, SLIDER_STEPS, valueAt } from './setting-slider.ts';

/** Pictures are compared once the dial and the camera have rested for this long. */
const RESTS_AFTER_MS = 500;

/**
 * PSNR of the picture on the screen, dB, against that of all splats at the same accuracy; null
 * while that is not known, where all are drawn, and where they are not all there.
 */
function useDetailDb({ store, viewer }: PanelProps): number | null {
  const imageId = useStore(store, (state) => state.imageId);
  const isMeasuring = useStore(store, (state) => state.measuring !== null);
  const [found, setFound] = useState<{ readonly imageId: number; readonly psnrDb: number | null } | null>(
    null,
  );
  useEffect(() => {
    // Its frames would slow those that are timed.
    if (isMeasuring) return;
    let isCurrent = true;
    const timer = setTimeout(async () => {
      try {
        const psnrDb = await psnrAgainstFull(viewer, store.getState().accuracy);
        if (isCurrent) setFound({ imageId, psnrDb });
      } catch (error) {
        // A scene or device that has gone meanwhile fails the comparison.
        if (isCurrent) console.error(error);
      }
    }, RESTS_AFTER_MS);
    return () => {
      isCurrent = false;
      clearTimeout(timer);
    };
  }, [store, viewer, imageId, isMeasuring]);
  return found?.imageId === imageId ? found.psnrDb : null;
}

async function psnrAgainstFull(viewer: Viewer, accuracy: AccuracySettings): Promise<number | null> {
  const { engine, frame } = viewer.shownFrame ?? {};
  if (!engine || !frame || frame.detail === 'full' || frame.clouds.some(({ cloud }) => cloud.stream))
    return null;
  const { compareViews } = await import('@websplatter/core/measure');
  const views = [frame.detail, 'full' as const].map((detail) => {
    const view = engine.createView();
    view.render({ ...frame, accuracy, detail, force: true });
    return view;
  });
  try {
    return (await compareViews(views[0], views[1])).psnrDb;
  } finally {
    for (const view of views) view.destroy();
  }
}

/** Details besides numbers of splats. */
const DETAILS: readonly Choice<Detail>[] = [
  ['full', 'Full'],
  ['auto', 'Automatic'],
];

/** The slider begins at this part of the scene: less is no picture. */
const LEAST_PART = 1 / 100;
/** With fewer the slider's steps would be smaller than a splat. */
const LEAST_SPLATS = 100;

/** How much of the scene is drawn, all of it or so many splats at most, and how near that comes. */
export function DetailDial({ store, viewer }: PanelProps) {
  const id = useId();
  const detail = useStore(store, (state) => state.detail);
  const inMotion = useStore(store, detailOfFrames);
  const wholeFrameMs = useStore(store, (state) => state.wholeFrameMs);
  const splats = useStore(store, (state) => state.scene?.splats ?? 0);
  const reason = useStore(store, (state) => whyFull(state, viewer));
  const range = { min: Math.max(LEAST_SPLATS, LEAST_PART * splats), max: splats };
  const maxSplats = typeof detail === 'object' && 'maxSplats' in detail ? detail.maxSplats : undefined;
  const most = Math.min(maxSplats ?? splats, splats);
  const isCount = detail === 'full' || maxSplats !== undefined;
  const psnrDb = useDetailDb({ store, viewer });
  const words = isCount ? `${formatMany(most)} of ${formatMany(splats)}` : describeDetail(detail);
  return (
    <div className="detail-dial" data-testid="detail-dial">
      <div className="detail-row">
        <label htmlFor={id}>Detail</label>
        <Choices
          label="Detail"
          isChips
          choices={DETAILS}
          chosen={inMotion}
          testId="detail-"
          onChoose={(chosen) => viewer.setDetail(chosen)}
        />
        <output htmlFor={id} title="PSNR against the picture with all splats">
          {splats > 0 && words}
          {psnrDb !== null && <span data-testid="detail-db"> · {formatPsnr(psnrDb)}</span>}
        </output>
      </div>
      <input
        id={id}
        type="range"
        min={0}
        max={SLIDER_STEPS}
        disabled={splats <= LEAST_SPLATS}
        value={splats > LEAST_SPLATS ? positionOf(Math.max(most, range.min), range) : SLIDER_STEPS}
        aria-valuetext={isCount ? `${words} splats` : words}
        data-testid="detail-slider"
        onChange={({ target: { valueAsNumber: position } }) =>
          viewer.setDetail(
            position < SLIDER_STEPS ? { maxSplats: Math.round(valueAt(position, range)) } : 'full',
          )
        }
      />
      {reason && <p role="status">Drawn in full: {reason}.</p>}
      {inMotion !== detail && (
        <p role="status" data-testid="detail-slow">
          Coarser while moving: this device takes {wholeFrameMs?.toFixed(0)} ms for a whole frame.
        </p>
      )}
    </div>
  );
}

/** Why all splats are drawn although fewer are asked for; null where that is not so. */
function whyFull({ detail, comparison }: ViewerState, { chosenView }: Viewer): string | null {
  // What is found for an outcome is said to be right, whatever it is.
  if (detail === 'full' || !isFixedDetail(detail)) return null;
  if (comparison?.kind === 'split' && comparison.left !== 'current' && comparison.right !== 'current')
    return 'neither side has the chosen accuracy';
  const levels = chosenView?.effects().find(({ name }) => name === 'levels');
  return levels && !levels.isOn ? levels.reason : null;
}
