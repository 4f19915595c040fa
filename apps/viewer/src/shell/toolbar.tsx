import { useStore } from 'zustand';
import type { ViewerStore } from '../state/store.ts';
import { Icon } from '../ui/icon.tsx';
import { COMMANDS, type CommandName, type RunCommand } from './commands.ts';

export function Toolbar({ store, run }: { store: ViewerStore; run: RunCommand }) {
  const isFlipped = useStore(store, (state) => state.isFlipped);
  const isHudVisible = useStore(store, (state) => state.isHudVisible);
  const dock = useStore(store, (state) => state.dock);
  const hasScene = useStore(store, (state) => state.scene !== null);
  const canFlip = useStore(store, (state) => state.scene?.canFlip ?? false);
  const canSave = useStore(store, (state) => state.scene?.canSave ?? false);
  const pressed: Partial<Record<CommandName, boolean>> = {
    flip: isFlipped,
    hud: isHudVisible,
    accuracy: dock === 'accuracy',
    effects: dock === 'effects',
    save: dock === 'save',
  };
  const disabled: Partial<Record<CommandName, boolean>> = {
    flip: !canFlip,
    reset: !hasScene,
    frame: !hasScene,
    save: !canSave,
  };
  return (
    <div className="panel toolbar" role="toolbar" aria-label="Viewer">
      {COMMANDS.map(({ name, label, key }) => (
        <button
          key={name}
          type="button"
          className={name === 'open' ? 'text-button open' : 'icon-button'}
          aria-label={label}
          aria-keyshortcuts={key.toUpperCase()}
          aria-pressed={pressed[name]}
          title={`${label} (${key.toUpperCase()})`}
          data-testid={`command-${name}`}
          disabled={disabled[name]}
          onClick={() => run(name)}
        >
          <Icon name={name} />
          {name === 'open' && <span aria-hidden="true">Open</span>}
        </button>
      ))}
    </div>
  );
}
