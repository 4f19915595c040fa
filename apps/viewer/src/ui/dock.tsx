import { type ReactNode, useId } from 'react';
import type { ViewerStore } from '../state/store.ts';
import type { DockName } from '../state/viewer-state.ts';
import { IconButton } from './controls.tsx';
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
      <header className="spread">
        <h2 id={id}>{title}</h2>
        <IconButton icon="close" label="Close" onClick={() => store.setState({ dock: null })} />
      </header>
      {children}
    </section>
  );
}
