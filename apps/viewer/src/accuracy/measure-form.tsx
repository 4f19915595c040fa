import { ACCURACY_PRESETS, type AccuracyTarget } from '@websplatter/core';
import { TextButton } from '@websplatter/kit/controls';
import { formatDuration } from '@websplatter/kit/format';
import { type FormEvent, useId, useState } from 'react';
import { useStore } from 'zustand';
import { editPicture } from '../engine/edit-picture.ts';
import type { PanelProps } from '../engine/viewer.ts';
import { nearestPreset } from '../state/accuracy.ts';
import type { JudgedPictures, MeasuredAccuracy } from '../state/measured.ts';
import type { ViewerStore } from '../state/store.ts';
import { inPlainWords } from '../ui/accuracy-words.ts';
import { DetailDial } from './accuracy-settings.tsx';
import { Pixels } from './compared-pictures.tsx';
import { CROP_PX } from './error-map.ts';
import { MeasureButton, timingCautions } from './measure-button.tsx';
import type { AccuracyMeasurement } from './measure-presets.ts';
import { MeasuredResults } from './measured-results.tsx';
import { costOf, type PresetCost, PresetRows, verdictOf } from './preset-rows.tsx';

/** Costs of the built-in scene from evidence/accuracy-settings.json, shown until costs are measured here. */
const RECORDED: {
  readonly title: string;
  readonly device: string;
  readonly costs: readonly PresetCost[];
} = {
  title: 'Still life',
  device: 'Example from another device: NVIDIA H200, 1920 × 1080',
  costs: [
    recorded('reference', 0.47, 0),
    recorded('high', 0.45, 1),
    recorded('balanced', 0.44, 1),
    recorded('fast', 0.39, 103),
    recorded('paper', 12.43, 31),
  ],
};

function recorded(name: string, ms: number, maxSteps: number): PresetCost {
  return { name, totalMs: { median: ms, low: ms, high: ms }, stagesMs: null, maxSteps, p999Steps: maxSteps };
}

/**
 * Costs of the presets for the current frame: the verdict, each preset with its picture, then all
 * measured figures.
 */
export function MeasureForm({
  store,
  viewer,
  accuracyMeasurement,
}: PanelProps & { readonly accuracyMeasurement: AccuracyMeasurement }) {
  const measured = useStore(store, (state) => state.measured);
  const pictures = useStore(store, (state) => state.judged);
  const imageId = useStore(store, (state) => state.imageId);
  const choice = useStore(store, (state) => state.choice);
  const isMeasuring = useStore(store, (state) => state.measuring !== null);
  const hasTarget = useStore(store, (state) => state.target !== null);
  const isBuiltin = useStore(store, (state) => state.scene?.title === RECORDED.title);
  const fresh = measured?.imageId === imageId ? measured : null;
  const frameMs = useStore(store, (state) => state.statistics?.timing.totalMs ?? 0);
  const resolutionScale = useStore(store, (state) => state.accuracy.resolutionScale);
  // Presets draw every pixel.
  const presetsMs = (frameMs * accuracyMeasurement.framesOfPresets) / resolutionScale ** 2;
  const next = nextSweep(fresh, hasTarget, presetsMs);
  const recorded = isBuiltin && !measured ? RECORDED : null;
  const presets = measured?.table.points.filter(({ name }) => Object.hasOwn(ACCURACY_PRESETS, name)) ?? [];
  const costs = presets.map(costOf);
  const start = (sweep: NextSweep['sweep']) =>
    void (sweep === 'target' ? accuracyMeasurement.choose() : accuracyMeasurement.measure(sweep));
  const runner = (
    <MeasureButton
      store={store}
      of="accuracy"
      label={next.label}
      about={next.about}
      onStart={() => start(next.sweep)}
      onCancel={() => accuracyMeasurement.cancel()}
    />
  );
  // Once there are results, the next measurement matters less.
  const isLater = costs.length > 0;
  return (
    <div className="measure-form">
      <p className="verdict" role="status" data-testid="verdict">
        {verdictOf(costs)}
      </p>
      {measured && (
        <div data-testid="measure-cautions">
          {timingCautions(measured.isSoftware, measured.table.timing).map((caution) => (
            <p key={caution}>{caution}</p>
          ))}
        </div>
      )}
      {measured && !fresh && <p className="stale">Measured for another view, scene, size or detail.</p>}
      {!isLater && runner}
      {choice && (
        <p className="choice" role="status" data-testid="choice" data-met={choice.isMet}>
          {inPlainWords(choice.why, choice.point)}
        </p>
      )}
      {recorded ? (
        <section className="recorded" aria-label={recorded.device} data-testid="recorded">
          <h3>{recorded.device}</h3>
          <PresetRows store={store} viewer={viewer} costs={recorded.costs} isExample />
          <p>Measure to see what the presets cost here.</p>
        </section>
      ) : (
        <PresetRows store={store} viewer={viewer} costs={costs} pictures={pictures} isDescribed />
      )}
      {measured && costs.length > 0 && <BarsExplained frames={measured.table.frames} />}
      {pictures && <WorstCrops store={store} pictures={pictures} />}
      {isLater && runner}
      {fresh?.sweep === 'presets' && !fresh.isCutShort && next.sweep === 'settings' && (
        <TextButton disabled={isMeasuring} testId="measure-again" onClick={() => start('presets')}>
          Measure the presets again
        </TextButton>
      )}
      <DetailDial store={store} viewer={viewer} />
      {measured && (
        <details className="explained" data-testid="all-results">
          <summary>Decibels, intervals and single settings</summary>
          <PsnrExplained />
          <MeasuredResults store={store} viewer={viewer} measured={measured} />
        </details>
      )}
      <TargetForm store={store} viewer={viewer} />
    </div>
  );
}

