import {
  ACCURACY_PRESETS,
  ACCURACY_SETTINGS,
  type AccuracySetting,
  type AccuracySettings,
  type AccuracyWish,
} from '@websplatter/core';
import { useId } from 'react';
import { useStore } from 'zustand';
import type { ViewerStore } from '../state/store.ts';
import type { Viewer } from '../viewer/viewer.ts';
import {
  describeAccuracy,
  describeWish,
  formatValue,
  nearestPreset,
  PRESET_NAMES,
  positionOf,
  SETTING_NAMES,
  type SettingName,
  type SettingValue,
  SLIDER_STEPS,
  valueAt,
} from '../words/accuracy-text.ts';

export interface AccuracyProps {
  readonly store: ViewerStore;
  readonly viewer: Viewer;
}

/** The presets as buttons, and in words what is shown and kept. */
export function AccuracyPresets({ store, viewer }: AccuracyProps) {
  const accuracy = useStore(store, (state) => state.accuracy);
  const wish = useStore(store, (state) => state.wish);
  const choice = useStore(store, (state) => state.choice);
  const notices = useStore(store, (state) => state.accuracyNotices);
  const { preset, changed } = nearestPreset(accuracy);
  // Under a wish no preset was chosen, though what was chosen may be one.
  const chosen = wish === null && changed.length === 0 ? preset : null;
  return (
    <div className="accuracy-presets">
      <fieldset className="chips" aria-label="Presets">
        {PRESET_NAMES.map((name) => (
          <button
            key={name}
            type="button"
            className="chip"
            aria-pressed={name === chosen}
            data-testid={`preset-${name}`}
            onClick={() => viewer.setAccuracy(ACCURACY_PRESETS[name])}
          >
            {name}
          </button>
        ))}
      </fieldset>
      {wish && <KeptWish store={store} viewer={viewer} wish={wish} />}
      {(wish || changed.length > 0) && (
        <p className="accuracy-custom" data-testid="accuracy-custom">
          {wish && 'Drawn with '}
          {describeAccuracy(accuracy)}
          {wish && !choice && ' until this scene is measured'}
        </p>
      )}
      {notices.map((notice) => (
        <p key={notice} className="accuracy-notice">
          {notice}
        </p>
      ))}
    </div>
  );
}

/** What is kept in every scene, and the button that ends it. */
function KeptWish({ store, viewer, wish }: AccuracyProps & { readonly wish: AccuracyWish }) {
  return (
    <p className="kept-wish" data-testid="kept-wish">
      <span role="status">
        Keeps: <b>{describeWish(wish)}</b>
      </span>
      <button
        type="button"
        className="text-button"
        title="Goes on with the settings that are drawn now"
        data-testid="end-wish"
        onClick={() => viewer.setAccuracy(store.getState().accuracy)}
      >
        End
      </button>
    </p>
  );
}

/** Every setting with what it does. */
export function AccuracySettingsForm({ store, viewer }: AccuracyProps) {
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
      <label htmlFor={id}>{label}</label>
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
              {unit === 'bits' ? `${each} bits` : each}
            </option>
          ))}
        </select>
      )}
      <p id={`${id}-about`}>{about}</p>
    </div>
  );
}
