import type { AccuracyWish } from '@websplatter/core';
import { type FormEvent, useId, useState } from 'react';
import { useStore } from 'zustand';
import type { PanelProps } from '../viewer/panel-props.ts';

type WishKind = 'minPsnrDb' | 'maxFrameMs';

/** The number of a wish as text for its field, by the wish's name. */
function textsOf(wish: AccuracyWish | null): Partial<Record<WishKind, string>> {
  return Object.fromEntries(Object.entries(wish ?? {}).map(([name, value]) => [name, String(value)]));
}

/** Asks for an outcome instead of settings. */
export function WishForm({ store, viewer }: PanelProps) {
  const id = useId();
  const isBusy = useStore(store, (state) => state.measuring !== null || state.scene === null);
  const { wish } = store.getState();
  const [kind, setKind] = useState<WishKind>(wish && 'maxFrameMs' in wish ? 'maxFrameMs' : 'minPsnrDb');
  const [amounts, setAmounts] = useState({ minPsnrDb: '45', maxFrameMs: '8', ...textsOf(wish) });
  const value = Number(amounts[kind]);
  const submit = (event: FormEvent) => {
    event.preventDefault();
    viewer.setWish(kind === 'minPsnrDb' ? { minPsnrDb: value } : { maxFrameMs: value });
  };
  return (
    <form className="wish" onSubmit={submit} aria-labelledby={`${id}-title`} data-testid="wish">
      <h3 id={`${id}-title`}>Choose settings for me</h3>
      <div className="wish-row">
        <select
          aria-label="Wish"
          value={kind}
          data-testid="wish-kind"
          onChange={({ target }) => setKind(target.value as WishKind)}
        >
          <option value="minPsnrDb">At least</option>
          <option value="maxFrameMs">At most</option>
        </select>
        <input
          type="number"
          aria-label={kind === 'minPsnrDb' ? 'Decibels of PSNR' : 'Milliseconds a frame'}
          min={kind === 'minPsnrDb' ? 1 : 0.1}
          step="any"
          required
          value={amounts[kind]}
          data-testid="wish-value"
          onChange={({ target }) => setAmounts({ ...amounts, [kind]: target.value })}
        />
        <span aria-hidden="true">{kind === 'minPsnrDb' ? 'dB' : 'ms'}</span>
        <button
          type="submit"
          className="text-button outlined"
          disabled={isBusy || !(value > 0)}
          data-testid="wish-submit"
        >
          Keep
        </button>
      </div>
      <p>
        Measures eight views around this one, and the worst counts; on a software adapter, this view alone.
        Scenes that you open later are measured as well.
      </p>
    </form>
  );
}
