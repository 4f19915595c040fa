import {
  ACCURACY_SETTINGS,
  type AccuracySetting,
  type AccuracySettings,
  type Detail,
  isFixedDetail,
} from '@websplatter/core';
import { type Choice, Choices } from '@websplatter/kit/choices';
import { formatMany, formatPsnr } from '@websplatter/kit/format';
import { type CSSProperties, useEffect, useId, useState } from 'react';
import { useStore } from 'zustand';
import { editPicture, setAccuracy } from '../engine/edit-picture.ts';
import type { PanelProps, ShownFrame, Viewer } from '../engine/viewer.ts';
import { detailOfFrames, SETTING_NAMES, type SettingName } from '../state/accuracy.ts';
import type { ViewerState } from '../state/store.ts';
import { describeDetail, formatValue, type SettingValue, valueWords } from '../ui/accuracy-words.ts';
import { useGesture } from '../ui/use-gesture.ts';

/** A control for every setting, with its description. */
export function AccuracySettingsForm({ store, viewer }: PanelProps) {
  const accuracy = useStore(store, (state) => state.accuracy);
  return (
    <div className="settings">
      {SETTING_NAMES.map((name) => (
        <Setting
          key={name}
          name={name}
          value={accuracy[name]}
          onChange={(value, gesture) => {
            const settings = { ...store.getState().accuracy, [name]: value } as AccuracySettings;
            setAccuracy({ store, viewer }, settings, gesture);
          }}
        />
      ))}
    </div>
  );
}

function Setting({
  name,
  value,
  onChange,
}: {
  name: SettingName;
  value: SettingValue;
  onChange: (value: SettingValue, gesture: object) => void;
}) {
  const id = useId();
  const { gesture, begins } = useGesture();
  const { label, about, unit, values }: AccuracySetting<unknown> = ACCURACY_SETTINGS[name];
  const range = 'min' in values ? values : null;
  const described = { id, 'aria-describedby': `${id}-about`, 'data-testid': `setting-${name}` };
  return (
    <div className="setting">
      <span className="setting-name">
        <label htmlFor={id}>{label}</label> <code>{name}</code>
      </span>
      {range ? (
        <span className="setting-range">
          <input
            {...described}
            {...begins}
            type="range"
            min={0}
            max={SLIDER_STEPS}
            value={positionOf(Number(value), range)}
            aria-valuetext={`${formatValue(value)} ${unit}`}
            onChange={({ target }) =>
              onChange(valueAt(Number(target.value), range) as SettingValue, gesture.current)
            }
          />
          <output htmlFor={id}>{formatValue(value)}</output>
        </span>
      ) : (
        <select
          {...described}
          {...begins}
          value={String(value)}
          onChange={({ target }) => {
            const chosen = (values as readonly SettingValue[]).find((each) => String(each) === target.value);
            if (chosen !== undefined) onChange(chosen, gesture.current);
          }}
        >
          {(values as readonly SettingValue[]).map((each) => (
            <option key={each} value={String(each)}>
              {optionWords(name, each)}
            </option>
          ))}
        </select>
      )}
      <p id={`${id}-about`}>{about}</p>
    </div>
  );
}

/** `16-bit (f16)`: plain words, and the identifier if it differs. */
function optionWords(name: SettingName, value: SettingValue): string {
  const words = valueWords(name, value);
  const isSaid = words.replaceAll(' ', '-').includes(String(value));
  return isSaid ? words : `${words} (${value})`;
}

/** The states of detail; one of them always applies. */
type DetailState = 'full' | 'auto' | 'limited';

const DETAIL_STATES: readonly Choice<DetailState>[] = [
  ['full', 'Full'],
  ['auto', 'Automatic'],
  ['limited', 'Limited'],
];
const ABOUT_DETAIL: Readonly<Record<DetailState, string>> = {
  full: 'All splats, always',
  auto: 'Fewer splats while something moves, all at rest',
  limited: 'As many splats as the slider says',
};

/** The state that a detail counts as; slow devices draw as with Automatic unless someone chose. */
export function detailStateOf(detail: Detail, inMotion: Detail): DetailState {
  if (detail === 'full' && inMotion !== detail) return 'auto';
  return typeof detail === 'string' ? detail : 'limited';
}

/** First limit, as a fraction of the scene. */
const FIRST_PART = 1 / 2;

/** Lowest value of the slider, as a fraction of the scene: fewer splats show nothing. */
const LEAST_PART = 1 / 100;
/** Least number of splats for the slider: its steps would be smaller than a splat. */
const LEAST_SPLATS = 100;
/** Fractions of the scene that have a mark below the slider. */
const TICK_PARTS = [0.01, 0.03, 0.1, 0.3, 1];

