import type {
  DeviceCase,
  FramingCase,
  HardCase,
  HardCaseGroup,
  RefusedFileCase,
  SceneCase,
} from '@websplatter/conformance';
import { HardCaseError } from './case-addresses.ts';

/** Cases that can be opened: images, first cameras, and files whose refusal is the point. */
export type OpenableCase = SceneCase | DeviceCase | FramingCase | RefusedFileCase;

/** Loaded for a hard case or the gallery, so that the viewer does not carry the catalogue. */
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

/** The cases before and after `name` among `cases`; null at the ends, and if it is missing. */
export function neighboursOf(
  cases: readonly HardCase[],
  name: string,
): { readonly previous: string | null; readonly next: string | null } {
  const index = cases.findIndex((candidate) => candidate.name === name);
  const nameAt = (at: number) => (index < 0 ? null : (cases[at]?.name ?? null));
  return { previous: nameAt(index - 1), next: nameAt(index + 1) };
}

export function isOpenable(hardCase: HardCase): hardCase is OpenableCase {
  return hardCase.kind !== 'sort' && hardCase.kind !== 'arithmetic';
}

/** Whether a case is about images, which this device can draw. */
export function hasImage(hardCase: HardCase): hardCase is SceneCase | DeviceCase {
  if (hardCase.kind !== 'scene' && hardCase.kind !== 'device') return false;
  const { widthPx, heightPx } = hardCase.size ?? { widthPx: 1, heightPx: 1 };
  return widthPx * heightPx > 0;
}

/** A remark on opening a case, or the reason why it cannot be opened; empty for ordinary cases. */
export function noteOn(hardCase: HardCase): string {
  switch (hardCase.kind) {
    case 'scene':
      return '';
    case 'device':
      return 'Opens on this device as it is; the tests take features away from it.';
    case 'refused-file':
      return 'No splats: opening it shows the error.';
    case 'framing':
      return 'Opening it shows it from the camera that is found; the tests compare that bit for bit.';
    case 'sort':
      return 'Keys for the sort alone, which make no image; the tests check their order.';
    case 'arithmetic':
      return 'Arithmetic alone, for scenes too large to draw; the tests check it.';
  }
}

/** `colour` → `Colour`. */
export function groupTitle(group: HardCaseGroup): string {
  return group[0].toUpperCase() + group.slice(1);
}

export interface CaseGroup {
  readonly group: HardCaseGroup;
  readonly cases: readonly HardCase[];
}

/** The cases by group, in the catalogue's order. */
export function groupedCases(cases: readonly HardCase[]): CaseGroup[] {
  const groups = new Map<HardCaseGroup, HardCase[]>();
  for (const hardCase of cases) {
    const members = groups.get(hardCase.group);
    if (members) members.push(hardCase);
    else groups.set(hardCase.group, [hardCase]);
  }
  return [...groups].map(([group, members]) => ({ group, cases: members }));
}

/** The cases whose name, group or description has a word beginning with each word of `query`. */
export function filteredCases(cases: readonly HardCase[], query: string): readonly HardCase[] {
  const asked = wordsOf(query);
  if (asked.length === 0) return cases;
  return cases.filter((hardCase) => {
    const { name, group, breaks, kind } = hardCase;
    const words = wordsOf([name, group, breaks, kind, noteOn(hardCase)].join(' '));
    return asked.every((each) => words.some((word) => word.startsWith(each)));
  });
}

/** Runs of letters and digits, lower case. */
function wordsOf(text: string): string[] {
  return text.toLowerCase().match(/[\p{L}\p{N}]+/gu) ?? [];
}

const MOST_CLOSEST = 3;
/** Names with fewer pairs of letters in common do not look alike. */
const LEAST_SIMILARITY = 0.25;

/** The names that are most like `asked`, best first; empty if none is alike. */
export function closestNames(names: readonly string[], asked: string): string[] {
  return names
    .map((name) => ({ name, similarity: similarity(name, asked) }))
    .filter((candidate) => candidate.similarity >= LEAST_SIMILARITY)
    .sort((a, b) => b.similarity - a.similarity)
    .slice(0, MOST_CLOSEST)
    .map(({ name }) => name);
}

/** Sørensen–Dice over pairs of letters, 0…1: swapped words and missing ends count little. */
function similarity(a: string, b: string): number {
  const pairs = pairsOf(a);
  const others = pairsOf(b);
  let common = 0;
  for (const pair of pairs) {
    const at = others.indexOf(pair);
    if (at < 0) continue;
    // Each pair is matched once.
    others[at] = '';
    common++;
  }
  return pairs.length + others.length > 0 ? (2 * common) / (pairs.length + others.length) : 0;
}

function pairsOf(name: string): string[] {
  const letters = name.toLowerCase();
  return Array.from({ length: Math.max(0, letters.length - 1) }, (_, i) => letters.slice(i, i + 2));
}
