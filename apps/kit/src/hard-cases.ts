import type {
  DeviceCase,
  FramingCase,
  HardCase,
  HardCaseGroup,
  RefusedFileCase,
  SceneCase,
} from '@websplatter/conformance';

/** Cases that can be opened: images, first cameras, and files whose refusal is the point. */
export type OpenableCase = SceneCase | DeviceCase | FramingCase | RefusedFileCase;

export function isOpenable(hardCase: HardCase): hardCase is OpenableCase {
  return hardCase.kind !== 'sort' && hardCase.kind !== 'arithmetic';
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
