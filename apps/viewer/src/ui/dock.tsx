import { IconButton } from '@websplatter/kit/controls';
import { type ReactNode, useId } from 'react';
import { COMMANDS } from '../state/command-list.ts';
import type { DockName } from '../state/page.ts';
import type { ViewerStore } from '../state/store.ts';
import { SheetGrip } from './sheet-grip.tsx';

/**
 * A panel beside the picture, named like its command; on small screens a sheet below the picture.
 * One panel is open at a time.
 */
export function Dock({ store, name, children }: { store: ViewerStore; name: DockName; children: ReactNode }) {
  const id = useId();
  const title = COMMANDS.find((command) => command.name === name)?.label;
  return (
    <section className={`panel dock ${name}`} aria-labelledby={id} data-testid={name}>
      <header className="spread">
        <SheetGrip store={store} label={`Height of the panel ${title}`} />
        <h2 id={id}>{title}</h2>
        <IconButton icon="close" label="Close" onClick={() => store.setState({ dock: null })} />
      </header>
      {children}
    </section>
  );
}
