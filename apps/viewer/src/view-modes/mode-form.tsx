import { useStore } from 'zustand';
import type { ViewerStore } from '../state/store.ts';
import { VIEW_MODES } from './view-modes.ts';

/** Choice of the picture's content. */
export function ModeForm({ store }: { store: ViewerStore }) {
  const viewMode = useStore(store, (state) => state.viewMode);
  return (
    <fieldset className="view-field">
      <legend>
        View mode <kbd>M</kbd>
      </legend>
      <div className="mode-choices">
        {VIEW_MODES.map(({ name, label, about }) => (
          <button
            key={name}
            type="button"
            className="chip"
            aria-pressed={name === viewMode}
            title={about}
            data-testid={`mode-${name}`}
            onClick={() => store.setState({ viewMode: name })}
          >
            {label}
          </button>
        ))}
      </div>
    </fieldset>
  );
}
