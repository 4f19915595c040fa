import { useStore } from 'zustand';
import type { MeasuredThing } from '../state/measured.ts';
import type { ViewerStore } from '../state/store.ts';

/**
 * The button that starts a measurement, or its progress with a button that ends it; and its last
 * failure.
 */
export function MeasurementRunner({
  store,
  of,
  label,
  about,
  onStart,
  onCancel,
}: {
  store: ViewerStore;
  of: MeasuredThing;
  /** Label of the button that starts it. */
  label: string;
  /** Describes the measurement; null once that has been said. */
  about: string | null;
  onStart: () => void;
  onCancel: () => void;
}) {
  const measuring = useStore(store, (state) => state.measuring);
  const failed = useStore(store, (state) => state.failedMeasurement);
  const canMeasure = useStore(store, (state) => state.scene !== null && state.status === 'running');
  if (measuring?.of === of) {
    return (
      <div className="runner" data-testid="sweep">
        <div className="runner-row">
          <p data-testid="sweep-label">{measuring.label}…</p>
          <button type="button" className="text-button" data-testid="cancel-sweep" onClick={onCancel}>
            Cancel
          </button>
        </div>
        <progress
          value={measuring.done}
          max={measuring.total}
          aria-label="Measuring"
          data-testid="sweep-progress"
        />
      </div>
    );
  }
  return (
    <div className="runner">
      {about && <p>{about}</p>}
      <button
        type="button"
        className="text-button primary"
        disabled={!canMeasure || measuring !== null}
        data-testid="measure"
        onClick={onStart}
      >
        {label}
      </button>
      {failed?.of === of && (
        <p className="sweep-problem" role="alert">
          {failed.text}
        </p>
      )}
    </div>
  );
}
