import { shallow } from 'zustand/vanilla/shallow';
import './stream-panel.css';
import type { SplatEngine } from '@websplatter/core';
import { formatBytes } from '@websplatter/kit/format';
import { useEffect } from 'react';
import { useStore } from 'zustand';
import type { PanelProps } from '../engine/viewer.ts';
import { awaitsFirstParts, type Streaming } from '../state/frames.ts';
import type { ViewerStore } from '../state/store.ts';

/** Interval of updates, ms; as often as people can read numbers. */
const LOOK_AFTER_MS = 250;

/** Updates `streaming` in the store until the returned function is called. */
export function followStreams(store: ViewerStore, engine: () => SplatEngine | null): () => void {
  let timer: ReturnType<typeof setTimeout> | undefined;
  let stops: (() => void)[] = [];
  const lookLater = () => {
    timer ??= setTimeout(look, LOOK_AFTER_MS);
  };
  const stop = () => {
    for (const each of stops) each();
    clearTimeout(timer);
    timer = undefined;
  };
  const look = () => {
    stop();
    const streams = (engine()?.clouds ?? []).flatMap(({ stream }) => stream ?? []);
    stops = streams.map((stream) => stream.subscribe(lookLater));
    const reports = streams.map((stream) => stream.report());
    // Rates change without an event.
    if (reports.some(({ fetching }) => fetching > 0)) lookLater();
    const sum = (name: Exclude<keyof Streaming, 'error'>) =>
      reports.reduce((total, report) => total + report[name], 0);
    const streaming: Streaming | null =
      reports.length === 0
        ? null
        : {
            bricks: sum('bricks'),
            residentBricks: sum('residentBricks'),
            missingBricks: sum('missingBricks'),
            fetchedBytes: sum('fetchedBytes'),
            bytesPerSecond: sum('bytesPerSecond'),
            error: reports.find(({ error }) => error)?.error ?? null,
          };
    if (!isSame(streaming, store.getState().streaming)) store.setState({ streaming });
  };
  look();
  const unsubscribe = store.subscribe(({ scene, status }) => [scene, status], lookLater, {
    equalityFn: shallow,
  });
  return () => {
    unsubscribe();
    stop();
  };
}

function isSame(a: Streaming | null, b: Streaming | null): boolean {
  if (!a || !b) return a === b;
  return (Object.keys(a) as (keyof Streaming)[]).every((name) => a[name] === b[name]);
}

function fetchedText({ fetchedBytes, bytesPerSecond }: Streaming): string {
  const rate = bytesPerSecond > 0 ? ` · ${formatBytes(bytesPerSecond)}/s` : '';
  return `${formatBytes(fetchedBytes)}${rate}`;
}

/**
 * What a scene that streams has fetched until there is a picture; then an error message if parts
 * could not be fetched. Loaded parts stay.
 */
export function StreamPanel({ store, viewer }: PanelProps) {
  const error = useStore(store, (state) => state.streaming?.error);
  const awaited = useStore(store, (state) => (awaitsFirstParts(state) ? state.streaming : null));
  const title = useStore(store, (state) => state.scene?.title ?? '');
  useEffect(() => followStreams(store, () => viewer.engine), [store, viewer]);
  const retry = () => {
    for (const { stream } of viewer.engine?.clouds ?? []) stream?.retry();
  };
  return (
    <div role="status" className="message-slot">
      {awaited && (
        <section className="panel load" data-testid="first-parts" aria-label={`Fetching ${title}`}>
          <strong className="load-title">{title}</strong>
          <progress aria-label={`Fetching ${title}`} />
          <div className="spread figures">
            <span>Fetching its first parts</span>
            <span>{fetchedText(awaited)}</span>
          </div>
        </section>
      )}
      {error && (
        <section className="panel notice stream-panel" data-testid="stream-error">
          <p title={error.message}>Parts of the scene could not be fetched.</p>
          <button type="button" className="chip" onClick={retry}>
            Try again
          </button>
        </section>
      )}
    </div>
  );
}
