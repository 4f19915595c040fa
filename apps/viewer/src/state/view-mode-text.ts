import { InvalidArgumentError, printable } from '@websplatter/core';
import { VIEW_MODE_NAMES, type ViewModeName } from './view-mode.ts';

/** As an address names the mode; null for the one that it need not name. */
export function encodeViewMode(mode: ViewModeName): string | null {
  return mode === 'colours' ? null : mode;
}

/** @throws InvalidArgumentError where there is no such mode, with those that there are. */
export function decodeViewMode(text: string): ViewModeName {
  const mode = VIEW_MODE_NAMES.find((name) => name === text);
  if (mode) return mode;
  throw new InvalidArgumentError(
    'mode',
    `The address asks for the view mode “${printable(text)}”; there are ${VIEW_MODE_NAMES.join(', ')}.`,
  );
}
