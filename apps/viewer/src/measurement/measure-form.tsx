import { useStore } from 'zustand';
import { inPlainWords } from '../formatting/accuracy-words.ts';
import { formatDuration } from '../formatting/format.ts';
import type { MeasuredAccuracy } from '../state/measured.ts';
import type { PanelProps } from '../viewer/panel-props.ts';
import type { AccuracyMeasurement } from './accuracy-measurement.ts';
import { MeasuredResults } from './measured-results.tsx';
import { MeasurementRunner } from './measurement-runner.tsx';
import { PsnrExplained } from './psnr-explained.tsx';
import { TargetForm } from './target-form.tsx';

/** Measures cost and error of each setting for the frame on the screen, and offers them. */
export function MeasureForm({
  store,
  viewer,
  accuracyMeasurement,
}: PanelProps & { readonly accuracyMeasurement: AccuracyMeasurement }) {
  const measured = useStore(store, (state) => state.measured);
  const imageId = useStore(store, (state) => state.imageId);
  const choice = useStore(store, (state) => state.choice);
  const hasTarget = useStore(store, (state) => state.target !== null);
  const next = nextSweep(measured?.imageId === imageId ? measured : null, hasTarget);
  const start = (sweep: NextSweep['sweep']) =>
    void (sweep === 'target' ? accuracyMeasurement.choose() : accuracyMeasurement.measure(sweep));
  return (
    <div className="measure-form">
      <MeasurementRunner
        store={store}
        of="accuracy"
        label={next.label}
        about={next.about}
        onStart={() => start(next.sweep)}
        onCancel={() => accuracyMeasurement.cancel()}
      />
      {choice && (
        <p className="choice" role="status" data-testid="choice" data-met={choice.isMet}>
          {inPlainWords(choice.why, choice.point)}
        </p>
      )}
      <PsnrExplained />
      {measured && <MeasuredResults store={store} viewer={viewer} measured={measured} />}
      <TargetForm store={store} viewer={viewer} />
    </div>
  );
}

interface NextSweep {
  readonly sweep: MeasuredAccuracy['sweep'];
  readonly label: string;
  readonly about: string | null;
}

/**
 * The next measurement: the presets, which are quick, and then the rest.
 *
 * @param fresh the knowledge of the image on the screen; null for none.
 */
function nextSweep(fresh: MeasuredAccuracy | null, hasTarget: boolean): NextSweep {
  if (hasTarget)
    return { sweep: 'target', label: fresh ? 'Measure again' : 'Measure this view', about: null };
  if (fresh === null || (fresh.sweep === 'presets' && fresh.isCutShort))
    return {
      sweep: 'presets',
      label: 'Measure the presets',
      about: 'Draws this view with each preset, and shows the time and the error of each.',
    };
  const { allSettingsMs } = fresh;
  if (allSettingsMs === null && !fresh.isCutShort && fresh.sweep === 'settings')
    return { sweep: 'settings', label: 'Measure again', about: null };
  const estimate =
    allSettingsMs === null
      ? ''
      : ` About ${formatDuration(allSettingsMs)}, by the time that the presets took.`;
  return {
    sweep: 'settings',
    label: 'Measure every setting',
    about: `Also changes settings one at a time.${estimate} What is measured stays if you cancel.`,
  };
}
