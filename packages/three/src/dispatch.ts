import { callListener } from '@websplatter/core';

/** What this needs of three's EventDispatcher, which has no public way to its listeners. */
interface Dispatcher {
  /** By type of event; missing before the first. */
  readonly _listeners?: Readonly<Record<string, readonly ((event: object) => unknown)[]>>;
  dispatchEvent(event: never): void;
}

/**
 * Dispatches an event as three does, but an error of one listener is reported, as `callListener`
 * does, and others are told: those of a Canvas, which draws frames that clouds ask for, stand in
 * line with those of applications.
 */
export function dispatch(
  dispatcher: Dispatcher,
  event: { readonly type: string; readonly [field: string]: unknown },
): void {
  const { _listeners: known } = dispatcher;
  if (known) {
    const told = { ...event, target: dispatcher };
    for (const listener of [...(known[event.type] ?? [])])
      callListener(() => listener.call(dispatcher, told));
  }
  // Before the first listener, or where three has renamed them.
  else callListener(() => dispatcher.dispatchEvent(event as never));
}
