import { ACCURACY_PRESETS } from '@websplatter/core';
import { useStore } from 'zustand';
import { nearestPreset, PRESET_NAMES } from '../formatting/accuracy-words.ts';
import { Choices } from '../ui/choices.tsx';
import type { PanelProps } from '../viewer/panel-props.ts';

/** The presets as buttons. */
export function AccuracyPresets({ store, viewer }: PanelProps) {
  const accuracy = useStore(store, (state) => state.accuracy);
  const target = useStore(store, (state) => state.target);
  const { preset, changed } = nearestPreset(accuracy);
  // Under a target no preset was chosen, even if the chosen settings equal one.
  const chosen = target === null && changed.length === 0 ? preset : null;
  return (
    <div className="accuracy-presets">
      <Choices
        label="Presets"
        isChips
        choices={PRESET_NAMES.map((name) => [name, name])}
        chosen={chosen}
        testId="preset-"
        onChoose={(name) => viewer.setAccuracy(ACCURACY_PRESETS[name])}
      />
    </div>
  );
}
