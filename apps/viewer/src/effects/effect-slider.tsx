import { useEffect, useId, useRef } from 'react';
import type { ChosenEffect, EffectChoice } from '../state/effect-choices.ts';
import type { PanelProps } from '../viewer/panel-props.ts';
import { changeEffect } from './choose-effects.ts';
import { type EffectSlider, formatSlider } from './effect-sliders.ts';

/** A number of an effect. It follows the store by itself: React does not render while it is dragged or played. */
export function EffectSliderRow<Name extends ChosenEffect>({
  store,
  viewer,
  name,
  slider,
}: PanelProps & { readonly name: Name; readonly slider: EffectSlider<EffectChoice<Name>> }) {
  const id = useId();
  const input = useRef<HTMLInputElement>(null);
  const output = useRef<HTMLOutputElement>(null);
  useEffect(() => {
    const write = () => {
      const choice = store.getState().requested.choices[name]?.choice;
      if (!choice || !input.current || !output.current) return;
      const value = slider.read(choice as EffectChoice<Name>);
      const text = formatSlider(slider, value);
      input.current.value = String(Math.min(value, slider.max));
      input.current.setAttribute('aria-valuetext', withUnit(slider, text));
      output.current.textContent = text;
    };
    write();
    return store.subscribe((state, before) => {
      if (state.requested.choices !== before.requested.choices) write();
    });
  }, [store, name, slider]);
  return (
    <div className="request-row">
      <label htmlFor={id}>{slider.label}</label>
      <span className="setting-range">
        <input
          ref={input}
          id={id}
          type="range"
          min={slider.min}
          max={slider.max}
          step={slider.step}
          data-testid={`${name}-${slider.name}`}
          onChange={({ target }) =>
            changeEffect({ store, viewer }, name, (choice) => slider.write(choice, target.valueAsNumber))
          }
        />
        <output ref={output} htmlFor={id} />
      </span>
    </div>
  );
}

function withUnit({ unit }: Pick<EffectSlider<unknown>, 'unit'>, text: string): string {
  return unit === 'units' || unit === 'per unit' || unit === 'stops' ? `${text} ${unit}` : text;
}
