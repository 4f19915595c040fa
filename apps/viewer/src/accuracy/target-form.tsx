import type { AccuracyTarget } from '@websplatter/core';
import { type FormEvent, useId, useState } from 'react';
import { useStore } from 'zustand';
import type { PanelProps } from '../engine/panel-props.ts';

type TargetKind = 'minPsnrDb' | 'maxFrameMs';

/** The number of a target as text for its field, by the target's name. */
function textsOf(target: AccuracyTarget | null): Partial<Record<TargetKind, string>> {
  return Object.fromEntries(Object.entries(target ?? {}).map(([name, value]) => [name, String(value)]));
}

/** Asks for an outcome instead of settings. */
export function TargetForm({ store, viewer }: PanelProps) {
  const id = useId();
  const isBusy = useStore(store, (state) => state.measuring !== null || state.scene === null);
  const { target } = store.getState();
  const [kind, setKind] = useState<TargetKind>(target && 'maxFrameMs' in target ? 'maxFrameMs' : 'minPsnrDb');
  const [amounts, setAmounts] = useState({ minPsnrDb: '45', maxFrameMs: '8', ...textsOf(target) });
  const value = Number(amounts[kind]);
  const submit = (event: FormEvent) => {
    event.preventDefault();
    viewer.setTarget(kind === 'minPsnrDb' ? { minPsnrDb: value } : { maxFrameMs: value });
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
          <option value="minPsnrDb">At least</option>
          <option value="maxFrameMs">At most</option>
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
          Choose automatically
        </button>
      </div>
      <p>
        Measures eight views around this one, of which the worst counts; without a GPU, only this view. Scenes
        that you open later are measured, too.
      </p>
    </form>
  );
}
