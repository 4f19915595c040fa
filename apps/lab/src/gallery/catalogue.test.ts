import type { HardCase } from '@websplatter/conformance';
import { describe, expect, it } from 'vitest';
import { filteredCases, groupedCases, hasImage, neighboursOf } from './catalogue.ts';

const scene = (name: string, group: HardCase['group'], breaks: string): HardCase => ({
  kind: 'scene',
  name,
  group,
  breaks,
  clouds: () => [],
  cameras: () => ({}),
});

const FIRST_CAMERA = { kind: 'object', position: [0, 0, 3], target: [0, 0, 0], up: [0, 1, 0] } as const;

const CASES: readonly HardCase[] = [
  scene('needle-aspect-1e6', 'scale', 'The smaller eigenvalue cancels to 0.'),
  scene('needle-edge-on', 'scale', 'A disc has no inverse.'),
  scene('far-origin', 'world', 'Positions are float32.'),
  {
    kind: 'refused-file',
    name: 'cut-off',
    group: 'input',
    breaks: 'x',
    file: () => new Uint8Array(),
    code: 'y',
  },
  {
    kind: 'sort',
    name: 'equal-keys',
    group: 'sort',
    breaks: 'x',
    keys: () => new Uint32Array(),
    keyBits: 16,
  },
  {
    kind: 'framing',
    name: 'in-a-room',
    group: 'framing',
    breaks: 'x',
    clouds: () => [],
    expects: [],
    cameras: { f32: FIRST_CAMERA, packed: FIRST_CAMERA },
  },
];

describe('hard cases in the gallery', () => {
  it('filters by every word, in name, group and description', () => {
    const namesFor = (query: string) => filteredCases(CASES, query).map(({ name }) => name);
    expect(namesFor('  ')).toHaveLength(CASES.length);
    expect(namesFor('NEEDLE eigenvalue')).toEqual(['needle-aspect-1e6']);
    expect(namesFor('world')).toEqual(['far-origin']);
    expect(namesFor('needle world')).toEqual([]);
  });

  it('groups in the order of the catalogue', () => {
    expect(groupedCases(CASES).map(({ group, cases }) => [group, cases.length])).toEqual([
      ['scale', 2],
      ['world', 1],
      ['input', 1],
      ['sort', 1],
      ['framing', 1],
    ]);
  });

  it('finds words by their beginnings, not in the middle of others', () => {
    const cases = [
      scene('input-nan', 'input', 'Rows of NaNs.'),
      scene('flat', 'scale', 'The determinant is 0.'),
    ];
    expect(filteredCases(cases, 'nan')).toEqual([cases[0]]);
    expect(filteredCases(cases, 'deter')).toEqual([cases[1]]);
    expect(filteredCases(cases, 'input-nan')).toEqual([cases[0]]);
  });

  it('knows what comes before and after a case', () => {
    expect(neighboursOf(CASES, 'needle-aspect-1e6')).toEqual({ previous: null, next: 'needle-edge-on' });
    expect(neighboursOf(CASES, 'far-origin')).toEqual({ previous: 'needle-edge-on', next: 'cut-off' });
    expect(neighboursOf(CASES, 'in-a-room')).toEqual({ previous: 'equal-keys', next: null });
    expect(neighboursOf(CASES, 'zzz')).toEqual({ previous: null, next: null });
  });

  it('knows which cases have an image', () => {
    const empty = { ...scene('viewport-0x64', 'camera', 'x'), size: { widthPx: 0, heightPx: 64 } };
    expect([...CASES, empty].map((each) => hasImage(each as HardCase))).toEqual([
      true,
      true,
      true,
      false,
      false,
      false,
      false,
    ]);
  });
});
