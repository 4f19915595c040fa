import { Icon, type IconName } from '@websplatter/kit/icon';
import {
  type KeyboardEvent,
  Suspense,
  type SyntheticEvent,
  useId,
  useRef,
  useState,
  useSyncExternalStore,
} from 'react';
import { useStore } from 'zustand';
import {
  COMMANDS,
  type Command,
  type CommandName,
  isAvailable,
  labelNow,
  openTool,
  type RunCommand,
  shownKey,
} from '../state/command-list.ts';
import type { ViewerStore } from '../state/store.ts';
import { lazyComponent } from '../ui/lazy.tsx';
import { smallParts } from './picture.tsx';
import { useCommandState } from './use-command-state.ts';

/** Up to this width the toolbar spans the window, at its bottom; wider windows leave room for the HUD. */
const WHOLE_WIDTH_PX = 640;
/** From this width on, there is room for words everywhere. */
const WORDS_WIDTH_PX = 1100;
const FIGURES_PX = 320;
const MARGINS_PX = 24;
/** A button and its gap: large enough for a word, or for a finger. */
const WORD_BUTTON_PX = 56;
const ICON_BUTTON_PX = 46;
/** Gaps between all groups. */
const GROUP_GAPS_PX = 44;

/** Whether buttons have words: fingers have no tooltips, and neither have bars of small windows. */
export function hasWords(windowWidthPx: number, isTouch: boolean): boolean {
  return isTouch || windowWidthPx >= WORDS_WIDTH_PX || windowWidthPx <= WHOLE_WIDTH_PX;
}

/** The commands whose buttons fit into the toolbar, in their order; the menu has the others. */
export function inlineCommands<Each extends Command>(
  commands: readonly Each[],
  windowWidthPx: number,
  isTouch: boolean,
): readonly Each[] {
  const isWhole = windowWidthPx <= WHOLE_WIDTH_PX;
  const roomPx = windowWidthPx - (isWhole ? MARGINS_PX : FIGURES_PX + GROUP_GAPS_PX);
  const buttonPx = hasWords(windowWidthPx, isTouch) ? WORD_BUTTON_PX : ICON_BUTTON_PX;
  const fitting = Math.floor(roomPx / buttonPx);
  if (commands.length <= fitting) return commands;
  const ranks = commands.map(({ bar }) => bar?.rank ?? 0).sort((a, b) => a - b);
  // One button's place is needed for the menu.
  return commands.filter(({ bar }) => (bar?.rank ?? 0) < ranks[Math.max(1, fitting - 1)]);
}

type ButtonCommand = Command & Required<Pick<Command, 'bar'>> & { readonly name: IconName };

const BUTTONS = COMMANDS.filter((command): command is ButtonCommand => command.bar !== undefined);

/** The menu button's value among the possible Tab stops. */
const MENU = 'menu';
/** Selects the toolbar's own buttons, without the menu's items. */
const BAR_BUTTONS = 'button:not(:disabled, .menu-item)';
const OverflowMenu = lazyComponent(async () => (await smallParts()).OverflowMenu);

/**
 * One button is the Tab stop; arrow keys move between buttons. A menu at the end has the overflow.
 */
