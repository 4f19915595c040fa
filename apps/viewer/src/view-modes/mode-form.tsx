import { useStore } from 'zustand';
import type { ViewerStore } from '../state/store.ts';
import { Choices } from '../ui/choices.tsx';
import { VIEW_MODES, viewModeOf } from './view-modes.ts';

/** Choice of the picture's content. */
export function ModeForm({ store }: { store: ViewerStore }) {
  const viewMode = useStore(store, (state) => state.viewMode);
  return (
    <fieldset className="view-field">
      <legend>
        View mode <kbd>M</kbd>
      </legend>
      <Choices
        isChips
        choices={VIEW_MODES.map(({ name, label }) => [name, label])}
        chosen={viewMode}
        testId="mode-"
        titleOf={(name) => viewModeOf(name).about}
        onChoose={(name) => store.setState({ viewMode: name })}
      />
    </fieldset>
  );
}
