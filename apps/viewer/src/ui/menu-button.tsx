import { Icon, type IconName } from '@websplatter/kit/icon';
import { type KeyboardEvent, type ReactNode, useEffect, useId, useRef, useState } from 'react';

export interface MenuItem<Name extends string> {
  readonly name: Name;
  readonly label: string;
  readonly icon: IconName;
  /** Key, e.g. `H`. */
  readonly shortcut: string;
  /** Whether the command is switched on; undefined for commands that are not switches. */
  readonly isOn?: boolean;
  readonly isDisabled?: boolean;
}

/** A button with a menu of commands. Arrow keys move in it; Escape and clicks outside close it. */
export function MenuButton<Name extends string>({
  label,
  items,
  tabIndex,
  onFocus,
  onChoose,
  children,
}: {
  label: string;
  items: readonly MenuItem<Name>[];
  tabIndex: number;
  onFocus: () => void;
  onChoose: (name: Name) => void;
  /** Content of the button. */
  children: ReactNode;
}) {
  const [isOpen, setOpen] = useState(false);
  const root = useRef<HTMLDivElement>(null);
  const button = useRef<HTMLButtonElement>(null);
  const menuId = useId();
  const focusable = () => [
    ...(root.current?.querySelectorAll<HTMLElement>('[role^=menuitem]:not(:disabled)') ?? []),
  ];
  const close = () => {
    setOpen(false);
    button.current?.focus();
  };
  useEffect(() => {
    if (!isOpen) return;
    root.current?.querySelector<HTMLElement>('[role^=menuitem]:not(:disabled)')?.focus();
    const closeOutside = ({ target }: Event) => {
      if (!root.current?.contains(target as Node)) setOpen(false);
    };
    const events = ['pointerdown', 'focusin'] as const;
    for (const type of events) document.addEventListener(type, closeOutside);
    return () => {
      for (const type of events) document.removeEventListener(type, closeOutside);
    };
  }, [isOpen]);

  const onKeyDown = (event: KeyboardEvent) => {
    if (!isOpen) {
      if (event.key !== 'ArrowDown' && event.key !== 'ArrowUp') return;
      setOpen(true);
    } else {
      const all = focusable();
      const at = all.indexOf(event.target as HTMLElement);
      const goal = { ArrowDown: at + 1, ArrowUp: at - 1, Home: 0, End: -1 }[event.key];
      if (goal !== undefined) all.at(goal % all.length)?.focus();
      else if (event.key === 'Escape') close();
      // Other keys work as elsewhere: a command's key runs the command.
      else if (event.key === 'Enter' || event.key === ' ') return;
      else {
        setOpen(false);
        return;
      }
    }
    event.preventDefault();
    // Prevents the toolbar and the scene from handling the key too.
    event.stopPropagation();
  };
  return (
    // biome-ignore lint/a11y/noStaticElementInteractions: it handles keys of button and items.
    <div ref={root} className="menu-area" onKeyDown={onKeyDown}>
      <button
        ref={button}
        type="button"
        className="icon-button"
        aria-label={label}
        aria-haspopup="menu"
        aria-expanded={isOpen}
        aria-controls={menuId}
        title={label}
        tabIndex={tabIndex}
        data-testid="more"
        onFocus={onFocus}
        onClick={() => setOpen(!isOpen)}
      >
        {children}
      </button>
      <div
        id={menuId}
        className="menu"
        role="menu"
        aria-label={label}
        hidden={!isOpen}
        data-testid="more-menu"
      >
        {items.map(({ name, label: words, icon, shortcut, isOn, isDisabled }) => (
          <button
            key={name}
            type="button"
            className="menu-item"
            {...(isOn === undefined
              ? { role: 'menuitem' }
              : { role: 'menuitemcheckbox', 'aria-checked': isOn })}
            aria-keyshortcuts={shortcut}
            tabIndex={-1}
            disabled={isDisabled}
            data-testid={`command-${name}`}
            onClick={() => {
              close();
              onChoose(name);
            }}
          >
            <Icon name={icon} />
            <span>{words}</span>
            <span className="menu-key" aria-hidden="true">
              {shortcut}
            </span>
          </button>
        ))}
      </div>
    </div>
  );
}
