import type { EffectEntry } from '@websplatter/core';
import { memo, useId } from 'react';
import { useStore } from 'zustand';
import { Dock } from './dock.tsx';
import { formatBytes, formatCount } from './format.ts';
import type { ViewerStore } from './store.ts';

/** Which effects there are in the picture and which are not, why, and what they hold. */
export const EffectsPanel = memo(function EffectsPanel({ store }: { store: ViewerStore }) {
  const isVisible = useStore(store, (state) => state.dock === 'effects');
  const effects = useStore(store, (state) => state.effects);
  if (!isVisible) return null;
  return (
    <Dock store={store} name="effects" title="Effects">
      <section
        className="dock-body"
        aria-label="Effects of this picture"
        // biome-ignore lint/a11y/noNoninteractiveTabindex: it scrolls, so keys must reach it.
        tabIndex={0}
      >
        <EffectList title="In this picture" entries={effects.filter(({ isOn }) => isOn)} />
        <EffectList title="Not called for" entries={effects.filter(({ isOn }) => !isOn)} />
      </section>
    </Dock>
  );
});

function EffectList({ title, entries }: { title: string; entries: readonly EffectEntry[] }) {
  const id = useId();
  return (
    <>
      <h3 id={id}>
        {title} <small>{formatCount(entries.length)}</small>
      </h3>
      <ul aria-labelledby={id}>
        {entries.map((entry) => (
          <li key={entry.name}>
            <Effect entry={entry} />
          </li>
        ))}
      </ul>
    </>
  );
}

/** Why and how much; what it does, on demand. */
function Effect({ entry }: { entry: EffectEntry }) {
  const { name, label, about, isOn, reason, clouds, stages, bytes } = entry;
  return (
    <details className="effect" data-testid={`effect-${name}`} data-on={isOn}>
      <summary>
        <span className="effect-label">{label}</span>
        {bytes > 0 && <span className="effect-figures">{formatBytes(bytes)}</span>}
        <span className="effect-reason">{reason}</span>
      </summary>
      <p>{about}</p>
      {clouds.length > 0 && <p>For {clouds.join(', ')}.</p>}
      {isOn && <p>{stages.length > 0 ? `Acts in ${stages.join(', ')}.` : 'Acts in no shader.'}</p>}
    </details>
  );
}
