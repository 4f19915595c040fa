import { type ComponentType, type LazyExoticComponent, lazy } from 'react';

const fetches: (() => Promise<unknown>)[] = [];

/**
 * A component whose code the first picture does not wait for. It is fetched by `fetchLate`, or when it is first shown: put it
 * within `<Suspense>`.
 */
export function late<Props extends object>(
  fetch: () => Promise<ComponentType<Props>>,
): LazyExoticComponent<ComponentType<Props>> {
  fetches.push(fetch);
  return lazy(async () => ({ default: await fetch().catch(() => NotFetched) }));
}

/** Fetches the code of all late components, one after another, so that panels open at once. */
export async function fetchLate(): Promise<void> {
  // Whoever opens what could not be fetched is told by `NotFetched`.
  for (const fetch of fetches) await fetch().catch(() => {});
}

/** In place of a component whose code cannot be fetched: offline, or after a new version has replaced this one. */
function NotFetched() {
  return (
    <p className="panel notice" role="alert">
      This part of the viewer could not be loaded. Check the connection, then reload the page.
    </p>
  );
}
