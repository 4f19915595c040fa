import { Icon, type IconName } from '@websplatter/kit/icon';
import { type KeyboardEvent, useRef, useState, useSyncExternalStore } from 'react';
import { useStore } from 'zustand';
import { useShallow } from 'zustand/react/shallow';
import {
  COMMANDS,
  type Command,
  type CommandName,
  commandState,
  isAvailable,
  type RunCommand,
} from '../state/command-list.ts';
import type { ViewerStore } from '../state/store.ts';
import { isUpsideDown } from '../state/up-axis.ts';
import { MenuButton } from '../ui/menu-button.tsx';

/** On narrower windows, the toolbar has only commands with a text label. */
const WORDS_WIDTH_PX = 430;
/** Up to this width the toolbar spans the window; wider windows leave room for the HUD. */
const WHOLE_WIDTH_PX = 640;
const FIGURES_PX = 320;
const MARGINS_PX = 24;
/** Width of a button and its gap, large enough for a finger. */
const BUTTON_PX = 46;
/** Width of the label beside the first button's icon. */
const WORD_PX = 50;

/**
 * The commands whose buttons fit into the toolbar, in their order; the menu has the others.
 * Commands with a text label have priority.
 */
export function inlineCommands<Each extends Command>(
  commands: readonly Each[],
  windowWidthPx: number,
): readonly Each[] {
  const worded = commands.filter(({ word }) => word !== undefined);
  if (windowWidthPx <= WORDS_WIDTH_PX) return worded;
  const leftPx = windowWidthPx - (windowWidthPx <= WHOLE_WIDTH_PX ? MARGINS_PX : FIGURES_PX) - WORD_PX;
  const fitting = Math.floor(leftPx / BUTTON_PX);
  if (commands.length <= fitting) return commands;
  const others = commands.filter(({ word }) => word === undefined);
  // One button's place is needed for the menu.
  const kept = new Set([...worded, ...others.slice(0, Math.max(0, fitting - 1 - worded.length))]);
  return commands.filter((command) => kept.has(command));
}

type ButtonCommand = Command & { readonly name: IconName };

const BUTTONS = COMMANDS.filter((command): command is ButtonCommand => !command.isInPanel);

/** The menu button's value among the possible Tab stops. */
const MENU = 'menu';
/** Selects the toolbar's own buttons, without the menu's items. */
const BAR_BUTTONS = 'button:not(:disabled, .menu-item)';

/**
 * One button is the Tab stop; arrow keys move between buttons. A menu at the end has the overflow.
 */
export function Toolbar({ store, run }: { store: ViewerStore; run: RunCommand }) {
  const isTurned = useStore(store, (state) => isUpsideDown(state, state.firstUp));
  const isHudVisible = useStore(store, (state) => state.isHudVisible);
  const dock = useStore(store, (state) => state.dock);
  const state = useStore(store, useShallow(commandState));
  const [stop, setStop] = useState<CommandName | typeof MENU>(COMMANDS[0].name);
  const root = useRef<HTMLDivElement>(null);
  const pressed: Partial<Record<CommandName, boolean>> = {
    // A file that is upside down is shown upright: this alone does not count as flipped by the
    // user.
    flip: isTurned,
    hud: isHudVisible,
    clouds: dock === 'clouds',
    view: dock === 'view',
    inspect: dock === 'inspect',
    accuracy: dock === 'accuracy',
    effects: dock === 'effects',
    save: dock === 'save',
  };
  const isDisabled = (name: CommandName) => !isAvailable(name, state);
  const inline = inlineCommands(
    BUTTONS,
    useSyncExternalStore(onResize, () => innerWidth),
  );
  const others = BUTTONS.filter((command) => !inline.includes(command));
  const isReachable =
    stop === MENU ? others.length > 0 : inline.some(({ name }) => name === stop) && !isDisabled(stop);
  const tabStop = isReachable ? stop : COMMANDS[0].name;
  const onKeyDown = (event: KeyboardEvent) => {
    const buttons = [...(root.current?.querySelectorAll<HTMLElement>(BAR_BUTTONS) ?? [])];
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
        {inline.map(({ name, label, key, word }) => (
          <button
            key={name}
            type="button"
            className={name === 'open' ? 'text-button open' : 'icon-button'}
            aria-label={label}
            aria-keyshortcuts={key.toUpperCase()}
            aria-pressed={pressed[name]}
            data-tip={label}
            data-key={key.toUpperCase()}
            tabIndex={name === tabStop ? 0 : -1}
            data-testid={`command-${name}`}
            disabled={isDisabled(name)}
            onFocus={() => setStop(name)}
            onClick={() => run(name)}
          >
            <Icon name={name} />
            {word && <Word>{word}</Word>}
          </button>
        ))}
        {others.length > 0 && (
          <MenuButton
            label="More"
            items={others.map(({ name, label, key }) => ({
              name,
              label,
              icon: name,
              shortcut: key.toUpperCase(),
              isOn: pressed[name],
              isDisabled: isDisabled(name),
            }))}
            tabIndex={tabStop === MENU ? 0 : -1}
            onFocus={() => setStop(MENU)}
            onChoose={run}
          >
            <Icon name="menu" />
            <Word>More</Word>
          </MenuButton>
        )}
      </div>
    </nav>
  );
}

/** The label of a button on small toolbars; wide ones label only the first button. */
function Word({ children }: { children: string }) {
  return (
    <span className="toolbar-word" aria-hidden="true">
      {children}
    </span>
  );
}

function onResize(listener: () => void): () => void {
  addEventListener('resize', listener);
  return () => removeEventListener('resize', listener);
}
