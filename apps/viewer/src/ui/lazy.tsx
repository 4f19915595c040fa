import { type ComponentType, type LazyExoticComponent, lazy } from 'react';
import { NOT_FETCHED } from '../state/messages.ts';
import type { ViewerStore } from '../state/store.ts';

const fetches: (() => Promise<unknown>)[] = [];

/**
 * Code that is not needed for the first picture. It is fetched by `fetchLazy` or the first call.
 */
export function lazyCode<Code>(fetch: () => Promise<Code>): () => Promise<Code> {
  fetches.push(fetch);
  return fetch;
}

/**
 * A component whose code is not needed for the first picture. It is fetched by `fetchLazy` or when
 * first rendered, within `<Suspense>`.
 */
export function lazyComponent<Props extends object>(
  fetch: () => Promise<ComponentType<Props>>,
): LazyExoticComponent<ComponentType<Props>> {
  const fetchCode = lazyCode(fetch);
  // `NotFetched` says so in the place of the component.
  return lazy(async () => ({ default: await fetchCode().catch(() => NotFetched) }));
}

/** Fetches all lazy code, one piece after another, so that panels open at once. */
export async function fetchLazy(): Promise<void> {
  // If it fails, `NotFetched` says so when the part is opened.
  for (const fetch of fetches) await fetch().catch(() => {});
}

/** Calls `act` with code that is fetched on demand; if it cannot be, a notice says so. */
export function withCode<Code>(
  store: ViewerStore,
  fetch: () => Promise<Code>,
  act: (code: Code) => void,
): Promise<void> {
  return fetch().then(act, () => store.setState({ notice: NOT_FETCHED }));
}

/** Shown instead of a component whose code cannot be fetched. */
function NotFetched() {
  return (
    <p className="panel notice" role="alert">
      {NOT_FETCHED}
    </p>
  );
}
