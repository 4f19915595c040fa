import { type ReactNode, useId } from 'react';
import type { ViewerStore } from '../state/store.ts';
import type { DockName } from '../state/viewer-state.ts';
import { Icon } from './icon.tsx';
import { SheetGrip } from './sheet-grip.tsx';

/** A panel beside the image, on small screens a sheet below it. One is shown at a time. */
export function Dock({
  store,
  name,
  title,
  children,
}: {
  store: ViewerStore;
  name: DockName;
  title: string;
  children: ReactNode;
}) {
  const id = useId();
  return (
    <section className={`panel dock ${name}`} aria-labelledby={id} data-testid={name}>
      <SheetGrip store={store} label={`Height of the panel ${title}`} />
      <header>
        <h2 id={id}>{title}</h2>
        <button
          type="button"
          className="icon-button"
          aria-label="Close"
          onClick={() => store.setState({ dock: null })}
        >
          <Icon name="close" />
        </button>
      </header>
      {children}
    </section>
  );
}