export function Toolbar({ store, run }: { store: ViewerStore; run: RunCommand }) {
  const isHudVisible = useStore(store, (state) => state.isHudVisible);
  const dock = useStore(store, (state) => state.dock);
  const tool = useStore(store, openTool);
  const isPlacing = useStore(store, (state) => state.annotating.isPlacing);
  const state = useCommandState(store);
  const widthPx = useSyncExternalStore(onResize, () => innerWidth);
  const isTouch = useSyncExternalStore(onResize, () => matchMedia('(pointer: coarse)').matches);
  const [stop, setStop] = useState<CommandName | typeof MENU>(COMMANDS[0].name);
  const [isMenuOpen, setMenuOpen] = useState(false);
  const root = useRef<HTMLDivElement>(null);
  const more = useRef<HTMLButtonElement>(null);
  const menuId = useId();
  const pressed: Partial<Record<CommandName, boolean>> = {
    open: dock === 'open',
    clouds: dock === 'clouds',
    view: dock === 'view',
    accuracy: dock === 'accuracy',
    effects: dock === 'effects',
    save: dock === 'save',
    inspect: tool === 'inspect',
    select: tool === 'select',
    measure: tool === 'measure',
    crop: tool === 'crop',
    hud: isHudVisible,
    annotate: isPlacing,
  };
  const buttons = BUTTONS.map((command) => ({
    ...command,
    label: labelNow(command, state),
    key: shownKey(command),
    isOn: pressed[command.name],
    isDisabled: !isAvailable(command.name, state),
  }));
  const inline = inlineCommands(buttons, widthPx, isTouch);
  const others = buttons.filter((button) => !inline.includes(button));
  const isReachable =
    stop === MENU ? others.length > 0 : inline.some(({ name, isDisabled }) => name === stop && !isDisabled);
  const tabStop = isReachable ? stop : COMMANDS[0].name;
  const onKeyDown = (event: KeyboardEvent) => {
    const all = [...(root.current?.querySelectorAll<HTMLElement>(BAR_BUTTONS) ?? [])];
    const at = all.indexOf(event.target as HTMLElement);
    const goal = { ArrowRight: at + 1, ArrowLeft: at - 1, Home: 0, End: -1 }[event.key];
    if (at < 0 || goal === undefined) return;
    event.preventDefault();
    all.at(goal % all.length)?.focus();
  };
  return (
    <nav className="toolbar-area" aria-label="Viewer">
      <div
        ref={(toolbar) => {
          root.current = toolbar;
          return toolbar ? tellWidth(toolbar) : undefined;
        }}
        className="panel toolbar"
        role="toolbar"
        aria-label="Viewer"
        data-words={hasWords(widthPx, isTouch)}
        data-testid="toolbar"
        onKeyDown={onKeyDown}
      >
        {inline.map(({ name, label, key, bar, group, isOn, isDisabled }, i) => (
          <button
            key={name}
            type="button"
            className="icon-button"
            aria-label={label}
            aria-keyshortcuts={key.replace('Ctrl', 'Control')}
            aria-pressed={isOn}
            data-tip={label}
            data-key={key}
            data-begins-group={i > 0 && inline[i - 1].group !== group}
            tabIndex={name === tabStop ? 0 : -1}
            data-testid={`command-${name}`}
            disabled={isDisabled}
            onFocus={() => setStop(name)}
            onPointerDown={hideTip}
            onPointerLeave={allowTip}
            onBlur={allowTip}
            onClick={(event) => {
              hideTip(event);
              run(name);
            }}
          >
            <Icon name={name} />
            <Word>{bar.word}</Word>
          </button>
        ))}
        {others.length > 0 && (
          <div className="menu-area">
            <button
              ref={more}
              type="button"
              className="icon-button"
              aria-label="More"
              aria-haspopup="menu"
              aria-expanded={isMenuOpen}
              aria-controls={isMenuOpen ? menuId : undefined}
              title="More"
              tabIndex={tabStop === MENU ? 0 : -1}
              data-testid="more"
              onFocus={() => setStop(MENU)}
              onClick={() => setMenuOpen(!isMenuOpen)}
              onKeyDown={(event) => {
                if (event.key !== 'ArrowDown' && event.key !== 'ArrowUp') return;
                event.preventDefault();
                setMenuOpen(true);
              }}
            >
              <Icon name="menu" />
              <Word>More</Word>
            </button>
            <Suspense>
              {isMenuOpen && (
                <OverflowMenu
                  id={menuId}
                  items={others}
                  onChoose={run}
                  onClose={(isFocusKept) => {
                    setMenuOpen(false);
                    if (isFocusKept) more.current?.focus();
                  }}
                />
              )}
            </Suspense>
          </div>
        )}
      </div>
    </nav>
  );
}

function Word({ children }: { children: string }) {
  return (
    <span className="toolbar-word" aria-hidden="true">
      {children}
    </span>
  );
}

/** Hides the tooltip of a pressed button, which would lie on the panel that opens. */
function hideTip({ currentTarget }: SyntheticEvent<HTMLElement>): void {
  currentTarget.dataset.hidesTip = '';
}

function allowTip({ currentTarget }: SyntheticEvent<HTMLElement>): void {
  delete currentTarget.dataset.hidesTip;
}

/** Has style sheets know the toolbar's width, beside which the figures have room. */
function tellWidth(toolbar: HTMLElement): () => void {
  const observer = new ResizeObserver(() =>
    document.documentElement.style.setProperty('--toolbar-width', `${toolbar.offsetWidth}px`),
  );
  observer.observe(toolbar);
  return () => observer.disconnect();
}

function onResize(listener: () => void): () => void {
  addEventListener('resize', listener);
  return () => removeEventListener('resize', listener);
}
