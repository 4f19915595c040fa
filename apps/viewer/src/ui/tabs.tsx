import { type KeyboardEvent, type ReactNode, useId, useRef } from 'react';

export interface TabsProps<Name extends string> {
  readonly label: string;
  readonly tabs: Readonly<Record<Name, string>>;
  readonly tab: Name;
  readonly onTab: (tab: Name) => void;
  /** Prefix of the tabs' `data-testid`. */
  readonly testId: string;
  /** Content of the selected tab. */
  readonly children: ReactNode;
}

/** Only the selected tab is a Tab stop; arrow keys move between tabs. */
export function Tabs<Name extends string>({ label, tabs, tab, onTab, testId, children }: TabsProps<Name>) {
  const id = useId();
  const list = useRef<HTMLDivElement>(null);
  const names = Object.keys(tabs) as Name[];
  const onKeyDown = (event: KeyboardEvent) => {
    const by = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (!by) return;
    event.preventDefault();
    // Arrow keys that bubble would turn the scene.
    event.stopPropagation();
    const next = (names.indexOf(tab) + by + names.length) % names.length;
    onTab(names[next]);
    list.current?.querySelectorAll('button')[next].focus();
  };
  return (
    <>
      {' '}
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
      <div
        className="dock-body"
        id={`${id}-body`}
        role="tabpanel"
        aria-labelledby={`${id}-${tab}`}
        // biome-ignore lint/a11y/noNoninteractiveTabindex: it scrolls, so keys must reach it.
        tabIndex={0}
      >
        {children}
      </div>
    </>
  );
}
