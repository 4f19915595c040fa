import type { StageTimings } from '@websplatter/core';
import { useStore } from 'zustand';
import type { MeasuredThing, ViewerStore } from '../state/store.ts';

/** The button that starts a measurement, or how far it has come and the button that ends it; and what went wrong. */
export function Runner({
  store,
  of,
  label,
  about,
  onStart,
  onCancel,
}: {
  store: ViewerStore;
  of: MeasuredThing;
  /** Of the button that starts it. */
  label: string;
  /** What it does, where that is still to be said. */
  about: string | null;
  onStart: () => void;
  onCancel: () => void;
}) {
  const sweep = useStore(store, (state) => state.sweep);
  const problem = useStore(store, (state) => state.sweepProblem);
  const canMeasure = useStore(store, (state) => state.scene !== null && state.status === 'running');
  if (sweep?.of === of) {
    return (
      <div className="runner" data-testid="sweep">
        <div className="runner-row">
          <p data-testid="sweep-label">{sweep.label}…</p>
          <button type="button" className="text-button" data-testid="cancel-sweep" onClick={onCancel}>
            Cancel
          </button>
        </div>
        <progress value={sweep.done} max={sweep.total} aria-label="Measuring" data-testid="sweep-progress" />
      </div>
    );
  }
  return (
    <div className="runner">
      {about && <p>{about}</p>}
      <button
        type="button"
        className="text-button primary"
        disabled={!canMeasure || sweep !== null}
        data-testid="measure"
        onClick={onStart}
      >
        {label}
      </button>
      {problem?.of === of && (
        <p className="sweep-problem" role="alert">
          {problem.text}
        </p>
      )}
    </div>
  );
}

/** What keeps measured times from being exact, in words. */
export function timingCautions(isSoftware: boolean, source: StageTimings['source']): readonly string[] {
  const cautions = [];
  if (isSoftware) cautions.push('Measured on a software adapter: times are those of the CPU, not of a GPU.');
  if (source === 'wall-clock')
    cautions.push('Times are the wall clock’s, since this GPU does not time its own work.');
  return cautions;
}
