import type { EffectEntry } from '@websplatter/core';
import type { EffectCost } from '@websplatter/core/measure';
import { type ReactNode, useId, useMemo } from 'react';
import { useStore } from 'zustand';
import { CHOSEN_EFFECTS, type ChosenEffect, NO_CHOICES } from '../state/effect-choices.ts';
import type { PanelProps } from '../viewer/panel-props.ts';
import { changeEffect, resetEffect, resetEffects, switchEffect } from './choose-effects.ts';
import { formatCost } from './effect-costs.ts';
import { EffectSliderRow } from './effect-slider.tsx';
import { slidersOf } from './effect-sliders.ts';
import { EFFECTS } from './effect-uses.ts';
import { playReveal } from './play-reveal.ts';
import { scenePlaceOf } from './scene-place.ts';
import { useReducedMotion } from './use-reduced-motion.ts';

interface CostsProps {
  readonly costs: readonly EffectCost[];
  /** Whether the costs are those of another picture. */
  readonly isStale: boolean;
}

/** Switches and sliders for the effects that can be asked for, each with its measured cost. */
export function RequestedEffectsForm({ store, viewer, ...costs }: PanelProps & CostsProps) {
  const isTouched = useStore(store, ({ requested }) => requested.choices !== NO_CHOICES);
  const hasScene = useStore(store, ({ scene }) => scene !== null);
  const highlight = useStore(store, ({ effects }) => effects.find(({ name }) => name === 'highlight'));
  return (
    <>
      <div className="requests-title">
        <h3>Change the picture</h3>
        <button
          type="button"
          className="text-button"
          disabled={!isTouched}
          data-testid="reset-effects"
          onClick={() => resetEffects({ store, viewer })}
        >
          Reset all
        </button>
      </div>
      <fieldset className="requests" disabled={!hasScene} aria-label="Effects to ask for">
        {CHOSEN_EFFECTS.map((name) => (
          <Request key={name} store={store} viewer={viewer} name={name} {...costs} />
        ))}
        <HighlightRow entry={highlight} />
      </fieldset>
    </>
  );
}

/** The switch of one effect and, while it is on, what can be chosen for it. */
function Request({ store, viewer, name, ...costs }: PanelProps & CostsProps & { name: ChosenEffect }) {
  const id = useId();
  const isOn = useStore(store, ({ requested }) => requested.choices[name]?.isOn ?? false);
  const { label, about } = EFFECTS[name].effect;
  const panel = { store, viewer };
  return (
    <div className="request" data-testid={`request-${name}`}>
      <div className="request-head">
        <label className="switch">
          <input
            type="checkbox"
            role="switch"
            checked={isOn}
            aria-checked={isOn}
            aria-describedby={`${id}-about`}
            data-testid={`switch-${name}`}
            onChange={({ target }) => switchEffect(panel, name, target.checked)}
          />
          <span>{label}</span>
          <code>{name}</code>
        </label>
        {isOn && <Cost name={name} {...costs} />}
      </div>
      <p id={`${id}-about`} className="request-about">
        {about}
      </p>
      {isOn && (
        <div className="request-body">
          <Choices {...panel} name={name} />
          <button
            type="button"
            className="text-button outlined request-reset"
            aria-label={`Reset ${label}`}
            data-testid={`reset-${name}`}
            onClick={() => resetEffect(panel, name)}
          >
            Reset
          </button>
        </div>
      )}
    </div>
  );
}

/** What an effect was measured to cost, if it was. */
function Cost({ name, costs, isStale }: CostsProps & { name: ChosenEffect }) {
  const cost = costs.find((each) => each.name === name);
  return (
    <span
      className="effect-figures"
      data-testid={`cost-${name}`}
      data-stale={isStale}
      title={isStale ? 'Of another view, size, accuracy or choice' : undefined}
    >
      {cost ? formatCost(cost.costMs) : 'cost not measured'}
      {cost && isStale && ' before'}
    </span>
  );
}

/** Everything of an effect that can be chosen. */
function Choices({ store, viewer, name }: PanelProps & { name: ChosenEffect }) {
  const panel = { store, viewer };
  return (
    <>
      {name === 'clip' && <ClipChoices {...panel} />}
      {name === 'reveal' && <RevealChoices {...panel} />}
      {name === 'antialias' && <AntialiasChoices {...panel} />}
      {name === 'fog' && <FogChoices {...panel} />}
      {(name === 'fog' || name === 'tint') && <ColorChoice {...panel} name={name} />}
      <Sliders {...panel} name={name} />
    </>
  );
}

/** What tells which sliders an effect has. */
function useKind({ store }: PanelProps, name: ChosenEffect): string {
  return useStore(store, ({ requested: { choices } }) => {
    if (name === 'clip') return choices.clip?.choice.shape ?? '';
    if (name === 'fog') return choices.fog?.choice.kind ?? '';
    return name === 'reveal' ? String(choices.reveal?.choice.from === 'camera') : '';
  });
}

function Sliders({ store, viewer, name }: PanelProps & { name: ChosenEffect }) {
  const kind = useKind({ store, viewer }, name);
  const scene = useStore(store, (state) => state.scene);
  const isFlipped = useStore(store, (state) => state.isFlipped);
  // biome-ignore lint/correctness/useExhaustiveDependencies: what the choice and the scene's place follow from.
  const sliders = useMemo(() => {
    const choice = store.getState().requested.choices[name]?.choice;
    return choice ? slidersOf(name, choice, scenePlaceOf(viewer)) : [];
  }, [store, viewer, name, kind, scene, isFlipped]);
  return sliders.map((slider) => (
    <EffectSliderRow key={slider.name} store={store} viewer={viewer} name={name} slider={slider} />
  ));
}

