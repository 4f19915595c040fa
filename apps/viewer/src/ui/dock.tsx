import { IconButton } from '@websplatter/kit/controls';
import { type ReactNode, useId } from 'react';
import { COMMANDS } from '../state/command-list.ts';
import type { DockName } from '../state/page.ts';
import type { ViewerStore } from '../state/store.ts';
import { SheetGrip } from './sheet-grip.tsx';

/**
 * A panel beside the picture; on small screens a sheet below the picture. One panel is open at a
 * time.
 *
 * @param title by default the label of its command.
 */
export function Dock({
  store,
  name,
  title = COMMANDS.find((command) => command.name === name)?.label,
  children,
}: {
  store: ViewerStore;
  name: DockName;
  title?: string;
  children: ReactNode;
}) {
  const id = useId();
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
