import { type AccuracyPreset, DEFAULT_ACCURACY } from '@websplatter/core';

/** The preset and the changes of `fast,sortKeyBits:32`. Names and values may be wrong. */
export function splitAccuracy(text: string): {
  readonly preset: AccuracyPreset;
  readonly asked: Readonly<Record<string, unknown>>;
} {
  const parts = text.split(',').map((part) => part.trim());
  // A first part with a colon is a change already: `sortKeyBits:16` alone changes the default.
  const preset = parts[0].includes(':') ? DEFAULT_ACCURACY : (parts.shift() as AccuracyPreset);
  const changes = parts.map((part) => {
    const [name, value = ''] = part.split(':');
    return [name, value !== '' && Number.isFinite(Number(value)) ? Number(value) : value];
  });
  return { preset, asked: Object.fromEntries(changes) };
}
