import type { DeviceCase, HardCase, HardCaseGroup, SceneCase } from '@websplatter/conformance';
import { noteOn } from '@websplatter/kit/hard-cases';

/** The cases before and after `name` among `cases`; null at the ends, and if it is missing. */
export function neighboursOf(
  cases: readonly HardCase[],
  name: string,
): { readonly previous: string | null; readonly next: string | null } {
  const index = cases.findIndex((candidate) => candidate.name === name);
  const nameAt = (at: number) => (index < 0 ? null : (cases[at]?.name ?? null));
  return { previous: nameAt(index - 1), next: nameAt(index + 1) };
}

/** Whether a case is about images, which this device can draw. */
export function hasImage(hardCase: HardCase): hardCase is SceneCase | DeviceCase {
  if (hardCase.kind !== 'scene' && hardCase.kind !== 'device') return false;
  const { widthPx, heightPx } = hardCase.size ?? { widthPx: 1, heightPx: 1 };
  return widthPx * heightPx > 0;
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
