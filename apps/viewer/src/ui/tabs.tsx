import { type KeyboardEvent, useRef } from 'react';

export interface TabsProps<Name extends string> {
  /** The tabs' ids begin with it; that of their panel is `ID-body`. */
  readonly id: string;
  readonly label: string;
  readonly tabs: Readonly<Record<Name, string>>;
  readonly tab: Name;
  readonly onTab: (tab: Name) => void;
  /** Prefix of the tabs' `data-testid`. */
  readonly testId: string;
}

/** The Tab key stops at the chosen tab only; arrow keys go to the others. */
export function Tabs<Name extends string>({ id, label, tabs, tab, onTab, testId }: TabsProps<Name>) {
  const list = useRef<HTMLDivElement>(null);
  const names = Object.keys(tabs) as Name[];
  const onKeyDown = (event: KeyboardEvent) => {
    const by = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (!by) return;
    event.preventDefault();
    // Arrows elsewhere turn the scene.
    event.stopPropagation();
    const next = (names.indexOf(tab) + by + names.length) % names.length;
    onTab(names[next]);
    list.current?.querySelectorAll('button')[next].focus();
  };
  return (
    <div ref={list} className="tabs" role="tablist" aria-label={label} onKeyDown={onKeyDown}>
      {names.map((name) => (
        <button
          key={name}
          type="button"
          role="tab"
          id={`${id}-${name}`}
          aria-selected={name === tab}
          aria-controls={`${id}-body`}
          tabIndex={name === tab ? 0 : -1}
          data-testid={`${testId}-${name}`}
          onClick={() => onTab(name)}
        >
          {tabs[name]}
        </button>
      ))}
    </div>
  );
}
