import type { Viewer } from '../engine/viewer.ts';
import type { ViewerStore } from '../state/store.ts';
import { AccuracyMeasurement } from './accuracy-measurement.ts';
import { Measurement } from './measurement.ts';

export interface Measurements {
  readonly measurement: Measurement;
  readonly accuracyMeasurement: AccuracyMeasurement;
  readonly stop: () => void;
}

/** Measures for the viewer's panels, and for a target at once, until it is stopped. */
export function startMeasurements(viewer: Viewer, store: ViewerStore): Measurements {
  const measurement = new Measurement(viewer, store);
  const accuracyMeasurement = new AccuracyMeasurement(viewer, store, measurement);
  const stops = [measurement.watch(), accuracyMeasurement.watch()];
  const stop = () => {
    for (const each of stops) each();
  };
  return { measurement, accuracyMeasurement, stop };
}