/** Measurements that the GPU ends sooner take this long with everything else. */
const FEW_SECONDS_MS = 10_000;
/** Of fewer frames there is no interval for the median, and all their times are shown. */
const FEWEST_FOR_INTERVAL = 6;

interface NextSweep {
  readonly sweep: MeasuredAccuracy['sweep'];
  readonly label: string;
  readonly about: string | null;
}

/** Explains the bars of the presets, and why the figures beside the picture show other times. */
function BarsExplained({ frames }: { readonly frames: number }) {
  const range =
    frames < FEWEST_FOR_INTERVAL ? 'from the quickest to the slowest' : 'where the true median is, 95 % sure';
  return (
    <p data-testid="bars-explained">
      Bars: the median of {frames} frames, in the colours of the stages. Thin lines: {range}. A bar that fades
      is longer than its row. The figures beside the picture are of one frame each.
    </p>
  );
}

/**
 * The next measurement: first the presets, which are quick, then all settings.
 *
 * @param fresh results for the current image; null if there are none.
 * @param presetsMs how long the GPU will take for the presets.
 */
function nextSweep(fresh: MeasuredAccuracy | null, hasTarget: boolean, presetsMs: number): NextSweep {
  if (hasTarget)
    return { sweep: 'target', label: fresh ? 'Measure again' : 'Measure this view', about: null };
  if (fresh === null || (fresh.sweep === 'presets' && fresh.isCutShort))
    return {
      sweep: 'presets',
      label: 'Measure the presets',
      about: `Times each preset on this view and shows its error. Takes ${presetsMs < FEW_SECONDS_MS ? 'a few seconds' : `about ${formatDuration(presetsMs)}`}.`,
    };
  const { allSettingsMs } = fresh;
  if (allSettingsMs === null && !fresh.isCutShort && fresh.sweep === 'settings')
    return { sweep: 'settings', label: 'Measure again', about: null };
  const estimate = allSettingsMs === null ? '' : ` Takes about ${formatDuration(allSettingsMs)}.`;
  return {
    sweep: 'settings',
    label: 'Measure every setting',
    about: `Tries every setting on its own.${estimate} Cancel any time; results stay.`,
  };
}

