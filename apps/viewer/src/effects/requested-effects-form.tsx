import type { EffectEntry } from '@websplatter/core';
import {
  EFFECT_OPTIONS,
  type EffectOption,
  type OptionValue,
  type OptionValues,
} from '@websplatter/core/effect-options';
import type { EffectCost } from '@websplatter/core/measure';
import { Choices } from '@websplatter/kit/choices';
import { TextButton } from '@websplatter/kit/controls';
import { type ComponentType, useEffect, useId, useMemo, useRef, useSyncExternalStore } from 'react';
import { useStore } from 'zustand';
import { scenePlaceOf } from '../engine/show/scene-place.ts';
import type { PanelProps } from '../engine/viewer.ts';
import { optionsBeside } from '../state/effect-values.ts';
import { NO_CHOICES } from '../state/effects.ts';
import { useGesture } from '../ui/use-gesture.ts';
import { changeEffect, resetEffect, resetEffects, switchEffect } from './choose-effects.ts';
import { formatCost } from './effect-costs.ts';
import { type EffectSlider, formatSlider, slidersOf } from './effect-sliders.ts';

/** Duration from nothing to the whole scene. */
const REVEAL_MS = 3000;

type RequestFrame = (step: (nowMs: number) => void) => void;

/**
 * Animates the scene's appearance from nothing. Ends when the whole scene is visible, when
 * `isRevealPlaying` becomes false, or when the effect is changed otherwise.
 */
export function playReveal(panel: PanelProps, requestFrame: RequestFrame = requestAnimationFrame): void {
  const { store, viewer } = panel;
  const chosen = () => store.getState().requested.choices.reveal;
  const place = scenePlaceOf(viewer);
  const gesture = {};
  let beganMs: number | null = null;
  let last = chosen();
  const step = (nowMs: number) => {
    const isOurs = last?.isOn && chosen() === last;
    if (!isOurs || !store.getState().isRevealPlaying) {
      store.setState({ isRevealPlaying: false });
      return;
    }
    beganMs ??= nowMs;
    const part = (nowMs - beganMs) / REVEAL_MS;
    const grown = (values: OptionValues) => {
      const radius = slidersOf('reveal', values, place).find(({ name }) => name === 'radius');
      // At the end everything is visible.
      return radius?.write(values, Math.min(part, 1) * radius.max) ?? values;
    };
    changeEffect(panel, 'reveal', grown, gesture);
    last = chosen();
    if (part < 1) requestFrame(step);
    else store.setState({ isRevealPlaying: false });
  };
  store.setState({ isRevealPlaying: true });
  requestFrame(step);
}

interface CostsProps {
  readonly costs: readonly EffectCost[];
  /** Whether the costs were measured for another picture. */
  readonly isStale: boolean;
}

interface RequestsProps extends PanelProps, CostsProps {
  /** Called when an effect was switched on, before its first frame. */
  readonly onSwitchedOn: (name: string) => void;
}

/** Switches and sliders for the effects that users can request, each with its measured cost. */
export function RequestedEffectsForm({ store, viewer, ...others }: RequestsProps) {
  const isTouched = useStore(store, ({ requested }) => requested.choices !== NO_CHOICES);
  const hasScene = useStore(store, ({ scene }) => scene !== null);
  const highlight = useStore(store, ({ effects }) => effects.find(({ name }) => name === 'highlight'));
  return (
    <>
      <div className="spread requests-title">
        <h3>Change the picture</h3>
        <TextButton
          look="plain"
          disabled={!isTouched}
          testId="reset-effects"
          onClick={() => resetEffects({ store, viewer })}
        >
          Reset all
        </TextButton>
      </div>
      <fieldset className="requests" disabled={!hasScene} aria-label="Change the picture">
        {Object.keys(EFFECT_OPTIONS).map((name) => (
          <Request key={name} store={store} viewer={viewer} name={name} {...others} />
        ))}
        <HighlightRow entry={highlight} />
      </fieldset>
    </>
  );
}

