import { callListener } from '@websplatter/core';

/** Internals of three's EventDispatcher, which has no public access to its listeners. */
interface Dispatcher {
  /** By type of event; missing before the first. */
  readonly _listeners?: Readonly<Record<string, readonly ((event: object) => unknown)[]>>;
  dispatchEvent(event: never): void;
}

/**
 * Dispatches an event as three does, but an error of one listener does not skip the next:
 * `callListener` reports it. Otherwise a failing listener of the application could keep the Canvas,
 * which listens too, from drawing a requested frame.
 */
export function dispatch(
  dispatcher: Dispatcher,
  event: { readonly type: string; readonly [field: string]: unknown },
): void {
  const { _listeners: known } = dispatcher;
  if (known) {
    const dispatched = { ...event, target: dispatcher };
    for (const listener of [...(known[event.type] ?? [])])
      callListener(() => listener.call(dispatcher, dispatched));
  }
  // Before the first listener, or if three has renamed `_listeners`.
  else callListener(() => dispatcher.dispatchEvent(event as never));
}