/** Explains PSNR at its first mention. */
function PsnrExplained() {
  return (
    <details className="explained" data-testid="psnr-explained">
      <summary>What PSNR (dB) means</summary>
      <p>
        The peak signal-to-noise ratio says in decibels (dB) how close a picture is to the one that the preset
        reference draws; higher is closer. At 48 dB the colours are off by one step of 255 (root mean square),
        at 42 dB by two, at 28 dB by ten. “Identical” means that no pixel differs.
      </p>
    </details>
  );
}

/**
 * Magnified crop with a preset's largest errors, beside the reference. Shows the preset under the
 * pointer, else the drawn preset, else the last one.
 */
function WorstCrops({ store, pictures }: { readonly store: ViewerStore; readonly pictures: JudgedPictures }) {
  const looked = useStore(store, (state) => state.looked);
  const drawn = useStore(store, (state) => nearestPreset(state.accuracy).preset);
  const names = Object.keys(pictures).filter((name) => name !== 'reference');
  const name = [looked, drawn].find((each) => each !== null && names.includes(each)) ?? names.at(-1);
  const picture = name && pictures[name];
  if (!picture) return null;
  return (
    <div className="worst-crops" data-testid="worst-crops">
      <figure>
        <Pixels image={picture.reference} />
        <figcaption>reference</figcaption>
      </figure>
      <figure>
        <Pixels image={picture.actual} />
        <figcaption>{name}</figcaption>
      </figure>
      <figure>
        <Pixels image={picture.error} />
        <figcaption>difference, amplified</figcaption>
      </figure>
      <p>
        The {CROP_PX} × {CROP_PX} pixels where {name} has its largest errors: framed in the picture while its
        row is pointed at.
      </p>
    </div>
  );
}

type TargetKind = 'minPsnrDb' | 'maxFrameMs';

/** Texts for the fields of a target, by name. */
function textsOf(target: AccuracyTarget | null): Partial<Record<TargetKind, string>> {
  return Object.fromEntries(Object.entries(target ?? {}).map(([name, value]) => [name, String(value)]));
}

/** A form that requests an outcome, such as a PSNR, instead of settings. */
function TargetForm({ store, viewer }: PanelProps) {
  const id = useId();
  const isBusy = useStore(store, (state) => state.measuring !== null || state.scene === null);
  const isFinding = useStore(store, (state) => state.target !== null && state.choice === null);
  const { target } = store.getState();
  const [kind, setKind] = useState<TargetKind>(target && 'maxFrameMs' in target ? 'maxFrameMs' : 'minPsnrDb');
  const [amounts, setAmounts] = useState({ minPsnrDb: '45', maxFrameMs: '8', ...textsOf(target) });
  const value = Number(amounts[kind]);
  const submit = (event: FormEvent) => {
    event.preventDefault();
    const wanted = kind === 'minPsnrDb' ? { minPsnrDb: value } : { maxFrameMs: value };
    editPicture({ store, viewer }, 'target', () => viewer.setTarget(wanted));
  };
  return (
    <form className="target" onSubmit={submit} aria-labelledby={`${id}-title`} data-testid="target">
      <h3 id={`${id}-title`}>Set a target</h3>
      <div className="target-row">
        <select
          aria-label="Target"
          value={kind}
          data-testid="target-kind"
          onChange={({ target }) => setKind(target.value as TargetKind)}
        >
          <option value="minPsnrDb">Quality at least</option>
          <option value="maxFrameMs">Time at most</option>
        </select>
        <input
          type="number"
          aria-label={kind === 'minPsnrDb' ? 'Decibels of PSNR' : 'Milliseconds per frame'}
          min={kind === 'minPsnrDb' ? 1 : 0.1}
          step="any"
          required
          value={amounts[kind]}
          data-testid="target-value"
          onChange={({ target }) => setAmounts({ ...amounts, [kind]: target.value })}
        />
        <span aria-hidden="true">{kind === 'minPsnrDb' ? 'dB' : 'ms'}</span>
        <button
          type="submit"
          className="text-button outlined"
          disabled={isBusy || !(value > 0)}
          data-testid="target-submit"
        >
          {isBusy && isFinding ? 'Finding settings…' : 'Find settings'}
        </button>
      </div>
      <p>Judged by the worst of eight views (without a GPU: this view). Applies to scenes you open later.</p>
    </form>
  );
}
