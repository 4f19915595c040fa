import type { EffectEntry } from '@websplatter/core';
import type { EffectCost } from '@websplatter/core/measure';
import { formatBytes, formatCount } from '@websplatter/kit/format';
import { memo, useId } from 'react';
import { useStore } from 'zustand';
import type { RestMeasurement } from '../accuracy/measure-at-rest.ts';
import { MeasureButton, timingCautions } from '../accuracy/measure-button.tsx';
import type { PanelProps } from '../engine/viewer.ts';
import type { MeasuredEffects } from '../state/measured.ts';
import type { ViewerState, ViewerStore } from '../state/store.ts';
import { Dock } from '../ui/dock.tsx';
import { describeCost, formatCost, measureEffectCosts, measureSwitchedOn } from './effect-costs.ts';
import { RequestedEffectsForm } from './requested-effects-form.tsx';

interface EffectsProps extends PanelProps {
  readonly measurement: RestMeasurement;
}

/** Requests effects, and lists all effects with state, reason, memory and cost. */
export const EffectsPanel = memo(function EffectsPanel({ store, viewer, measurement }: EffectsProps) {
  const effects = useStore(store, (state) => state.effects);
  const measured = useStore(store, (state) => state.effectCosts);
  const isStale = useStore(store, areCostsStale);
  const hasSeveralClouds = useStore(store, (state) => (state.scene?.clouds ?? 0) > 1);
  const on = effects.filter(({ isOn }) => isOn);
  const off = effects.filter(({ isOn }) => !isOn);
  const listed = { costs: measured?.costs ?? [], hasSeveralClouds };
  return (
    <Dock store={store} name="effects">
      <section
        className="dock-body"
        aria-label="Effects of this frame"
        // biome-ignore lint/a11y/noNoninteractiveTabindex: it scrolls, so keys must reach it.
        tabIndex={0}
      >
        {effects.length > 0 && (
          <p className="verdict" data-testid="effects-verdict">
            {formatCount(on.length)} of {formatCount(effects.length)} effects are in this frame. The other{' '}
            {formatCount(off.length)} cost nothing.
          </p>
        )}
        <RequestedEffectsForm
          store={store}
          viewer={viewer}
          costs={listed.costs}
          isStale={isStale}
          onSwitchedOn={(name) => measureSwitchedOn(store, measurement, name)}
        />
        <EffectList title="In this frame" entries={on} {...listed} />
        <MeasureButton
          store={store}
          of="effects"
          label={measured ? 'Measure again' : 'Measure costs'}
          about={measured ? null : 'Draws this view with and without each effect, in turn.'}
          onStart={() => void measureEffectCosts(store, measurement)}
          onCancel={() => measurement.stop()}
        />
        {measured && <Cautions store={store} measured={measured} isStale={isStale} />}
        <EffectList title="Not in this frame" entries={off} {...listed} />
      </section>
    </Dock>
  );
});

/** Whether the costs were measured for another picture than the current one. */
function areCostsStale({ effectCosts, imageId, accuracy }: ViewerState): boolean {
  return effectCosts !== null && (effectCosts.imageId !== imageId || effectCosts.accuracy !== accuracy);
}

function Cautions({
  store,
  measured: { isSoftware },
  isStale,
}: {
  store: ViewerStore;
  measured: MeasuredEffects;
  isStale: boolean;
}) {
  const source = useStore(store, (state) => state.statistics?.timing.source ?? 'gpu-timestamps');
  return (
    <div className="circumstances" data-testid="effect-cautions" data-stale={isStale}>
      {isStale && (
        <p className="stale">Measured for another view, size, accuracy, detail or choice of effects.</p>
      )}
      {timingCautions(isSoftware, source).map((caution) => (
        <p key={caution}>{caution}</p>
      ))}
    </div>
  );
}

interface ListedProps {
  readonly costs: readonly EffectCost[];
  /** Whether each effect must name the clouds that it is on for. */
  readonly hasSeveralClouds: boolean;
}

function EffectList({
  title,
  entries,
  ...listed
}: ListedProps & { readonly title: string; readonly entries: readonly EffectEntry[] }) {
  const id = useId();
  const reasons = [...new Set(entries.map(({ reason }) => reason))];
  return (
    <>
      <h3 id={id} className="spread">
        {title} <small>{formatCount(entries.length)}</small>
      </h3>
      <ul aria-labelledby={id}>
        {reasons.map((reason) => {
          const group = entries.filter((entry) => entry.reason === reason);
          return group.length > 1 ? (
            <li key={reason} className="effect-group">
              <p className="effect-reason">{reason}</p>
              <ul>
                {group.map((entry) => (
                  <li key={entry.name}>
                    <Effect entry={entry} {...listed} />
                  </li>
                ))}
              </ul>
            </li>
          ) : (
            <li key={reason}>
              <Effect entry={group[0]} {...listed} hasOwnReason />
            </li>
          );
        })}
      </ul>
    </>
  );
}

/** An effect's cost, and its reason if effects differ in it; its description on demand. */
function Effect({
  entry,
  costs,
  hasSeveralClouds,
  hasOwnReason = false,
}: ListedProps & { readonly entry: EffectEntry; readonly hasOwnReason?: boolean }) {
  const { name, label, about, isOn, reason, clouds, stages, bytes } = entry;
  const cost = costs.find((each) => each.name === name);
  const figures = [...(cost ? [formatCost(cost.costMs)] : []), ...(bytes > 0 ? [formatBytes(bytes)] : [])];
  return (
    <details className="effect" data-testid={`effect-${name}`} data-on={isOn}>
      <summary>
        <span className="effect-label">{label}</span>
        <span className="effect-figures">{figures.join(' · ')}</span>
        {hasOwnReason && <span className="effect-reason">{reason}</span>}
      </summary>
      <p>{about}</p>
      {cost && <p>{describeCost(cost.costMs)}</p>}
      {hasSeveralClouds && clouds.length > 0 && <p>For {clouds.join(', ')}.</p>}
      {isOn && <p>{stages.length > 0 ? `Acts in ${stages.join(', ')}.` : 'Acts in no shader.'}</p>}
    </details>
  );
}
