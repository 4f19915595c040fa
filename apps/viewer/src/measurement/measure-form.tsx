import { useStore } from 'zustand';
import type { PanelProps } from '../viewer/panel-props.ts';
import type { AccuracyMeasurement } from './accuracy-measurement.ts';
import { MeasuredResults } from './measured-results.tsx';
import { MeasurementRunner } from './measurement-runner.tsx';
import { WishForm } from './wish-form.tsx';

/** Measures the cost and the error of each setting for the frame on the screen, and offers them to choose from. */
export function MeasureForm({
  store,
  viewer,
  accuracyMeasurement,
}: PanelProps & { readonly accuracyMeasurement: AccuracyMeasurement }) {
  const measured = useStore(store, (state) => state.measured);
  const choice = useStore(store, (state) => state.choice);
  const hasWish = useStore(store, (state) => state.wish !== null);
  return (
    <div className="measure-form">
      <MeasurementRunner
        store={store}
        of="accuracy"
        label={measured ? 'Measure again' : 'Measure this view'}
        about={
          measured ? null : 'Draws this view with every setting, and shows the time and the error of each.'
        }
        onStart={() => void (hasWish ? accuracyMeasurement.choose() : accuracyMeasurement.measure())}
        onCancel={() => accuracyMeasurement.cancel()}
      />
      {choice && (
        <p className="choice" role="status" data-testid="choice" data-met={choice.isMet}>
          {choice.why}
        </p>
      )}
      {measured && <MeasuredResults store={store} viewer={viewer} measured={measured} />}
      <WishForm store={store} viewer={viewer} />
    </div>
  );
}