/** Chooses how many splats of the scene are drawn at most, and shows the resulting PSNR. */
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
  const words = isCount ? `${formatMany(most)} of ${formatMany(splats)} splats` : describeDetail(detail);
  const state = detailStateOf(detail, inMotion);
  const { gesture, begins } = useGesture();
  const setDetail = (chosen: Detail, own: object | null = null) =>
    editPicture({ store, viewer }, 'detail', () => viewer.setDetail(chosen), own);
  const choose = (chosen: DetailState) =>
    setDetail(chosen === 'limited' ? { maxSplats: Math.ceil(FIRST_PART * splats) } : chosen);
  return (
    <div className="detail-dial" data-testid="detail-dial">
      <div className="detail-row">
        <label htmlFor={id}>Detail</label>
        <Choices
          label="Detail"
          isChips
          choices={DETAIL_STATES}
          chosen={state}
          titleOf={(each) => ABOUT_DETAIL[each]}
          testId="detail-"
          onChoose={choose}
        />
        <output htmlFor={id} title="PSNR against the picture with all splats">
          {splats > 0 && words}
          {psnrDb === 'unknown' && ' · comparing…'}
          {typeof psnrDb === 'number' && <span data-testid="detail-db"> · {formatPsnr(psnrDb)}</span>}
        </output>
      </div>
      <input
        {...begins}
        id={id}
        type="range"
        min={0}
        max={SLIDER_STEPS}
        disabled={splats <= LEAST_SPLATS}
        value={splats > LEAST_SPLATS ? positionOf(Math.max(most, range.min), range) : SLIDER_STEPS}
        aria-valuetext={words}
        data-testid="detail-slider"
        onChange={({ target: { valueAsNumber: position } }) =>
          setDetail(
            position < SLIDER_STEPS ? { maxSplats: Math.round(valueAt(position, range)) } : 'full',
            gesture.current,
          )
        }
      />
      <div className="detail-ticks" aria-hidden="true">
        {TICK_PARTS.filter((part) => part * splats >= range.min).map((part) => (
          <span
            key={part}
            style={{ '--part': positionOf(part * splats, range) / SLIDER_STEPS } as CSSProperties}
          >
            {100 * part} %
          </span>
        ))}
      </div>
      {reason && <p role="status">Drawn in full: {reason}.</p>}
      {inMotion !== detail && (
        <p role="status" data-testid="detail-slow">
          Coarser while moving: this device takes {wholeFrameMs?.toFixed(0)} ms for a whole frame. Full keeps
          all splats.
        </p>
      )}
    </div>
  );
}

/** Pictures are compared after dial and camera have rested for this long. */
const RESTS_AFTER_MS = 300;

/**
 * PSNR of the current picture against a picture of all splats at the same accuracy, dB. Null if all
 * splats are drawn, and for streamed scenes.
 */
function useDetailDb({ store, viewer }: PanelProps): number | null | 'unknown' {
  const imageId = useStore(store, (state) => state.imageId);
  const isMeasuring = useStore(store, (state) => state.measuring !== null);
  const [found, setFound] = useState<{ readonly imageId: number; readonly psnrDb: number | null } | null>(
    null,
  );
  useEffect(() => {
    // Frames of a comparison would slow down frames that are timed.
    if (isMeasuring) return;
    let isCurrent = true;
    const timer = setTimeout(async () => {
      try {
        const psnrDb = await psnrAgainstFull(viewer, store.getState().accuracy);
        if (isCurrent) setFound({ imageId, psnrDb });
      } catch (error) {
        // The comparison also fails if the scene or device is gone meanwhile.
        if (!isCurrent) return;
        console.error(error);
        setFound({ imageId, psnrDb: null });
      }
    }, RESTS_AFTER_MS);
    return () => {
      isCurrent = false;
      clearTimeout(timer);
    };
  }, [store, viewer, imageId, isMeasuring]);
  const isFewer = useStore(store, ({ detail }) => detail !== 'full' && isFixedDetail(detail));
  if (!isFewer || !comparedFrame(viewer)) return null;
  return found?.imageId === imageId ? found.psnrDb : 'unknown';
}

/** The frame on the screen if it has fewer splats than the scene, all of which are there. */
function comparedFrame({ shownFrame }: Viewer): ShownFrame | null {
  const frame = shownFrame?.frame;
  if (!frame || frame.detail === 'full' || frame.clouds.some(({ cloud }) => cloud.stream)) return null;
  return shownFrame;
}

async function psnrAgainstFull(viewer: Viewer, accuracy: AccuracySettings): Promise<number | null> {
  const compared = comparedFrame(viewer);
  if (!compared) return null;
  const { engine, frame } = compared;
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

/** Why all splats are drawn although the detail asks for fewer; null if fewer are drawn. */
function whyFull({ detail, comparison }: ViewerState, { chosenView }: Viewer): string | null {
  // A detail derived from an outcome may legitimately be full.
  if (detail === 'full' || !isFixedDetail(detail)) return null;
  if (comparison?.kind === 'split' && comparison.left !== 'current' && comparison.right !== 'current')
    return 'neither side has the chosen accuracy';
  // The last frame may have been drawn with another detail.
  if (chosenView?.detail?.asked !== detail) return null;
  const levels = chosenView?.effects().find(({ name }) => name === 'levels');
  return levels && !levels.isOn ? levels.reason : null;
}

/** Number of slider steps. */
export const SLIDER_STEPS = 200;
/** Ranges with a larger ratio of their ends have geometric steps. */
const LARGEST_LINEAR_RATIO = 20;

interface ValueRange {
  readonly min: number;
  readonly max: number;
}

/** The value at a slider's `position`, 0…SLIDER_STEPS, to three digits; both ends are exact. */
export function valueAt(position: number, { min, max }: ValueRange): number {
  if (position <= 0) return min;
  if (position >= SLIDER_STEPS) return max;
  const part = position / SLIDER_STEPS;
  const value = isByRatio({ min, max }) ? min * (max / min) ** part : min + (max - min) * part;
  return Math.min(max, Math.max(min, Number(value.toPrecision(3))));
}

/** The slider's position for `value`. */
export function positionOf(value: number, { min, max }: ValueRange): number {
  const part = isByRatio({ min, max })
    ? Math.log(value / min) / Math.log(max / min)
    : (value - min) / (max - min);
  return Math.round(part * SLIDER_STEPS);
}

function isByRatio({ min, max }: ValueRange): boolean {
  return min > 0 && max / min > LARGEST_LINEAR_RATIO;
}
