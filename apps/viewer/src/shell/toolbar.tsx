import { type KeyboardEvent, useRef, useState } from 'react';
import { useStore } from 'zustand';
import type { ViewerStore } from '../state/store.ts';
import { Icon } from '../ui/icon.tsx';
import { COMMANDS, type CommandName, type RunCommand } from './commands.ts';

const BUTTONS = COMMANDS.filter(({ isInPanel }) => !isInPanel);

/** The Tab key stops at one button only; arrow keys go to the others. */
export function Toolbar({ store, run }: { store: ViewerStore; run: RunCommand }) {
  const isFlipped = useStore(store, (state) => state.isFlipped);
  // A scene with z up is upright as it is.
  const isUpsideDown = useStore(store, (state) => !state.isZUp && (state.scene?.isUpsideDown ?? false));
  const isHudVisible = useStore(store, (state) => state.isHudVisible);
  const dock = useStore(store, (state) => state.dock);
  const hasScene = useStore(store, (state) => state.scene !== null);
  const canFlip = useStore(store, (state) => state.scene?.canFlip ?? false);
  const [stop, setStop] = useState<CommandName>(COMMANDS[0].name);
  const root = useRef<HTMLDivElement>(null);
  const pressed: Partial<Record<CommandName, boolean>> = {
    // A file that comes upside down is shown upright: that alone is no choice of anybody.
    flip: isFlipped !== isUpsideDown,
    hud: isHudVisible,
    clouds: dock === 'clouds',
    view: dock === 'view',
    inspect: dock === 'inspect',
    accuracy: dock === 'accuracy',
    effects: dock === 'effects',
    save: dock === 'save',
  };
  const disabled: Partial<Record<CommandName, boolean>> = {
    flip: !canFlip,
    reset: !hasScene,
    frame: !hasScene,
    inspect: !hasScene,
    save: !hasScene,
    clouds: !hasScene,
  };
  const tabStop = disabled[stop] ? COMMANDS[0].name : stop;
  const onKeyDown = (event: KeyboardEvent) => {
    const buttons = [...(root.current?.querySelectorAll<HTMLElement>('button:not(:disabled)') ?? [])];
    const at = buttons.indexOf(event.target as HTMLElement);
    const goal = { ArrowRight: at + 1, ArrowLeft: at - 1, Home: 0, End: -1 }[event.key];
    if (at < 0 || goal === undefined) return;
    event.preventDefault();
    buttons.at(goal % buttons.length)?.focus();
  };
  return (
    <nav className="toolbar-area" aria-label="Viewer">
      <div
        ref={root}
        className="panel toolbar"
        role="toolbar"
        aria-label="Viewer"
        data-testid="toolbar"
        onKeyDown={onKeyDown}
      >
        {BUTTONS.map(({ name, label, key }) => (
          <button
            key={name}
            type="button"
            className={name === 'open' ? 'text-button open' : 'icon-button'}
            aria-label={label}
            aria-keyshortcuts={key.toUpperCase()}
            aria-pressed={pressed[name]}
            title={`${label} (${key.toUpperCase()})`}
            tabIndex={name === tabStop ? 0 : -1}
            data-testid={`command-${name}`}
            disabled={disabled[name]}
            onFocus={() => setStop(name)}
            onClick={() => run(name)}
          >
            <Icon name={name} />
            {name === 'open' && <span aria-hidden="true">Open</span>}
          </button>
        ))}
      </div>
    </nav>
  );
}
