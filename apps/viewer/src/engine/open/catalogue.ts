import type { HardCase } from '@websplatter/conformance';
import { closestNames, isOpenable, noteOn, type OpenableCase } from '@websplatter/kit/hard-cases';
import { HardCaseError } from '../link/case-addresses.ts';

/** Loaded for a hard case, so that the viewer does not carry the catalogue. */
export async function loadHardCases(): Promise<readonly HardCase[]> {
  const { HARD_CASES } = await import('./all-cases.ts');
  return HARD_CASES;
}

/** @throws HardCaseError if there is no such case or it cannot be opened. */
export function findHardCase(cases: readonly HardCase[], name: string): OpenableCase {
  const found = cases.find((candidate) => candidate.name === name);
  if (found && isOpenable(found)) return found;
  if (found) throw new HardCaseError(`${name} cannot be opened. ${noteOn(found)}`);
  const closest = closestNames(
    cases.filter(isOpenable).map((candidate) => candidate.name),
    name,
  );
  throw new HardCaseError(
    closest.length > 0
      ? `There is no hard case “${name}”. These have similar names:`
      : `There is no hard case “${name}”.`,
    closest,
  );
}
