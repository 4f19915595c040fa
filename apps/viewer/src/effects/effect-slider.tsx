import { useEffect, useId, useRef } from 'react';
import type { PanelProps } from '../engine/panel-props.ts';
import { changeEffect } from './choose-effects.ts';
import { type EffectSlider, formatSlider } from './effect-sliders.ts';

/** A number of an effect. It follows the store without React, also while dragged or played. */
export function EffectSliderRow({
  store,
  viewer,
  name,
  slider,
}: PanelProps & { readonly name: string; readonly slider: EffectSlider }) {
  const id = useId();
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
            changeEffect({ store, viewer }, name, (values) => slider.write(values, target.valueAsNumber))
          }
        />
        <output ref={output} htmlFor={id} />
      </span>
    </div>
  );
}

function withUnit({ unit }: Pick<EffectSlider, 'unit'>, text: string): string {
  return unit === 'degrees' ? text : `${text} ${unit}`;
}
