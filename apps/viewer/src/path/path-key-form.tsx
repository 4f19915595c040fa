import { type Choice, Choices } from '@websplatter/kit/choices';
import { TextButton } from '@websplatter/kit/controls';
import { useStore } from 'zustand';
import type { PanelProps } from '../engine/viewer.ts';
import { toNextMsOf } from '../navigate/saved-views.ts';
import { MAX_NAME_LENGTH } from '../navigate/saved-views-form.tsx';
import { LEAST_STEP_MS, type Passing, viewName } from '../state/saved-view.ts';
import { NumberField } from '../ui/number-field.tsx';
import type { PathViewsProps } from './path-timeline.tsx';

const PASSINGS: readonly Choice<Passing>[] = [
  ['through', 'Pass through'],
  ['stop', 'Stop'],
  ['cut', 'Hold, then cut'],
];

/** What can be done with the selected view of a path; without one, what to do first. */
export function PathKeyForm({
  store,
  views,
  selected,
  onSelect,
}: Pick<PanelProps, 'store'> & Omit<PathViewsProps, 'path'>) {
  const savedViews = useStore(store, (state) => state.savedViews);
  const turntable = useStore(store, (state) => state.path.turntable);
  const isLooped = useStore(store, (state) => state.path.isLooped);
  if (turntable)
    return (
      <div className="path-row path-form">
        <p>
          Once around what the view looks at.
          {savedViews.length > 0 && ' The saved views are kept: Turntable again shows their path.'}
        </p>
        <TextButton testId="turntable-here" onClick={() => views.setTurntable(turntable.durationMs)}>
          Start from this view
        </TextButton>
        <TextButton testId="keep-turntable" onClick={() => views.keepTurntable()}>
          Edit as views
        </TextButton>
      </div>
    );
  if (savedViews.length === 0) return null;
  const view = selected === null ? undefined : savedViews[selected];
  if (selected === null || !view)
    return (
      <div className="path-row path-form">
        <p data-testid="path-hint">
          {savedViews.length === 1
            ? 'Move the picture, then add the next view.'
            : 'Choose a view to change its time, how it is passed, or what it shows. Drag it to move it.'}
        </p>
      </div>
    );
  const isLast = selected === savedViews.length - 1;
  const shift = (by: 1 | -1) => {
    views.shift(selected, by);
    onSelect(selected + by);
  };
  return (
    <div className="path-row path-form" data-testid="path-key-form">
      <input
        type="text"
        value={view.name}
        placeholder={viewName({ name: '' }, selected)}
        maxLength={MAX_NAME_LENGTH}
        aria-label="Name of the view"
        data-testid="path-key-name"
        onChange={({ target }) => views.rename(view, target.value, target)}
      />
      {(!isLast || isLooped) && (
        <span className="path-group">
          {isLast ? 'To the first' : 'To the next'}
          <NumberField
            key={selected}
            label={isLast ? 'Seconds to the first view' : 'Seconds to the next view'}
            value={toNextMsOf(view) / 1000}
            step={0.5}
            min={LEAST_STEP_MS / 1000}
            testId="path-key-seconds"
            onChange={(seconds) =>
              views.setPassing(view, { toNextMs: 1000 * seconds }, `seconds ${selected}`)
            }
          />
          s
        </span>
      )}
      <Choices
        label="How the view is passed"
        isChips
        choices={PASSINGS}
        chosen={view.passing ?? 'through'}
        testId="passing-"
        onChoose={(passing) => views.setPassing(view, { passing })}
      />
      <TextButton testId="overwrite-view" onClick={() => void views.overwrite(view)}>
        Replace by this view
      </TextButton>
      <TextButton disabled={selected === 0} testId="view-earlier" onClick={() => shift(-1)}>
        Earlier
      </TextButton>
      <TextButton disabled={isLast} testId="view-later" onClick={() => shift(1)}>
        Later
      </TextButton>
      <TextButton
        testId="remove-view"
        onClick={() => {
          views.remove(view);
          onSelect(null);
        }}
      >
        Remove
      </TextButton>
    </div>
  );
}
