import { ACCURACY_SETTINGS, type AccuracySetting, type AccuracySettings } from '@websplatter/core';
import { useId } from 'react';
import { useStore } from 'zustand';
import type { PanelProps } from '../engine/panel-props.ts';
import { SETTING_NAMES, type SettingName } from '../state/nearest-preset.ts';
import { formatValue, type SettingValue, valueWords } from '../ui/accuracy-words.ts';
import { positionOf, SLIDER_STEPS, valueAt } from './setting-slider.ts';

/** Every setting with its description. */
export function AccuracySettingsForm({ store, viewer }: PanelProps) {
  const accuracy = useStore(store, (state) => state.accuracy);
  return (
    <div className="settings">
      {SETTING_NAMES.map((name) => (
        <Setting
          key={name}
          name={name}
          value={accuracy[name]}
          onChange={(value) =>
            viewer.setAccuracy({ ...store.getState().accuracy, [name]: value } as AccuracySettings)
          }
        />
      ))}
    </div>
  );
}

function Setting({
  name,
  value,
  onChange,
}: {
  name: SettingName;
  value: SettingValue;
  onChange: (value: SettingValue) => void;
}) {
  const id = useId();
  const { label, about, unit, values }: AccuracySetting<unknown> = ACCURACY_SETTINGS[name];
  const range = 'min' in values ? values : null;
  const described = { id, 'aria-describedby': `${id}-about`, 'data-testid': `setting-${name}` };
  return (
    <div className="setting">
      <span className="setting-name">
        <label htmlFor={id}>{label}</label> <code>{name}</code>
      </span>
      {range ? (
        <span className="setting-range">
          <input
            {...described}
            type="range"
            min={0}
            max={SLIDER_STEPS}
            value={positionOf(Number(value), range)}
            aria-valuetext={`${formatValue(value)} ${unit}`}
            onChange={({ target }) => onChange(valueAt(Number(target.value), range) as SettingValue)}
          />
          <output htmlFor={id}>{formatValue(value)}</output>
        </span>
      ) : (
        <select
          {...described}
          value={String(value)}
          onChange={({ target }) => {
            const chosen = (values as readonly SettingValue[]).find((each) => String(each) === target.value);
            if (chosen !== undefined) onChange(chosen);
          }}
        >
          {(values as readonly SettingValue[]).map((each) => (
            <option key={each} value={String(each)}>
              {optionWords(name, each)}
            </option>
          ))}
        </select>
      )}
      <p id={`${id}-about`}>{about}</p>
    </div>
  );
}

/** `16-bit (f16)`: plain words, and the identifier where that is another. */
function optionWords(name: SettingName, value: SettingValue): string {
  const words = valueWords(name, value);
  const isSaid = words.replaceAll(' ', '-').includes(String(value));
  return isSaid ? words : `${words} (${value})`;
}
