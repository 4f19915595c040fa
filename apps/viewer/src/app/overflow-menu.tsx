import { Icon, type IconName } from '@websplatter/kit/icon';
import { type KeyboardEvent, useEffect, useRef } from 'react';
import type { Command, CommandName, RunCommand } from '../state/command-list.ts';

export interface OverflowItem extends Command {
  /** Its key as keyboards show it. */
  readonly key: string;
  readonly name: CommandName & IconName;
  /** Whether the command is switched on; undefined for commands that are not switches. */
  readonly isOn: boolean | undefined;
  readonly isDisabled: boolean;
}

/**
 * A menu of the commands without room in the toolbar. Arrow keys move in it; Escape and clicks
 * beside it close it.
 */
export function OverflowMenu({
  id,
  items,
  onChoose,
  onClose,
}: {
  id: string;
  items: readonly OverflowItem[];
  onChoose: RunCommand;
  /** Called with whether the focus returns to the menu's button. */
  onClose: (isFocusKept: boolean) => void;
}) {
  const root = useRef<HTMLDivElement>(null);
  const focusable = () => [...(root.current?.querySelectorAll<HTMLElement>('button:not(:disabled)') ?? [])];
  const latestOnClose = useRef(onClose);
  useEffect(() => {
    latestOnClose.current = onClose;
  });
  useEffect(() => {
    root.current?.querySelector<HTMLElement>('button:not(:disabled)')?.focus();
    const closeOutside = ({ target }: Event) => {
      // A press of the menu's own button closes it by itself.
      if (!root.current?.parentElement?.contains(target as Node)) latestOnClose.current(false);
    };
    const events = ['pointerdown', 'focusin'] as const;
    for (const type of events) document.addEventListener(type, closeOutside);
    return () => {
      for (const type of events) document.removeEventListener(type, closeOutside);
    };
  }, []);
  const onKeyDown = (event: KeyboardEvent) => {
    const all = focusable();
    const at = all.indexOf(event.target as HTMLElement);
    const goal = { ArrowDown: at + 1, ArrowUp: at - 1, Home: 0, End: -1 }[event.key];
    if (goal !== undefined) all.at(goal % all.length)?.focus();
    else if (event.key === 'Escape') onClose(true);
    else {
      // Other keys work as elsewhere: a command's key runs the command.
      if (event.key !== 'Enter' && event.key !== ' ') onClose(false);
      return;
    }
    event.preventDefault();
    // Prevents the toolbar and the scene from handling the key too.
    event.stopPropagation();
  };
  return (
    <div
      ref={root}
      id={id}
      className="menu"
      role="menu"
      aria-label="More"
      data-testid="more-menu"
      onKeyDown={onKeyDown}
    >
      {items.map(({ name, label, key, isOn, isDisabled }) => (
        <button
          key={name}
          type="button"
          className="menu-item"
          {...(isOn === undefined
            ? { role: 'menuitem' }
            : { role: 'menuitemcheckbox', 'aria-checked': isOn })}
          aria-keyshortcuts={key.replace('Ctrl', 'Control')}
          tabIndex={-1}
          disabled={isDisabled}
          data-testid={`command-${name}`}
          onClick={() => {
            onClose(true);
            onChoose(name);
          }}
        >
          <Icon name={name} />
          <span>{label}</span>
          <span className="menu-key" aria-hidden="true">
            {key}
          </span>
        </button>
      ))}
    </div>
  );
}
