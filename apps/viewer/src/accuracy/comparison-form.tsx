import { ACCURACY_PRESETS, type AccuracySettings } from '@websplatter/core';
import { type Choice, Choices } from '@websplatter/kit/choices';
import { useStore } from 'zustand';
import { compare } from '../engine/edit-picture.ts';
import type { PanelProps } from '../engine/viewer.ts';
import {
  type Comparison,
  type ComparisonSide,
  comparedWithReference,
  isSameAccuracy,
  PRESET_NAMES,
} from '../state/accuracy.ts';
import { describeAccuracy } from '../ui/accuracy-words.ts';

type Kind = Comparison['kind'] | 'none';

const KINDS: readonly Choice<Kind>[] = [
  ['none', 'Off'],
  ['split', 'Split picture'],
  ['error', 'Error map'],
];
const ABOUT: Readonly<Partial<Record<Kind, string>>> = {
  split: 'The same view twice. Drag the line between them, or move it by the arrow keys.',
  error:
    'How far each pixel is from reference, once the view rests. Reference itself has no error: choosing it shows the map of fast.',
};

/** Chooses the kind of comparison and its sides. */
export function ComparisonForm({ store, viewer }: PanelProps) {
  const comparison = useStore(store, (state) => state.comparison);
  const current: Kind = comparison?.kind ?? 'none';
  const choose = (kind: Kind) => {
    if (kind !== 'split') return compare({ store, viewer }, kind === 'none' ? null : { kind });
    const drawn = store.getState();
    const { accuracy } = comparedWithReference(drawn);
    // The default sides differ.
    const right = accuracy === drawn.accuracy ? ACCURACY_PRESETS.reference : accuracy;
    return compare({ store, viewer }, { kind, left: 'current', right });
  };
  return (
    <div className="comparison-form">
      <Choices label="What is shown" choices={KINDS} chosen={current} testId="compare-" onChoose={choose} />
      {ABOUT[current] && <p>{ABOUT[current]}</p>}
      {comparison?.kind === 'split' && (
        <>
          <SideSelect
            label="Left (A)"
            testId="side-left"
            side={comparison.left}
            store={store}
            onChange={(left) => compare({ store, viewer }, { ...comparison, left })}
          />
          <SideSelect
            label="Right (B)"
            testId="side-right"
            side={comparison.right}
            store={store}
            onChange={(right) => compare({ store, viewer }, { ...comparison, right })}
          />
        </>
      )}
    </div>
  );
}

function SideSelect({
  label,
  testId,
  side,
  store,
  onChange,
}: {
  label: string;
  testId: string;
  side: ComparisonSide;
  store: PanelProps['store'];
  onChange: (side: ComparisonSide) => void;
}) {
  const accuracy = useStore(store, (state) => state.accuracy);
  const shown = side === 'current' ? accuracy : side;
  const presets = PRESET_NAMES.map((name) => ACCURACY_PRESETS[name]);
  const others = [shown, accuracy].filter((each) => !presets.some((preset) => isSameAccuracy(preset, each)));
  const kept = uniqueByWords([...presets, ...others]);
  return (
    <label className="side">
      <span>{label}</span>
      <select
        data-testid={testId}
        value={side === 'current' ? 'current' : describeAccuracy(side)}
        onChange={({ target }) => onChange(kept.get(target.value) ?? 'current')}
      >
        <option value="current">Chosen above ({describeAccuracy(accuracy)})</option>
        {[...kept.keys()].map((words) => (
          <option key={words} value={words}>
            {words}
          </option>
        ))}
      </select>
    </label>
  );
}

function uniqueByWords(all: readonly AccuracySettings[]): ReadonlyMap<string, AccuracySettings> {
  return new Map(all.map((each) => [describeAccuracy(each), each]));
}