const SHAPES = [
  ['plane', 'Plane'],
  ['box', 'Box'],
  ['sphere', 'Sphere'],
] as const;

function ClipChoices(panel: PanelProps) {
  const shape = useStore(panel.store, ({ requested }) => requested.choices.clip?.choice.shape);
  const keep = useStore(panel.store, ({ requested }) => requested.choices.clip?.choice.keep);
  return (
    <>
      <Segments
        label="Shape of the clip"
        testId="clip-shape"
        choices={SHAPES}
        chosen={shape}
        onChoose={(each) => changeEffect(panel, 'clip', (choice) => ({ ...choice, shape: each }))}
      />
      <Segments
        label="Side that stays"
        testId="clip-keep"
        choices={[
          ['inside', shape === 'plane' ? 'Keep one side' : 'Keep inside'],
          ['outside', shape === 'plane' ? 'Keep the other' : 'Keep outside'],
        ]}
        chosen={keep}
        onChoose={(each) => changeEffect(panel, 'clip', (choice) => ({ ...choice, keep: each }))}
      />
      <p>The handle over the picture moves it, by pointer or by arrow keys.</p>
    </>
  );
}

const REVEAL_FROM = [
  ['middle', 'From the middle'],
  ['camera', 'From the camera'],
] as const;

function RevealChoices(panel: PanelProps) {
  const { store, viewer } = panel;
  const isFromCamera = useStore(store, ({ requested }) => requested.choices.reveal?.choice.from === 'camera');
  const isPlaying = useStore(store, (state) => state.isRevealPlaying);
  const isMotionReduced = useReducedMotion();
  return (
    <>
      <Segments
        label="Where it appears from"
        testId="reveal-from"
        choices={REVEAL_FROM}
        chosen={isFromCamera ? 'camera' : 'middle'}
        onChoose={(each) =>
          changeEffect(panel, 'reveal', (choice) => ({
            ...choice,
            from: each === 'camera' ? 'camera' : scenePlaceOf(viewer).center,
          }))
        }
      />
      <button
        type="button"
        className="text-button outlined"
        disabled={isMotionReduced && !isPlaying}
        data-testid="play-reveal"
        onClick={() => (isPlaying ? store.setState({ isRevealPlaying: false }) : playReveal(panel))}
      >
        {isPlaying ? 'Stop' : 'Play'}
      </button>
      {isMotionReduced && <p>This system asks for less motion: the slider shows each step.</p>}
    </>
  );
}

function AntialiasChoices(panel: PanelProps) {
  const isAntialiased = useStore(
    panel.store,
    ({ requested }) => requested.choices.antialias?.choice.isAntialiased,
  );
  return (
    <>
      <Segments
        label="Antialiasing, whatever the file says"
        testId="antialias"
        choices={[
          ['on', 'On'],
          ['off', 'Off'],
        ]}
        chosen={isAntialiased ? 'on' : 'off'}
        onChoose={(each) => changeEffect(panel, 'antialias', () => ({ isAntialiased: each === 'on' }))}
      />
      <p>Overrules what the file says of how it was trained.</p>
    </>
  );
}

const FOG_KINDS = [
  ['depths', 'Between depths'],
  ['density', 'By density'],
] as const;

function FogChoices(panel: PanelProps) {
  const kind = useStore(panel.store, ({ requested }) => requested.choices.fog?.choice.kind);
  return (
    <Segments
      label="Kind of fog"
      testId="fog-kind"
      choices={FOG_KINDS}
      chosen={kind}
      onChoose={(each) => changeEffect(panel, 'fog', (choice) => ({ ...choice, kind: each }))}
    />
  );
}

function ColorChoice({ store, viewer, name }: PanelProps & { name: 'fog' | 'tint' }) {
  const id = useId();
  const color = useStore(store, ({ requested }) => requested.choices[name]?.choice.color);
  return (
    <div className="request-row">
      <label htmlFor={id}>Colour</label>
      <input
        id={id}
        type="color"
        value={color ?? '#ffffff'}
        data-testid={`${name}-color`}
        onChange={({ target }) =>
          changeEffect({ store, viewer }, name, (choice) => ({
            ...choice,
            color: target.value as `#${string}`,
          }))
        }
      />
    </div>
  );
}

/** Selections are made elsewhere: here is said whether there is one. */
function HighlightRow({ entry }: { entry: EffectEntry | undefined }) {
  if (!entry) return null;
  return (
    <div className="request" data-testid="request-highlight">
      <div className="request-head">
        <label className="switch">
          <input
            type="checkbox"
            role="switch"
            disabled
            checked={entry.isOn}
            aria-checked={entry.isOn}
            readOnly
          />
          <span>{entry.label}</span>
          <code>{entry.name}</code>
        </label>
      </div>
      <p className="request-about">
        {entry.isOn ? `${entry.about} It is on: ${entry.reason}.` : 'Not available: no splats are selected.'}
      </p>
    </div>
  );
}

function Segments<Value extends string>({
  label,
  testId,
  choices,
  chosen,
  onChoose,
}: {
  label: string;
  testId: string;
  choices: readonly (readonly [Value, ReactNode])[];
  chosen: Value | undefined;
  onChoose: (value: Value) => void;
}) {
  return (
    <fieldset className="segments" aria-label={label}>
      {choices.map(([value, text]) => (
        <button
          key={value}
          type="button"
          aria-pressed={value === chosen}
          data-testid={`${testId}-${value}`}
          onClick={() => onChoose(value)}
        >
          {text}
        </button>
      ))}
    </fieldset>
  );
}
