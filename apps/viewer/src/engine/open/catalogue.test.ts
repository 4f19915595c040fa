import type { HardCase } from '@websplatter/conformance';
import { describe, expect, it } from 'vitest';
import { addressOf, hardCaseNameIn } from '../link/case-addresses.ts';
import { findHardCase } from './catalogue.ts';
import { reportFailure } from './failure-report.ts';

const CASES = [
  ['scene', 'needle-aspect-1e6'],
  ['scene', 'needle-edge-on'],
  ['scene', 'far-origin'],
  ['refused-file', 'cut-off'],
  ['sort', 'equal-keys'],
  ['framing', 'in-a-room'],
].map(([kind, name]) => ({ kind, name }) as HardCase);

function errorFor(name: string) {
  try {
    findHardCase(CASES, name);
  } catch (error) {
    return reportFailure(error, name);
  }
  throw new Error('It was found.');
}

describe('hard cases in the viewer', () => {
  it('finds what can be opened', () => {
    expect(findHardCase(CASES, 'far-origin')).toBe(CASES[2]);
    expect(findHardCase(CASES, 'cut-off')).toBe(CASES[3]);
    expect(findHardCase(CASES, 'in-a-room')).toBe(CASES[5]);
  });

  it('offers the closest names and the gallery for an unknown one', () => {
    const { message, isFault, links } = errorFor('needle-aspct-1e6');
    expect(message).toContain('“needle-aspct-1e6”');
    expect(isFault).toBeUndefined();
    expect(links).toEqual([
      { label: 'needle-aspect-1e6', href: '?scene=hard:needle-aspect-1e6' },
      { label: 'needle-edge-on', href: '?scene=hard:needle-edge-on' },
      { label: 'All hard cases', href: 'lab/?gallery' },
    ]);
    expect(errorFor('zzz').links).toHaveLength(1);
  });

  it('says why a case without an image cannot be opened', () => {
    expect(errorFor('equal-keys').message).toMatch(/equal-keys cannot be opened.*no image/);
  });

  it('makes addresses and reads them', () => {
    expect(addressOf('a b')).toBe('?scene=hard:a%20b');
    expect(hardCaseNameIn(new URLSearchParams(addressOf('a b')).get('scene'))).toBe('a b');
    expect(hardCaseNameIn('still-life')).toBeNull();
    expect(hardCaseNameIn(null)).toBeNull();
  });
});
