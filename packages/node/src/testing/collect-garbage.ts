import { setFlagsFromString } from 'node:v8';
import { runInNewContext } from 'node:vm';

/** Collects all garbage, also objects of WeakRefs. */
export async function collectGarbage(): Promise<void> {
  setFlagsFromString('--expose-gc');
  const gc = runInNewContext('gc') as () => void;
  for (let i = 0; i < 3; i++) {
    // A WeakRef that was dereferenced keeps its object until the task ends.
    await new Promise((resolve) => setTimeout(resolve));
    gc();
  }
}
