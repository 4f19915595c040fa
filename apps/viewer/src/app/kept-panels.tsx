import { IconButton, TextButton } from '@websplatter/kit/controls';
import { Icon } from '@websplatter/kit/icon';
import { useState } from 'react';
import { useStore } from 'zustand';
import type { RunCommand } from '../state/command-list.ts';
import type { ViewerStore } from '../state/store.ts';

/** Says that the browser could not store what was made, until it can or a person dismisses it. */
export function UnkeptPanel({ store, run }: { store: ViewerStore; run: RunCommand }) {
  const unkept = useStore(store, (state) => state.unkept);
  const [isDismissed, setDismissed] = useState(false);
  if (isDismissed) return null;
  const isFull = [...unkept.values()].some(
    (error) => error instanceof DOMException && /quota/i.test(error.name),
  );
  return (
    <section className="panel message warning" data-testid="unkept">
      <Icon name="warning" />
      <div className="message-text">
        <h2>{isFull ? 'No room to keep your work' : 'Your work is not kept'}</h2>
        <p className="particulars">
          {isFull ? 'This browser’s storage is full' : 'This browser does not let the page store anything'}:{' '}
          {LIST.format(unkept.keys())} will be lost when this tab is closed. A project file holds everything.
        </p>
        <TextButton look="primary" testId="unkept-save" onClick={() => run('save-project')}>
          Save project
        </TextButton>
      </div>
      <IconButton
        icon="close"
        label="Dismiss the warning"
        testId="dismiss-unkept"
        onClick={() => setDismissed(true)}
      />
    </section>
  );
}

const LIST = new Intl.ListFormat('en');

/** Offers other edits of the scene, which stay in the browser if they are not brought back. */
export function KeptVersionsPanel({ store }: { store: ViewerStore }) {
  const kept = useStore(store, (state) => state.keptVersions);
  const title = useStore(store, (state) => state.scene?.title);
  if (!kept || title === undefined) return null;
  const { versions, isElsewhere } = kept;
  return (
    <section className="panel kept" aria-label="Kept edits" data-testid="kept-edits">
      <p>
        <b>{title}</b> {isElsewhere ? 'is also edited in another tab' : 'was edited before'}
      </p>
      <IconButton
        icon="close"
        label="Hide kept edits"
        title="Hide: they stay in this browser"
        testId="hide-kept"
        onClick={() => store.setState({ keptVersions: null })}
      />
      <ul>
        {versions.map(({ id, edits, savedAtMs, isElsewhere: isOpen, bringBack }) => (
          <li key={id} data-testid="kept-version">
            <p>
              {edits}{' '}
              <span className="kept-when">
                {dayAndTime(savedAtMs, Date.now())}
                {isOpen && ', in the other tab'}
              </span>
            </p>
            <TextButton look="plain" aria-label={`Bring back ${edits}`} onClick={bringBack}>
              Bring back
            </TextButton>
          </li>
        ))}
      </ul>
    </section>
  );
}

const DAY_MS = 86_400_000;
const TIME = new Intl.DateTimeFormat('en-GB', { timeStyle: 'short' });
const DATE = new Intl.DateTimeFormat('en-GB', { dateStyle: 'medium' });
const DAYS = new Intl.RelativeTimeFormat('en', { numeric: 'auto' });

/** `today, 09:05`, `yesterday, 18:20`, `28 Nov 2026, 18:20`, by the device's clock. */
export function dayAndTime(timeMs: number, nowMs: number): string {
  const days = Math.round((midnight(timeMs) - midnight(nowMs)) / DAY_MS);
  const day = days === 0 || days === -1 ? DAYS.format(days, 'day') : DATE.format(timeMs);
  return `${day}, ${TIME.format(timeMs)}`;
}

function midnight(timeMs: number): number {
  return new Date(timeMs).setHours(0, 0, 0, 0);
}
