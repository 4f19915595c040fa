import { ACCURACY_PRESETS, type AccuracyWish } from '@websplatter/core';
import { useStore } from 'zustand';
import type { PanelProps } from '../viewer/panel-props.ts';
import { describeAccuracy, describeWish, nearestPreset, PRESET_NAMES } from '../words/accuracy-words.ts';

/** The presets as buttons; below them, in words, the settings that are drawn and the wish that is kept. */
export function AccuracyPresets({ store, viewer }: PanelProps) {
  const accuracy = useStore(store, (state) => state.accuracy);
  const wish = useStore(store, (state) => state.wish);
  const choice = useStore(store, (state) => state.choice);
  const notices = useStore(store, (state) => state.accuracyNotices);
  const { preset, changed } = nearestPreset(accuracy);
  // Under a wish no preset was chosen, even if the chosen settings equal one.
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

/** The wish that is kept in every scene, and the button that ends it. */
function KeptWish({ store, viewer, wish }: PanelProps & { readonly wish: AccuracyWish }) {
  return (
    <p className="kept-wish" data-testid="kept-wish">
      <span role="status">
        Keeps: <b>{describeWish(wish)}</b>
      </span>
      <button
        type="button"
        className="text-button"
        title="Keeps the settings that are drawn now"
        data-testid="end-wish"
        onClick={() => viewer.setAccuracy(store.getState().accuracy)}
      >
        End
      </button>
    </p>
  );
}