/** The switch of one effect and, while it is on, its options. */
function Request({ store, viewer, name, onSwitchedOn, ...costs }: RequestsProps & { name: string }) {
  const id = useId();
  const isOn = useStore(store, ({ requested }) => requested.choices[name]?.isOn ?? false);
  const { label, about } = EFFECT_OPTIONS[name].effect;
  const panel = { store, viewer };
  return (
    <div className="request" data-testid={`request-${name}`}>
      <div className="spread request-head">
        <Switch
          effect={EFFECT_OPTIONS[name].effect}
          isOn={isOn}
          aboutId={`${id}-about`}
          onSwitch={(isWanted) => {
            switchEffect(panel, name, isWanted);
            if (isWanted) onSwitchedOn(name);
          }}
        />
        {isOn && <Cost name={name} {...costs} />}
      </div>
      <p id={`${id}-about`} className="request-about">
        {about}
      </p>
      {isOn && (
        <div className="request-body">
          <Options {...panel} name={name} />
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

/** Disabled if `onSwitch` is missing. */
function Switch({
  effect: { name, label },
  isOn,
  aboutId,
  onSwitch,
}: {
  effect: { readonly name: string; readonly label: string };
  isOn: boolean;
  aboutId: string;
  onSwitch?: (isOn: boolean) => void;
}) {
  return (
    <label className="switch">
      <input
        type="checkbox"
        role="switch"
        disabled={!onSwitch}
        checked={isOn}
        aria-checked={isOn}
        aria-describedby={aboutId}
        data-testid={`switch-${name}`}
        onChange={({ target }) => onSwitch?.(target.checked)}
      />
      <span>{label}</span>
      {name !== label.toLowerCase() && <code>{name}</code>}
    </label>
  );
}

/** Measured cost of an effect; empty if there is none. */
function Cost({ name, costs, isStale }: CostsProps & { name: string }) {
  const cost = costs.find((each) => each.name === name);
  return (
    <span
      className="effect-figures"
      data-testid={`cost-${name}`}
      data-stale={isStale}
      title={isStale ? 'Measured for another view, size, accuracy, detail or choice of effects' : undefined}
    >
      {cost ? formatCost(cost.costMs) : 'cost not measured'}
      {cost && isStale && ' before'}
    </span>
  );
}

/** Controls for all options of an effect. */
function Options({ store, viewer, name }: PanelProps & { name: string }) {
  const panel = { store, viewer };
  // Numbers are subscribed to by their sliders.
  const words = useStore(store, ({ requested }) => wordsAmong(requested.choices[name]?.values));
  const scene = useStore(store, (state) => state.scene);
  const isFlipped = useStore(store, (state) => state.isFlipped);
  // biome-ignore lint/correctness/useExhaustiveDependencies: the results follow from them.
  const [values, sliders] = useMemo(() => {
    const chosen = store.getState().requested.choices[name]?.values ?? {};
    return [chosen, slidersOf(name, chosen, scenePlaceOf(viewer))] as const;
  }, [store, viewer, name, words, scene, isFlipped]);
  const options = optionsBeside(name, values);
  const Extra = EXTRAS[name];
  return (
    <>
      {options.map(([key, option]) => (
        <OptionRow
          key={key}
          testId={`${name}-${key}`}
          option={option}
          values={values}
          value={values[key]}
          onChoose={(value, gesture) =>
            changeEffect(panel, name, (before) => ({ ...before, [key]: value }), gesture)
          }
          viewer={viewer}
        />
      ))}
      {Extra && <Extra {...panel} />}
      {sliders.map((slider) => (
        <EffectSliderRow key={slider.name} store={store} viewer={viewer} name={name} slider={slider} />
      ))}
    </>
  );
}

/** Key of the words and colours among `values`: it changes when one of them does. */
function wordsAmong(values: OptionValues = {}): string {
  return Object.values(values)
    .filter((value) => typeof value === 'string')
    .join(' ');
}

interface OptionRowProps extends Pick<PanelProps, 'viewer'> {
  readonly testId: string;
  readonly option: EffectOption;
  readonly values: OptionValues;
  readonly value: OptionValue;
  readonly onChoose: (value: OptionValue, gesture?: object) => void;
}

/** A control for an option that is not a number with a slider. */
function OptionRow({ testId, option, values, value, onChoose, viewer }: OptionRowProps) {
  const id = useId();
  const { gesture, begins } = useGesture();
  const { kind, label, note } = option;
  if (kind === 'color')
    return (
      <div className="request-row">
        <label htmlFor={id}>{label}</label>
        <input
          {...begins}
          id={id}
          type="color"
          value={String(value)}
          data-testid={testId}
          onChange={({ target }) => onChoose(target.value, gesture.current)}
        />
      </div>
    );
  if (kind !== 'choice' && kind !== 'origin') return null;
  const choices = kind === 'origin' ? ORIGINS : option.choices(values);
  const chosen = typeof value === 'string' ? value : 'middle';
  return (
    <>
      <Choices
        label={label}
        choices={Object.entries(choices)}
        chosen={chosen}
        testId={`${testId}-`}
        onChoose={(word) =>
          onChoose(kind === 'origin' && word === 'middle' ? scenePlaceOf(viewer).center : word)
        }
      />
      {note && <p>{note}</p>}
    </>
  );
}

const ORIGINS = { middle: 'From the middle', camera: 'From the camera' };

/** Additional controls, by effect. */
const EXTRAS: Readonly<Record<string, ComponentType<PanelProps> | undefined>> = {
  volumes: () => <p>Drag the handle in the picture to move the shape, or use the arrow keys.</p>,
  reveal: RevealPlayer,
};

function RevealPlayer(panel: PanelProps) {
  const { store } = panel;
  const isPlaying = useStore(store, (state) => state.isRevealPlaying);
  const isMotionReduced = useReducedMotion();
  return (
    <>
      <TextButton
        disabled={isMotionReduced && !isPlaying}
        testId="play-reveal"
        onClick={() => (isPlaying ? store.setState({ isRevealPlaying: false }) : playReveal(panel))}
      >
        {isPlaying ? 'Stop' : 'Play'}
      </TextButton>
      {isMotionReduced && (
        <p>Your system asks for less motion, so this does not play. Move the slider instead.</p>
      )}
    </>
  );
}

/** Shows whether there is a selection, which is made in another panel. */
function HighlightRow({ entry }: { entry: EffectEntry | undefined }) {
  const id = useId();
  if (!entry) return null;
  return (
    <div className="request" data-testid="request-highlight">
      <div className="spread request-head">
        <Switch effect={entry} isOn={entry.isOn} aboutId={id} />
      </div>
      <p id={id} className="request-about">
        {entry.isOn ? `${entry.about} It is on: ${entry.reason}.` : 'Not available: no splats are selected.'}
      </p>
    </div>
  );
}

const reducedMotion = () => matchMedia('(prefers-reduced-motion: reduce)');

/** Whether the system requests reduced motion. */
function useReducedMotion(): boolean {
  return useSyncExternalStore(
    (onChange) => {
      const query = reducedMotion();
      query.addEventListener('change', onChange);
      return () => query.removeEventListener('change', onChange);
    },
    () => reducedMotion().matches,
  );
}

/**
 * A slider for a number of an effect. Follows the store without a React render, also during drags
 * and animations.
 */
function EffectSliderRow({
  store,
  viewer,
  name,
  slider,
}: PanelProps & { readonly name: string; readonly slider: EffectSlider }) {
  const id = useId();
  const { gesture, begins } = useGesture();
  const input = useRef<HTMLInputElement>(null);
  const output = useRef<HTMLOutputElement>(null);
  useEffect(() => {
    const write = () => {
      const values = store.getState().requested.choices[name]?.values;
      if (!values || !input.current || !output.current) return;
      const value = slider.read(values);
      const text = formatSlider(slider, value);
      input.current.value = String(Math.min(value, slider.max));
      input.current.setAttribute('aria-valuetext', withUnit(slider, text));
      output.current.textContent = text;
    };
    write();
    return store.subscribe(({ requested }) => requested.choices, write);
  }, [store, name, slider]);
  return (
    <div className="request-row">
      <label htmlFor={id}>{slider.label}</label>
      <span className="setting-range">
        <input
          {...begins}
          ref={input}
          id={id}
          type="range"
          min={slider.min}
          max={slider.max}
          step={slider.step}
          data-testid={`${name}-${slider.name}`}
          onChange={({ target: { valueAsNumber } }) => {
            const write = (values: OptionValues) => slider.write(values, valueAsNumber);
            changeEffect({ store, viewer }, name, write, gesture.current);
          }}
        />
        <output ref={output} htmlFor={id} />
      </span>
    </div>
  );
}

function withUnit({ unit }: Pick<EffectSlider, 'unit'>, text: string): string {
  return unit === 'degrees' || unit === 'percent' ? text : `${text} ${unit}`;
}
