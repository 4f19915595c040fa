import { expect, test } from 'vitest';
import { LazyIngest } from './lazy-ingest.ts';

test('a signal that outlives the load keeps no listener', () => {
  const listeners = new Set<unknown>();
  const signal = {
    addEventListener: (_: string, listener: unknown) => listeners.add(listener),
    removeEventListener: (_: string, listener: unknown) => listeners.delete(listener),
  } as unknown as AbortSignal;
  const precision = { geometryPrecision: 'packed', shPrecision: 'u8' } as const;
  const ingest = new LazyIngest({} as never, { ...precision, name: 'scene', signal });
  expect(listeners.size).toBe(1);
  ingest.destroy();
  expect(listeners.size).toBe(0);
});
