import { NOT_FETCHED } from '../../state/messages.ts';
import { lazyCode } from '../../ui/lazy.tsx';
import type { FileDropDecision, FoundFile } from './file-drop.ts';

const code = lazyCode(() => import('./decide-files.ts'));

/**
 * Calls `decideFiles`, which is imported on demand so that the first frame does not wait for it.
 */
export function decide(found: readonly FoundFile[]): Promise<FileDropDecision> {
  return code().then(
    ({ decideFiles }) => decideFiles(found),
    () => ({ opened: [], notice: NOT_FETCHED }),
  );
}
