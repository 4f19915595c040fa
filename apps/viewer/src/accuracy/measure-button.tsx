import type { StageTimings } from '@websplatter/core';
import { TextButton } from '@websplatter/kit/controls';
import { useStore } from 'zustand';
import type { MeasuredThing } from '../state/measured.ts';
import type { ViewerStore } from '../state/store.ts';
import { Running } from '../ui/running.tsx';

/**
 * A button that starts a measurement; while it runs, its progress with a cancel button. Also shows
 * the last failure.
 */
export function MeasureButton({
  store,
  of,
  label,
  about,
  onStart,
  onCancel,
}: {
  store: ViewerStore;
  of: MeasuredThing;
  /** Label of the start button. */
  label: string;
  /** Describes the measurement; null if the description is already visible. */
  about: string | null;
  onStart: () => void;
  onCancel: () => void;
}) {
  const measuring = useStore(store, (state) => state.measuring);
  const failed = useStore(store, (state) => state.failedMeasurement);
  const canMeasure = useStore(store, (state) => state.scene !== null && state.status === 'running');
  if (measuring?.of === of) {
    return (
      <Running
        label={`${measuring.label}…`}
        about="Measuring"
        // The first step may take seconds.
        value={measuring.done || undefined}
        max={measuring.total}
        onCancel={onCancel}
        testId="sweep"
        cancelId="cancel-sweep"
      />
    );
  }
  return (
    <div className="runner">
      {about && <p>{about}</p>}
      <TextButton
        look="primary"
        disabled={!canMeasure || measuring !== null}
        testId="measure"
        onClick={onStart}
      >
        {label}
      </TextButton>
      {failed?.of === of && (
        <p className="sweep-problem" role="alert">
          {failed.text}
        </p>
      )}
    </div>
  );
}

/** Reasons why measured times are inexact, as sentences. */
export function timingCautions(isSoftware: boolean, source: StageTimings['source']): readonly string[] {
  const cautions = [];
  if (isSoftware) cautions.push('Measured without a GPU: these are times of the CPU.');
  if (source === 'wall-clock')
    cautions.push('This GPU does not time its own work, so these are times of the wall clock.');
  return cautions;
}
