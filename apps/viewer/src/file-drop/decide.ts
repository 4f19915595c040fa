import type { FileDropDecision } from './file-drop.ts';
import type { FoundFile } from './found-file.ts';

/** As `decideFiles`, whose code is loaded when somebody brings files. */
export async function decide(found: readonly FoundFile[]): Promise<FileDropDecision> {
  const { decideFiles } = await import('./decide-files.ts');
  return decideFiles(found);
}
